#!/usr/bin/python3
"""Draws what an acoustic network did, from the packet log of `simulate` or of the channel node.

Into one picture: delivery against distance, distribution of the age of information, use of the
water by the senders over a window of time, drops by reason, energy by node, and airtime and
deliveries over the whole run. Times are seconds, distances metres.

Exit status: 0 done, 2 wrong usage or a file that cannot be read.
"""

import argparse
import os

import numpy as np

from stg_common.csv_files import number, table_rows
from stg_common.files import Damaged, FileError, expect, member, read_json
from stg_common.program import run_program

NUMBERS = "offered_s generation_s transmit_s transmit_end_s begin_s arrival_s distance_m".split()
NAMES = "source destination sequence fate".split()
GOOD, PARTLY, BAD, GREY = "#2fb457", "#f5a11a", "#e23636", "#9aa3ad"
MAX_LINKS = 40
# Columns that a row must have for a packet that left, for one with a receiver, and for one that arrived.
OF_SENT, OF_RECEIVER, OF_DELIVERED = ("transmit_end_s",), ("distance_m",), ("generation_s", "arrival_s")


def number_or_nan(text):
    """A number; NaN for an empty cell."""
    return number(text) if text else np.nan


def in_order(names):
    """Names of nodes; numbers are sorted by value."""
    return sorted(names, key=lambda n: (not n.isdecimal(), len(n.lstrip("0")) if n.isdecimal() else 0, n))


class Log:
    """Columns of a packet log as arrays, with one entry per packet and receiver; NaN: unknown."""

    def __init__(self, path):
        columns = {name: [] for name in NAMES + NUMBERS}
        kinds = {**dict.fromkeys(NAMES, str), **dict.fromkeys(NUMBERS, number_or_nan), "offered_s": number}
        for line, row in enumerate(table_rows(path, kinds), start=2):
            needed = () if np.isnan(row["transmit_s"]) else OF_SENT
            needed += OF_RECEIVER if needed and row["fate"] != "left" else ()
            needed += OF_DELIVERED if row["fate"] == "delivered" else ()
            for name in needed:
                if np.isnan(row[name]):
                    raise Damaged(path, f"{name}: missing", line)
            for name, values in columns.items():
                values.append(row[name])
        if not columns["source"]:
            raise Damaged(path, "no packets")
        for name in NAMES:
            setattr(self, name, np.array(columns[name], dtype=object))
        for name in NUMBERS:
            setattr(self, name, np.array(columns[name]))
        self.delivered = self.fate == "delivered"
        self.sent = np.isfinite(self.transmit_s)
        self.end_s = max(np.nanmax(self.offered_s), np.nanmax(self.arrival_s, initial=0.0))

    def count_from_first(self):
        """Makes all times start at the first one, because the log of a node has times of its clock."""
        first_s = min(np.nanmin(self.offered_s), np.nanmin(self.generation_s, initial=np.inf))
        for name in NUMBERS:
            if name.endswith("_s"):
                setattr(self, name, getattr(self, name) - first_s)
        self.end_s -= first_s

    def nodes(self):
        """All names of nodes; numbers are sorted by value."""
        return in_order(set(self.source) | set(self.destination))

    def transmissions(self):
        """Start, end, source and share of reached receivers for every packet that left."""
        found = {}
        for i in np.flatnonzero(self.sent):
            key = (self.source[i], self.sequence[i], self.transmit_s[i])
            entry = found.setdefault(key, [self.transmit_end_s[i], 0, 0])
            entry[1] += 1
            entry[2] += int(self.delivered[i])
        return [(start, end, source, got / of) for (source, _, start), (end, of, got) in found.items()]


