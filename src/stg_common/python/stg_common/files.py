"""Files that users give: read whole, or refused in one line, FILE:LINE: what.

A program that opens such a file in another way waits for a FIFO without a writer, or reads a device until
the memory is full.
"""

import codecs
import contextlib
import json
import os
import re
import stat

LARGEST = 1 << 30  # bytes of a file, and of what a compressed one holds
LARGEST_NUMBER = 1e30  # that counts, measures or scores anything; sums of squares of it are finite
_SURROGATES = re.compile("[\ud800-\udfff]")


def one_line(text):
    """A text with its control characters written out."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in str(text))


def reason_of(error):
    """An error in words: which file, and what is wrong with it."""
    filename = getattr(error, "filename", None)
    reason = getattr(error, "strerror", None) or error
    return str(reason) if filename is None else f"{filename}: {reason}"


class FileError(Exception):
    """Why a file cannot be used; the message is one line that names it, and its line if known."""

    def __init__(self, path, what, line=None):
        where = str(path) if line is None else f"{path}:{line}"
        super().__init__(one_line(f"{where}: {what}"))


class Damaged(FileError):
    """A file that was read, and is not what its name says."""


@contextlib.contextmanager
def opened(path, largest=LARGEST):
    """A regular file of at most `largest` bytes, open for its bytes; any other is a FileError, and
    so is what goes wrong with the disk while it is read."""
    try:
        state = os.stat(path)  # opening a FIFO would wait
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
    """The bytes of a text without the byte-order mark that some editors begin UTF-8 with."""
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
    """Whether a value is a text that files and command lines can hold."""
    return isinstance(value, str) and "\0" not in value and not _SURROGATES.search(value)


def expect(path, value, kind, key=None):
    """`value`, which stands in the JSON file `path` under `key`; Damaged where it is not of its kind:
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
    """What stands under `key` of an object of a JSON file; Damaged where there is none."""
    if key not in values:
        raise Damaged(path, f"{key}: missing")
    return expect(path, values[key], kind, key)
