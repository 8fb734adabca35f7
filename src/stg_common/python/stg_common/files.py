"""Files of users: they are read completely, or refused with one line, FILE:LINE: reason.

Other ways to open such a file may wait for a FIFO without a writer, or read a device until the memory is
full.
"""

import codecs
import contextlib
import json
import os
import re
import stat

LARGEST = 1 << 30  # bytes of a file, or of the content of a compressed file
LARGEST_NUMBER = 1e30  # no count, measurement or score is larger; sums of squares of such numbers are finite
_SURROGATES = re.compile("[\ud800-\udfff]")


def one_line(text):
    """A text with its control characters written out."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in str(text))


def reason_of(error):
    """Text of an error: the file, and the reason."""
    filename = getattr(error, "filename", None)
    reason = getattr(error, "strerror", None) or error
    return str(reason) if filename is None else f"{filename}: {reason}"


class FileError(Exception):
    """The reason why a file cannot be used. The message is one line with the file and, if known, the line."""

    def __init__(self, path, what, line=None):
        where = str(path) if line is None else f"{path}:{line}"
        super().__init__(one_line(f"{where}: {what}"))


class Damaged(FileError):
    """A file that was read but has wrong content."""


@contextlib.contextmanager
def opened(path, largest=LARGEST):
    """Opens a regular file of at most `largest` bytes for reading bytes. Any other file raises FileError, and
    so do errors of the disk while it is read."""
    try:
        state = os.stat(path)  # opening a FIFO would block
        if stat.S_ISDIR(state.st_mode):
            raise FileError(path, "is a folder, not a file")
        if not stat.S_ISREG(state.st_mode):
            raise FileError(path, "is not a regular file")
        if state.st_size > largest:
            raise FileError(path, f"has {state.st_size} bytes, more than {largest}")
        with open(path, "rb") as file:
            yield file
    except OSError as error:
        raise FileError(path, error.strerror or error) from None


def without_mark(data):
    """The bytes of a text without the byte-order mark that some editors write at the start of UTF-8."""
    return data[len(codecs.BOM_UTF8) :] if data.startswith(codecs.BOM_UTF8) else data


def read_text(path, largest=LARGEST):
    """The text of a file in UTF-8."""
    with opened(path, largest) as file:
        data = file.read(largest + 1)
    if len(data) > largest:
        raise FileError(path, f"has more than {largest} bytes")
    data = without_mark(data)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise Damaged(path, "is not text in UTF-8", line) from None


def read_json(path):
    """The value of a JSON file."""
    try:
        return json.loads(read_text(path))
    except json.JSONDecodeError as error:
        raise Damaged(path, f"is not JSON: {error.msg}", error.lineno) from None
    except RecursionError:
        raise Damaged(path, "is nested too deeply") from None
    except ValueError as error:  # numbers of thousands of digits
        raise Damaged(path, f"is not JSON: {error}") from None


KINDS = {dict: "an object", list: "a list", str: "a text", float: "a finite number"}


def is_text(value):
    """True if a value is a text that is valid in files and on command lines."""
    return isinstance(value, str) and "\0" not in value and not _SURROGATES.search(value)


def expect(path, value, kind, key=None):
    """Returns `value`, which the JSON file `path` has under `key`. Raises Damaged if it is not of this kind:
    dict, list, str, or float for any finite number."""
    if kind is float:
        good = isinstance(value, (int, float)) and not isinstance(value, bool)
        good = good and abs(value) <= LARGEST_NUMBER
    else:
        good = is_text(value) if kind is str else isinstance(value, kind)
    if not good:
        raise Damaged(path, ("" if key is None else f"{key}: ") + f"is not {KINDS[kind]}")
    return value


def member(path, values, key, kind):
    """Returns the value under `key` of an object in a JSON file. Raises Damaged if it is missing."""
    if key not in values:
        raise Damaged(path, f"{key}: missing")
    return expect(path, values[key], kind, key)