def draw_delivery(axes, log):
    """Draws the share of sent packets that was delivered, by distance, with 95 % intervals of Wilson."""
    axes.set_title("delivery against distance")
    axes.set_xlabel("distance [m]")
    axes.set_ylabel("delivered")
    axes.set_ylim(-0.03, 1.03)
    there = log.sent & (log.fate != "left")
    distance, good = log.distance_m[there], log.delivered[there]
    if not len(distance):
        return
    # Bins have equal numbers of packets; each fixed distance is a bin of its own.
    edges = np.unique(np.quantile(distance, np.linspace(0.0, 1.0, 25)))
    place = np.searchsorted(edges, distance, side="right")
    for i in np.unique(place):
        of = place == i
        n, share, z = of.sum(), good[of].mean(), 1.96
        middle = (share + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * np.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
        x = distance[of].mean()
        axes.plot([x, x], [middle - half, middle + half], color=GREY)
        axes.plot([x], [share], "o", color="#4a8cff", markersize=4)


def age_segments(log):
    """Lowest and highest age of each piece between two deliveries of newer data, by link."""
    links = {link: [] for link in zip(log.source[log.sent], log.destination[log.sent])}
    news = dict.fromkeys(links, (0.0, 0.0))
    order = np.flatnonzero(log.delivered)
    for i in order[np.argsort(log.arrival_s[order])]:
        link = (log.source[i], log.destination[i])
        freshest, since = news[link]
        if log.generation_s[i] <= freshest:
            continue
        links[link].append((since - freshest, log.arrival_s[i] - freshest))
        news[link] = (log.generation_s[i], log.arrival_s[i])
    for link, (freshest, since) in news.items():
        links[link].append((since - freshest, log.end_s - freshest))
    return [np.array(pieces) for _, pieces in sorted(links.items())]


def share_of_time(pieces, ages):
    """Share of the time in which the age, a sawtooth of these pieces, was at most `ages`."""
    low, high = pieces[:, :1], pieces[:, 1:]
    length = np.maximum((high - low).sum(), 1e-12)
    return np.clip(ages[None, :] - low, 0.0, high - low).sum(axis=0) / length


def draw_ages(axes, log):
    """Draws the distribution of the age of information over time, for every link and for all together."""
    axes.set_title("age of information")
    axes.set_xlabel("age [s]")
    axes.set_ylabel("share of time")
    pieces = age_segments(log)
    if not pieces:
        return
    together = np.concatenate(pieces)
    grid = np.linspace(0.0, together[:, 1].max(), 500)
    for piece in pieces[:: -(-len(pieces) // MAX_LINKS)]:
        axes.plot(grid, share_of_time(piece, grid), color=GREY, linewidth=0.5, alpha=0.6)
    whole = share_of_time(together, grid)
    axes.plot(grid, whole, color="#4a8cff", linewidth=2, label=f"all {len(pieces)} links")
    reach = grid[np.searchsorted(whole, 0.99).clip(max=len(grid) - 1)]
    axes.set_xlim(0.0, max(min(reach * 1.3, grid[-1]), 1e-9))
    axes.legend(loc="lower right")


def draw_slots(axes, log, sent, window):
    """Draws which node sent when, coloured by the fate of the packet."""
    start, end = window
    axes.set_title("use of the water (window)")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("sender")
    rows = {name: i for i, name in enumerate(log.nodes())}
    for begin, stop, source, share in sent:
        if stop < start or begin > end:
            continue
        colour = GOOD if share == 1.0 else BAD if share == 0.0 else PARTLY
        width = max(stop - begin, (end - start) / 500)
        axes.broken_barh([(begin, width)], (rows[source] - 0.4, 0.8), color=colour, linewidth=0)
    axes.set_xlim(start, end)
    axes.set_ylim(-0.7, 1.12 * len(rows) + 0.2)
    stride = -(-len(rows) // 25)
    axes.set_yticks(list(rows.values())[::stride])
    axes.set_yticklabels(list(rows)[::stride])
    for colour, label in ((GOOD, "all heard it"), (PARTLY, "some"), (BAD, "none")):
        axes.plot([], [], "s", color=colour, label=label)
    axes.legend(loc="upper right", ncol=3, fontsize="small", framealpha=0.9)


def draw_drops(axes, log):
    """Draws the number of each fate, counted per packet and receiver."""
    names, counts = np.unique(log.fate.astype(str), return_counts=True)
    order = np.argsort(counts)
    names, counts = names[order], counts[order]
    bars = axes.barh(names, counts, color=[GOOD if n == "delivered" else BAD for n in names])
    axes.bar_label(bars, [f"{c} ({c / counts.sum():.1%})" for c in counts], padding=3)
    axes.set_title("fates, by packet and receiver")
    axes.set_xlim(0, counts.max() * 1.35)


def draw_energy(axes, summary):
    """Draws the energy by node."""
    axes.set_title("energy of the modems")
    energy = summary["energy_j"]
    if not energy or not any(energy.values()):
        axes.text(0.5, 0.5, "not known", ha="center", transform=axes.transAxes)
        return
    nodes = in_order(energy)
    axes.bar(nodes, [energy[node] for node in nodes], color="#4a8cff")
    axes.set_xlabel("node")
    axes.set_ylabel("energy [J]")
    axes.set_xticks(range(0, len(nodes), -(-len(nodes) // 20)))


def airtime_per_time(edges, begin, length, weight=1.0):
    """Share of each span between two edges that packets fill; each packet counts with its weight."""
    before = [(weight * np.clip(edge - begin, 0.0, length)).sum() for edge in edges]
    return np.diff(before) / np.diff(edges)


def draw_load(axes, log, sent):
    """Draws the sent airtime, and the delivered airtime per receiver, over the run."""
    axes.set_title("load over time")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("airtime per time")
    edges = np.linspace(0.0, log.end_s, 61)
    begin = np.array([s[0] for s in sent])
    length = np.array([s[1] - s[0] for s in sent])
    if not len(begin) or not log.end_s > 0.0:
        return
    share = np.array([s[3] for s in sent])
    offered = airtime_per_time(edges, begin, length)
    arrived = airtime_per_time(edges, begin, length, share)
    middle = 0.5 * (edges[1:] + edges[:-1])
    axes.step(middle, offered, where="mid", color=GREY, label="sent")
    axes.step(middle, arrived, where="mid", color=GOOD, label="delivered, mean receiver")
    axes.set_ylim(0.0, 1.25 * max(offered.max(), 1e-9))
    axes.legend(loc="upper right", fontsize="small")


def read_summary(path):
    """The checked content of summary.json; `energy_j` may be empty, and the other values may be missing."""
    found = expect(path, read_json(path), dict) if os.path.exists(path) else {}
    energy = expect(path, found.get("energy_j") or {}, dict, "energy_j")
    summary = {"energy_j": {name: member(path, energy, name, float) for name in energy}}
    if "model" in found:
        for name in ("model", "access"):
            summary[name] = member(path, found, name, str)
        for name in ("transmitted", "duration_s", "delivery_ratio"):
            summary[name] = member(path, found, name, float)
    return summary


def draw(log, summary, window, path):
    """Draws all panels into one file."""
    # matplotlib is only a recommended package, and --help works without it.
    import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel

    plt.switch_backend("Agg")  # for output to files
    plt.rcParams["text.parse_math"] = False  # names of nodes are shown unchanged
    sent = log.transmissions()
    if window is None:
        airtime = np.median([s[1] - s[0] for s in sent]) if sent else 0.0
        window = (0.0, min(log.end_s, max(60.0 * airtime, 20.0)))
    figure, panels = plt.subplots(2, 3, figsize=(17, 9), constrained_layout=True)
    draw_delivery(panels[0, 0], log)
    draw_ages(panels[0, 1], log)
    draw_slots(panels[0, 2], log, sent, window)
    draw_drops(panels[1, 0], log)
    draw_energy(panels[1, 1], summary)
    draw_load(panels[1, 2], log, sent)
    for axes in panels.flat:
        axes.grid(alpha=0.3)
        axes.set_axisbelow(True)
    if "model" in summary:
        figure.suptitle(
            f"{summary['model']}, {summary['access']}: {summary['transmitted']} packets sent in"
            f" {summary['duration_s']:g} s, delivery ratio {summary['delivery_ratio']:.3f}"
        )
    try:
        figure.savefig(path, dpi=100)
    except OSError as error:  # the error of a full disk does not name the file
        raise FileError(path, error.strerror) from None


def read(path):
    """Returns (log, summary, picture) for the folder of a simulation, or for a node's packet log."""
    if os.path.isdir(path) or not os.path.exists(path):
        log = Log(os.path.join(path, "packets.csv"))
        summary = read_summary(os.path.join(path, "summary.json"))
        picture = os.path.join(path, "network.png")
    else:
        log, summary, picture = Log(path), {"energy_j": {}}, os.path.splitext(path)[0] + ".png"
    if "model" not in summary:
        log.count_from_first()
    return log, summary, picture


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument(
        "log",
        help="folder with packets.csv and, for energy, summary.json; or the packet log of a node, whose times are shown from its first packet on",
    )
    parser.add_argument(
        "--out", help="picture (.png, .svg, .pdf); default: network.png in the folder, LOG.png beside a log"
    )
    parser.add_argument(
        "--window",
        nargs=2,
        type=float,
        metavar=("START", "END"),
        help="time window of the picture of the senders [s]; default: the first sixty airtimes",
    )
    arguments = parser.parse_args()
    if arguments.window and not arguments.window[1] > arguments.window[0]:
        parser.error("--window: END is not after START")
    log, summary, picture = read(arguments.log)
    out = arguments.out or picture
    out += "" if os.path.splitext(out)[1] else ".png"  # the file name that is written
    draw(log, summary, arguments.window, out)
    print(out)
    return 0


if __name__ == "__main__":
    # ValueError: an unknown kind of picture.
    run_program("plot_network", main, ValueError)
