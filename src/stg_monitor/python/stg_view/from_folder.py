"""Recordings of folders (`evaluate --record`, `simulate`, a training) and of packet logs."""

import csv
import math
import pathlib

from stg_common.csv_files import number, optional, table_rows
from stg_common.files import Damaged, FileError, opened, read_json
from stg_common.yaml_files import read_yaml

from stg_view.recording import FATES, MAGIC, Recording, RecordingError, messages

NAN = math.nan
GONE = (NAN, NAN, NAN)
OPTIONAL = "sequence transmit_s transmit_end_s begin_s arrival_s distance_m sinr_db error_probability"
LOG = {"source": str, "destination": str, "bytes": number, "offered_s": number, "fate": str}
MOST_NODES, MOST_POSITIONS = 512, 2000


def read_folder(path):
    """The bytes of the recording of a folder or packet log. Raises FileError if there is no run in it."""
    path = pathlib.Path(path)
    if path.is_file() and path.suffix == ".csv":
        return read_log(path).encoded()
    if path.is_file():
        return read_recording(path)
    if (path / "recording.stgv").is_file():
        return read_recording(path / "recording.stgv")
    if (path / "packets.csv").is_file():
        return read_simulation(path).encoded()
    if (path / "progress.csv").is_file():
        return read_training(path).encoded()
    raise FileError(path, "holds no recording.stgv, no packets.csv and no progress.csv: nothing to report")


def read_recording(path):
    """The bytes of a recording, after a check."""
    with opened(path) as file:
        data = file.read()
    try:
        kinds = [header["kind"] for header, _ in messages(data)]
    except RecordingError as error:
        raise Damaged(path, error) from None
    if "steps" not in kinds and "packets" not in kinds and "curves" not in kinds:
        raise Damaged(path, "holds no steps and no packets")
    assert data.startswith(MAGIC)
    return data


def _fate(text):
    if text not in FATES:
        raise ValueError
    return FATES.index(text)


def read_log(path, names=None):
    """A Recording of a packet log that `simulate` or the channel's node has written."""
    kinds = {**LOG, "fate": _fate, **dict.fromkeys(OPTIONAL.split(), optional(number))}
    rows = list(table_rows(path, kinds))
    if names is None:
        found = {row["source"] for row in rows} | {row["destination"] for row in rows}
        names = sorted(found, key=lambda n: (not n.isdecimal(), len(n) if n.isdecimal() else 0, n))
    if len(names) > MOST_NODES:
        raise Damaged(path, f"{len(names)} nodes, more than {MOST_NODES}")
    index = {name: i for i, name in enumerate(names)}
    recording = Recording(title=f"Packets of {path.name}", agents=len(names), targets=0, names=names)
    # The log of a node has times of its clock.
    first = min((row["offered_s"] for row in rows), default=0.0)
    start = first if first > 1e6 else 0.0
    ago = lambda x: NAN if x is None else x - start
    for line, row in enumerate(rows, start=2):
        ends = [row["source"], row["destination"]]
        if any(name not in index for name in ends):
            raise Damaged(path, "source or destination is not a node", line)
        sequence = row["sequence"]
        recording.packets.add(
            index[ends[0]], index[ends[1]], -1 if sequence is None else int(sequence) % (1 << 31),
            int(row["bytes"]), row["fate"], row["offered_s"] - start, ago(row["transmit_s"]),
            ago(row["transmit_end_s"]), ago(row["arrival_s"]),
            *(NAN if row[c] is None else row[c] for c in ("distance_m", "sinr_db", "error_probability")),
        )  # fmt: skip
    if not rows:
        recording.notes.append("No packet was sent.")
    return recording


def read_simulation(folder):
    """A Recording of a folder of `simulate`: packets, and the moving nodes if its file has them."""
    simulation, names = {}, None
    file = folder / "simulation.yaml"
    if file.is_file():
        simulation = read_yaml(file)
        nodes = simulation.get("nodes") if isinstance(simulation, dict) else None
        if not isinstance(nodes, list) or not all(isinstance(n, dict) and "id" in n for n in nodes):
            raise Damaged(file, "nodes: is not a list of nodes")
        names = [str(node["id"]) for node in sorted(nodes, key=lambda node: node["id"])]
    recording = read_log(folder / "packets.csv", names)
    recording.meta["title"] = f"Network of {folder.resolve().name}"
    if names is not None:
        add_ways(recording, simulation, folder)
        channel = simulation.get("channel") or {}
        recording.meta["channel"] = str(channel.get("model", ""))
    if (folder / "summary.json").is_file():
        summary = read_json(folder / "summary.json")
        if isinstance(summary, dict):
            plain = {k: v for k, v in summary.items() if isinstance(v, (int, float, str, bool))}
            recording.add("summary", episode=0, metrics=plain)
    return recording


