#!/usr/bin/env python3
"""Records and draws a conversation of two hosts with emulated S2C modems.

The modems run already (roslaunch acoustic_channel modems.launch); both ports have AT interpreters.
The first host sends a message with acknowledgement and asks for the propagation time, the second
one answers with a burst. The picture shows each line at the time when it was written or read.
"""

import argparse
import re
import select
import socket
import sys
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  after the choice of a backend

from stg_common.program import run_program  # noqa: E402

# Host, seconds after the beginning, text that it sends.
SCRIPT = (
    (0, 0.0, "+++AT@ZX1"),
    (1, 0.0, "+++AT@ZX1"),
    (0, 0.3, "+++AT*SENDIM,5,2,ack,hello"),
    (0, 2.6, "+++AT?T"),
    (1, 3.0, "+++AT*SEND,12,1,a burst back"),
)
SECONDS = 6.6
COLOURS = ("#1f6f8b", "#a8482c")


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ports", type=int, nargs=2, default=(9201, 9202))
    parser.add_argument("--out", default="docs/images/modem_session.png")
    return parser.parse_args(argv)


def talk(ports):
    """(host, time [s], '>' or '<', line) for every line that was sent or received."""
    streams = [socket.create_connection(("127.0.0.1", port)) for port in ports]
    begin, said, rest = time.monotonic(), [], [b"", b""]
    waiting = list(SCRIPT)
    while (now := time.monotonic() - begin) < SECONDS:
        while waiting and waiting[0][1] <= now:
            host, _, line = waiting.pop(0)
            streams[host].sendall(line.encode() + b"\n")
            said.append((host, now, ">", line))
        due = waiting[0][1] if waiting else SECONDS
        for stream in select.select(streams, [], [], max(0.0, due - now))[0]:
            host = streams.index(stream)
            rest[host] += stream.recv(4096)
            now = time.monotonic() - begin
            *lines, rest[host] = rest[host].split(b"\r\n")
            said += [(host, now, "<", line.decode("latin-1")) for line in lines]
    return said


def sounds(said):
    """(sender, begin, end, begin at the receiver, its end) of each packet that arrived [s]."""
    started = [(h, t) for h, t, _, line in said if "SENDSTART" in line]
    ended = [(h, t) for h, t, _, line in said if "SENDEND" in line]
    heard = [(h, t) for h, t, _, line in said if "RECVSTART" in line]
    read = [(h, t) for h, t, _, line in said if "RECVEND" in line or "RECVFAILED" in line]
    for host in (0, 1):
        there = 1 - host
        for (_, begin), (_, end), (_, first), (_, last) in zip(
            [s for s in started if s[0] == host],
            [s for s in ended if s[0] == host],
            [s for s in heard if s[0] == there],
            [s for s in read if s[0] == there],
        ):
            yield host, begin, end, first, last


def draw(said, out):
    """The picture: hosts outside, modems inside, sound between them, time downwards."""
    figure, axes = plt.subplots(figsize=(13.0, 8.0))
    for host, begin, end, first, last in sounds(said):
        there = 1 - host
        axes.fill([host, there, there, host], [begin, first, last, end], COLOURS[host], alpha=0.25)
    below = [-1.0, -1.0]
    for host, t, way, line in said:
        # Lines at nearly the same time are drawn below each other.
        below[host] = max(t, below[host] + 0.155)
        side = -1 if host == 0 else 1
        text = re.sub(r"[^\x20-\x7e]", "?", line)
        axes.annotate(
            f"{'→' if (way == '>') == (host == 0) else '←'} {text}",
            (host, t),
            (host + side * 0.07, below[host]),
            ha="right" if host == 0 else "left",
            va="center",
            family="monospace",
            fontsize=8,
            color="black" if way == ">" else COLOURS[host],
        )
    for host, name in enumerate(("modem 1", "modem 2")):
        axes.plot([host, host], [-0.2, SECONDS], color=COLOURS[host], linewidth=2)
        axes.text(host, -0.35, name, ha="center", fontsize=11)
        axes.text(host + (1.2 if host else -1.2), -0.35, f"host {host + 1}", ha="center", fontsize=11)
    axes.set(xlim=(-2.9, 3.9), ylim=(SECONDS, -0.6), ylabel="time [s]", xticks=[])
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    figure.savefig(out, dpi=110, bbox_inches="tight")


def main(argv):
    """Runs the conversation and draws it."""
    args = parse(argv)
    draw(talk(args.ports), args.out)
    return 0


if __name__ == "__main__":
    run_program("modem_session", lambda: main(sys.argv[1:]))
