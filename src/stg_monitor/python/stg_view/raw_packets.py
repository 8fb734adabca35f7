"""Decodes undecoded messages of packets by the hundred. Python would decode them one by one more slowly than
a run in lockstep makes them."""

import struct

import auv_msgs.msg
import numpy as np

from stg_view.recording import FATES, Packets, encode

__all__ = ["packets_message"]

DELIVERED, DROPPED, NO_SEQUENCE = 3, 4, 4294967295
KINDS = {"uint8": ("u1",), "bool": ("u1",), "uint32": ("<u4",), "int32": ("<i4",), "float64": ("<f8",), "time": ("<u4", 2)}
_SLOTS = zip(auv_msgs.msg.PacketEvent.__slots__, auv_msgs.msg.PacketEvent._slot_types)
EVENT = np.dtype([(name, *KINDS[kind]) for name, kind in _SLOTS])
HEADER = struct.Struct("<III I")  # sequence, stamp, length of the frame's name


def _events(raw):
    """The events in the bytes of one auv_msgs/PacketEvents. Raises ValueError for other bytes."""
    at = HEADER.size + HEADER.unpack_from(raw)[3]
    (count,) = struct.unpack_from("<I", raw, at)
    return np.frombuffer(raw, EVENT, count, at + 4)


def packets_message(raws, agents):
    """The message `packets` with the fates in the bytes of many auv_msgs/PacketEvents; b"" if there are none.

    A packet that never left is lost for each AUV that it is addressed to, as in from_bag.Collector.
    """
    events = np.concatenate([_events(raw) for raw in raws]) if raws else np.empty(0, EVENT)
    events = events[(events["kind"] == DELIVERED) | (events["kind"] == DROPPED)]
    to = np.where(events["receiver"] >= 0, events["receiver"], events["destination"])
    rows = np.where(to < 0, agents, 1)
    place = np.repeat(np.arange(len(events)), rows)
    nth = np.arange(len(place)) - np.repeat(np.cumsum(rows) - rows, rows)
    receivers, e = np.where(to[place] < 0, nth, to[place]), events[place]
    keep = (to[place] >= 0) | (nth != e["source"])
    receivers, e = receivers[keep], e[keep]
    if len(e) == 0:
        return b""
    left = e["sequence"] != NO_SEQUENCE

    def stamp(name):
        time = e[name][:, 0] + 1e-9 * e[name][:, 1]
        return np.where(time > 0, time, np.nan)

    transmit = np.where(left, stamp("transmit"), np.nan)
    fate = np.where(e["kind"] == DELIVERED, 0, np.minimum(e["reason"], len(FATES) - 1))
    values = (e["source"], receivers, np.where(left, e["sequence"].astype(np.int64) % (1 << 31), -1), e["bytes"], fate,
              stamp("offered"), transmit, transmit + e["airtime"], stamp("arrival"), e["distance"], e["sinr_db"],
              e["loss_probability"])  # fmt: skip
    return encode("packets", [(name, kind, column) for (name, kind), column in zip(Packets.COLUMNS.items(), values)])
