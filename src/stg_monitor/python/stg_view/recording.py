"""Recordings: writes and reads the messages for the page (docs/recording.md).

A recording is a magic word and messages. A message is two little-endian uint32 (bytes of header and
body), a JSON header, and a body of columns. stg::env::Message writes the same in C++.
"""

import json
import math
import struct

import numpy as np

__all__ = ["FATES", "MAGIC", "Recording", "RecordingError", "Packets", "Steps", "encode", "messages"]

MAGIC = b"STGVIEW1"
TYPES = {"f8": np.dtype("<f8"), "f4": np.dtype("<f4"), "i4": np.dtype("<i4"), "u1": np.dtype("u1")}
# The numbers of acoustics::DropReason; 0 means no reason.
FATES = (
    "delivered", "range", "loss", "collision", "half_duplex", "fading", "burst", "queue",
    "not_acquired", "shadow", "left",
)  # fmt: skip
LARGEST = 1 << 28  # bytes of a message
# Limits of a page, beyond which data is thinned: numbers of all steps, rows of packets.
MOST_STEP_NUMBERS, MOST_PACKETS = 3_000_000, 200_000


class RecordingError(Exception):
    """The reason why a recording cannot be read."""


def _padded(data, blank):
    return data + blank * (-len(data) % 8)


