"""Reads tables in CSV files, compressed or not. Incomplete tables and wrong types raise Damaged."""

import csv
import gzip
import zlib

from stg_common.files import LARGEST, LARGEST_NUMBER, Damaged, opened, without_mark

LONGEST_LINE = 1 << 20  # bytes


def number(text):
    """A finite number."""
    value = float(text)
    if not abs(value) <= LARGEST_NUMBER:
        raise ValueError
    return value


def count(text):
    """A whole number that is not negative, of at most 18 digits."""
    if not (text.isascii() and text.isdigit() and len(text) <= 18):
        raise ValueError
    return int(text)


def written(kind):
    """The unchanged text, if `kind` accepts it."""

    def check(text):
        kind(text)
        return text

    return check


def optional(kind):
    """`kind`, or None for an empty cell."""
    return lambda text: kind(text) if text else None


def _lines(path, file):
    """Yields the lines of an open file as text."""
    size = line = 0
    try:
        while True:
            data = file.readline(LONGEST_LINE + 1)
            if not data:
                return
            size, line = size + len(data), line + 1
            if len(data) > LONGEST_LINE:
                raise Damaged(path, f"a line of more than {LONGEST_LINE} bytes", line)
            if size > LARGEST:
                raise Damaged(path, f"holds more than {LARGEST} bytes")
            yield (without_mark(data) if line == 1 else data).decode("utf-8")
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise Damaged(path, f"damaged, or cut off: {error}", line + 1) from None
    except UnicodeDecodeError:
        raise Damaged(path, "is not text in UTF-8", line) from None


def table_rows(path, columns=None, others=lambda name: str):
    """Yields the rows of a CSV file with a header, which may be compressed (.gz), as {name: value}.

    columns: {name: kind} of the required columns; others(name) is the kind of any other column. kind(text)
    returns the value of a cell, and raises ValueError for a wrong text. Every row must have a cell for every
    column.
    """
    columns = columns or {}
    with opened(path) as file:
        source = gzip.GzipFile(fileobj=file) if str(path).endswith(".gz") else file
        reader = csv.reader(_lines(path, source))
        try:
            header = next(reader, [])
            missing = [name for name in columns if name not in header]
            if missing:
                raise Damaged(path, f"no column {', '.join(missing)}", 1)
            twice = sorted({name for name in header if header.count(name) > 1})
            if twice:
                raise Damaged(path, f"more than one column {', '.join(twice)}", 1)
            kinds = [(name, columns.get(name) or others(name)) for name in header]
            for cells in reader:
                if cells:
                    yield _row(path, reader.line_num, kinds, cells)
        except csv.Error as error:
            raise Damaged(path, error, reader.line_num) from None


def _row(path, line, kinds, cells):
    if len(cells) != len(kinds):
        raise Damaged(path, f"{len(cells)} cells in a table of {len(kinds)} columns", line)
    row = {}
    for (name, kind), text in zip(kinds, cells):
        try:
            row[name] = kind(text)
        except ValueError:
            raise Damaged(path, f"{name}: '{text[:40]}' is not a valid value", line) from None
    return row