def add_ways(recording, simulation, folder):
    """Adds the positions of the nodes as steps."""
    duration = simulation.get("duration_s")
    if not isinstance(duration, (int, float)) or not 0 < duration < 1e9:
        return
    nodes = sorted(simulation["nodes"], key=lambda n: n["id"])
    ways = [way_of(node, folder) for node in nodes]
    unknown = [str(node["id"]) for node, way in zip(nodes, ways) if way is None]
    if unknown:
        names = ", ".join(unknown)
        recording.notes.append(f"Nodes whose motion has no file in the folder are not in the scene: {names}.")
    if len(unknown) == len(nodes):
        return
    moves = any(len(way or ()) > 1 for way in ways) or any("joins_s" in n or "leaves_s" in n for n in nodes)
    count = min(MOST_POSITIONS, 1 + int(duration)) if moves else 2
    extent = 1.0
    for k in range(count):
        t = duration * k / (count - 1)
        points = [x for node, way in zip(nodes, ways) for x in (at_time(way, t) if is_there(node, t) else GONE)]
        extent = max([extent, *(abs(x) for x in points if x == x)])
        recording.steps.add(t=t, position=points)
    recording.meta["half_extent_m"] = 1.05 * extent
    recording.meta["open"] = True


def is_there(node, t):
    """True if a node has joined and has not left."""
    joins, leaves = (node.get(key) for key in ("joins_s", "leaves_s"))
    return not (isinstance(joins, (int, float)) and t < joins) and not (isinstance(leaves, (int, float)) and t >= leaves)


def way_of(node, folder):
    """[(t, x, y, z)] of a node in the file; None if it has no positions."""
    try:
        if "track" in node:
            kinds = dict.fromkeys(("t", "x", "y", "z"), number)
            return [tuple(row[c] for c in kinds) for row in table_rows(folder / node["track"], kinds)] or None
        p = [float(x) for x in node["position_m"]]
        v = [float(x) for x in node.get("velocity_mps", (0.0, 0.0, 0.0))]
    except (FileError, KeyError, TypeError, ValueError):
        return None
    far = 1e6
    if not any(v):
        return [(0.0, *p)]
    return [(0.0, *p), (far, *(a + far * b for a, b in zip(p, v)))]


def at_time(way, t):
    """The point of a way at a time: straight lines between its points, and at rest before and after."""
    if way is None:
        return GONE
    if t <= way[0][0]:
        return way[0][1:]
    for before, after in zip(way, way[1:]):
        if t <= after[0]:
            share = (t - before[0]) / ((after[0] - before[0]) or 1.0)
            return tuple(a + share * (b - a) for a, b in zip(before[1:], after[1:]))
    return way[-1][1:]


def read_training(folder):
    """A Recording of a training's folder, with its curves."""
    path = folder / "progress.csv"
    recording = Recording(title=f"Training in {folder.resolve().name}", agents=0, targets=0)
    with opened(path) as file:
        header = file.readline().decode("utf-8", "replace")
    names = next(csv.reader([header]), [])
    rows = list(table_rows(path, {}, others=lambda name: lambda text: text))
    columns = {}
    for name in names:
        values = [_number_or_nan(row[name]) for row in rows]
        if any(value == value for value in values):
            columns[name] = values
    across = next((n for n in ("steps", "step", "env_steps", "update") if n in columns), None)
    if across is None or len(rows) < 2:
        raise Damaged(path, "has no curves: fewer than two rows, or no column steps")
    # Otherwise in the order of the file.
    for name, values in sorted(columns.items(), key=lambda column: rank_of(column[0])):
        if name != across:
            recording.add(
                "curves", [(across, "f8", columns[across]), (name, "f8", values)], title=name.replace("_", " "), x=across
            )  # fmt: skip
    return recording


def rank_of(name):
    """Place of a curve among the others: results of a training come first, and its costs come last."""
    if name.endswith("seconds") or name in ("collection", "episodes", "learning_rate"):
        return 4
    return ("return" not in name) * (1 if name.startswith("validation") else 2 if name.startswith(("train", "reward")) else 3)


def _number_or_nan(text):
    try:
        return number(text)
    except ValueError:
        return NAN