def _finite(value):
    """The value without numbers that JSON cannot represent."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {str(key): _finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(one) for one in value]
    return value


def encode(kind, columns=(), **header):
    """The bytes of one message.

    columns: [(name, type, array of [rows] or [rows, width])]; all have the same rows.
    """
    header = {"kind": kind, **_finite(header)}
    body = []
    for name, kind_of, values in columns:
        values = np.asarray(values, TYPES[kind_of])
        rows = len(values)
        width = values.size // rows if rows else 1
        if header.setdefault("rows", rows) != rows:
            raise ValueError(f"{name}: {rows} rows, not {header['rows']}")
        header.setdefault("columns", []).append([name, kind_of, width])
        body.append(_padded(values.tobytes(), b"\0"))
    text = _padded(json.dumps(header, allow_nan=False).encode(), b" ")
    body = b"".join(body)
    return struct.pack("<II", len(text), len(body)) + text + body


def messages(data):
    """Yields (header, {column: array}) for the messages in a recording's bytes. The last one may be cut off
    and is then left out. Raises RecordingError if it is not a recording."""
    if data[: len(MAGIC)] != MAGIC:
        raise RecordingError("is not a recording")
    at = len(MAGIC)
    while at + 8 <= len(data):
        header_bytes, body_bytes = struct.unpack_from("<II", data, at)
        if max(header_bytes, body_bytes) > LARGEST:
            raise RecordingError(f"is damaged at byte {at}")
        if at + 8 + header_bytes + body_bytes > len(data):
            return
        try:
            yield _decoded(data, at + 8, header_bytes, body_bytes)
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise RecordingError(f"is damaged at byte {at}: {error}") from None
        at += 8 + header_bytes + body_bytes


def _decoded(data, at, header_bytes, body_bytes):
    header = json.loads(data[at : at + header_bytes])
    if not isinstance(header, dict) or not isinstance(header.get("kind"), str):
        raise ValueError("no kind")
    columns, place = {}, at + header_bytes
    end = place + body_bytes
    for name, kind, width in header.get("columns", []):
        rows = header["rows"]
        if not (isinstance(rows, int) and isinstance(width, int) and rows >= 0 and 0 < width <= 1 << 20):
            raise ValueError("columns of no size")
        size = rows * width * TYPES[kind].itemsize
        if place + size > end:
            raise ValueError("columns are longer than the message")
        columns[name] = np.frombuffer(data, TYPES[kind], rows * width, place).reshape(rows, width)
        place += -(-size // 8) * 8
    return header, columns


class Steps:
    """Rows of the message `steps`. They are collected one after the other and thinned to fit a page."""

    WIDTHS = {"t": ("f8", 0), "reward": ("f4", 0)}
    KINDS = {"phase": "u1", "detected": "u1", "fresh": "u1", "aground": "u1", "followed": "u1"}

    def __init__(self):
        self.rows = []
        self.keep_every = 1
        self._seen = 0

    def add(self, **values):
        """Adds one row: numbers, or flat sequences of them."""
        self._seen += 1
        if (self._seen - 1) % self.keep_every:
            return
        self.rows.append(values)
        if len(self.rows) * sum(np.size(value) for value in values.values()) > MOST_STEP_NUMBERS:
            self.rows = self.rows[::2]
            self.keep_every *= 2

    def encoded(self, terms=()):
        """The message, or b"" if there are no rows."""
        if not self.rows:
            return b""
        widths = {}
        for row in self.rows:
            for name, value in row.items():
                widths[name] = max(widths.get(name, 1), np.size(value))
        columns = []
        for name, width in widths.items():
            kind = "f8" if name == "t" else self.KINDS.get(name, "f4")
            table = np.full((len(self.rows), width), np.nan if kind[0] == "f" else 255, TYPES[kind])
            for k, row in enumerate(self.rows):
                value = np.ravel(row.get(name, ()))
                with np.errstate(over="ignore"):
                    table[k, : len(value)] = value
            columns.append((name, kind, table))
        return encode("steps", columns, terms=list(terms))


class Packets:
    """Rows of the message `packets`. If a page cannot hold them, whole transmissions are left out. The counts
    include all packets."""

    COLUMNS = {
        "source": "i4", "receiver": "i4", "sequence": "i4", "bytes": "i4", "fate": "u1",
        "offered": "f8", "transmit": "f8", "transmit_end": "f8", "arrival": "f8",
        "distance": "f4", "sinr": "f4", "probability": "f4",
    }  # fmt: skip

    def __init__(self):
        self.rows = []
        self.fates = [0] * len(FATES)
        self.links = {}

    def add(self, *row):
        """Adds one row: the values of COLUMNS in their order."""
        self.rows.append(row)
        source, receiver, fate = row[0], row[1], row[4]
        self.fates[fate] += 1
        self.links.setdefault(f"{source}>{receiver}", [0] * len(FATES))[fate] += 1

    def encoded(self):
        """The messages: packets, and the totals if some packets were left out."""
        rows, totals = self.rows, b""
        if len(rows) > MOST_PACKETS:
            keep_every = -(-len(rows) // MOST_PACKETS)
            order, kept = {}, []
            for row in rows:
                key = (row[0], row[2], row[6] if row[6] == row[6] else row[5])
                if order.setdefault(key, len(order)) % keep_every == 0:
                    kept.append(row)
            rows = kept
            sent = sum(1 for key in order if key[1] >= 0)
            totals = encode("totals", fates=self.fates, links=self.links, transmissions=sent)
            totals += encode("note", text=f"One transmission in {keep_every} is drawn; counts include all transmissions.")
        if not rows:
            return totals
        columns = list(zip(*rows))
        named = zip(self.COLUMNS.items(), columns)
        return totals + encode("packets", [(name, kind, values) for (name, kind), values in named])


class Recording:
    """The messages of one run, which a reader collects."""

    def __init__(self, **meta):
        self.meta = meta
        self.notes = []
        self.parts = []
        self.steps, self.packets, self.terms = Steps(), Packets(), ()

    def add(self, kind, columns=(), **header):
        """Adds a message."""
        self.parts.append(encode(kind, columns, **header))

    def encoded(self):
        """The bytes of the whole recording."""
        if self.steps.keep_every > 1:
            self.notes.append(f"Of {self.steps.keep_every} steps one is shown.")
        parts = [MAGIC, encode("meta", meta=self.meta)]
        parts += [encode("note", text=str(text)) for text in self.notes]
        parts += [*self.parts, self.steps.encoded(self.terms), self.packets.encoded()]
        return b"".join(parts)
