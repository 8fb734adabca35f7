#!/usr/bin/python3
"""Turns a recorded run into CSV files and a figure of each episode.

Writes into the output folder: poses.csv, targets.csv, tasks.csv, links.csv, steps.csv,
episodes.csv, and report_episode_<n>.png and .svg with trajectories, distances, phases, link
quality and age of information. Lengths are metres, times seconds of simulated time.

Exit status: 0 done, 1 the bag holds no run, 2 wrong usage or a file that cannot be read.
"""

import argparse
import bisect
import csv
import math
import os
import re
import shutil
import sys
import tempfile
from collections import defaultdict

import rosbag
import yaml

# rosrun starts this file through a relay elsewhere; bag_figure.py lies beside the file itself.
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

PHASES = ("search", "approach", "stable", "lost")
QUALITIES = ("high", "medium", "low", "unavailable")
REASONS = (
    "none", "range", "loss", "collision", "half_duplex", "fading", "burst", "queue",
    "not_acquired",
)  # fmt: skip
ODOM = re.compile(r"^/(auv|target)_(\d+)/odom$")
TASK = re.compile(r"^/auv_(\d+)/task_state$")
TABLES = {
    "poses": "episode t auv x y z qw qx qy qz u v w p q r distance".split(),
    "targets": "episode t target x y z vx vy vz".split(),
    "tasks": (
        "episode t step auv phase quality role target_known estimate_x estimate_y estimate_z"
        " estimate_std distance tracking_error confidence neighbour_age policy_id"
    ).split(),
    "links": (
        "episode t source destination distance quality loss_probability delay age average_age"
        " peak_age delivered dropped last_drop_reason"
    ).split(),
    "steps": (
        "episode t step reward mean_distance colliding_pairs smallest_separation truncated"
    ).split(),
    "episodes": (
        "episode t seed scenario policy_id steps complete episode_return tail_distance"
        " tracking_error lost_rate action_norm saturation_rate control_cost"
        " communication_quality band_rate colliding_pairs tail_colliding_pairs min_separation"
        " time_to_band deadline_misses"
    ).split(),
}


class BagError(Exception):
    """A bag that cannot be read, told in words for the user."""


class Run:
    """The rows of every table, by table name, and the recorded scenario."""

    def __init__(self):
        self.rows = {name: [] for name in TABLES}
        self.scenario = {}

    def add(self, table, **values):
        """Appends one row; the names must be those of the table."""
        self.rows[table].append([values[name] for name in TABLES[table]])

    def column(self, table, name, rows=None):
        """Returns one column of a table."""
        index = TABLES[table].index(name)
        return [row[index] for row in (self.rows[table] if rows is None else rows)]

    def of_episode(self, table, episode):
        """Returns the rows of one episode."""
        return [row for row in self.rows[table] if row[0] == episode]


def open_bag(path, salvage):
    """Opens a bag for reading; with `salvage`, what is whole of a truncated one."""
    if not os.path.exists(path):
        raise BagError(f"{path}: no such file")
    if os.path.isdir(path):
        raise BagError(f"{path}: is a folder, not a bag")
    if os.path.getsize(path) == 0:
        raise BagError(f"{path}: is empty")
    try:
        return rosbag.Bag(path)
    except rosbag.ROSBagUnindexedException:
        if salvage:
            return salvaged(path)
        raise BagError(
            f"{path}: is truncated or was not closed (it has no index);"
            " --salvage reads what is whole of it"
        ) from None
    except (rosbag.ROSBagException, OSError, ValueError) as error:
        if salvage and looks_like_bag(path):
            return salvaged(path)
        raise BagError(f"{path}: cannot be read as a bag: {error}") from None


def looks_like_bag(path):
    """True when a file starts as bags do."""
    with open(path, "rb") as bag:
        return bag.read(13) == b"#ROSBAG V2.0\n"


def salvaged(path):
    """Indexes a copy of a truncated bag and opens that; the bag itself is left as it is."""
    folder = tempfile.mkdtemp(prefix="bag_report_")
    try:
        copy = os.path.join(folder, "salvaged.bag")
        shutil.copyfile(path, copy)
        with rosbag.Bag(copy, "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass
        print(f"bag_report: {path} is truncated; reading what is whole", file=sys.stderr)
        return rosbag.Bag(copy)
    except Exception as error:  # rosbag raises whatever it trips over in damaged data
        raise BagError(f"{path}: nothing of it can be salvaged: {error}") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def messages(bag, path):
    """Yields (topic, message); damage inside the bag becomes a BagError."""
    try:
        for topic, message, _ in bag.read_messages():
            yield topic, message
    except Exception as error:  # damaged chunks raise anything from struct.error to bz2's
        raise BagError(f"{path}: is damaged: {type(error).__name__}: {error}") from None


class EpisodeClock:
    """Tells the episode of a simulated time: simulated time goes on from episode to episode."""

    def __init__(self):
        self.starts = {}

    def see(self, episode, t):
        """Notes that `episode` was running at time t."""
        self.starts[episode] = min(t, self.starts.get(episode, math.inf))

    def lookup(self):
        """Returns a function from time to episode."""
        order = sorted((t, episode) for episode, t in self.starts.items())
        times = [t for t, _ in order]

        def episode_at(t):
            k = bisect.bisect_right(times, t + 1e-9) - 1
            return order[max(k, 0)][1] if order else 0

        return episode_at


def read_run(bag, path):
    """Reads everything the tables need from an open bag."""
    run, clock, late = Run(), EpisodeClock(), []
    for topic, message in messages(bag, path):
        odom, task = ODOM.match(topic), TASK.match(topic)
        if odom:
            late.append((odom.group(1), int(odom.group(2)), message))
        elif task:
            clock.see(message.episode, message.header.stamp.to_sec())
            add_task(run, int(task.group(1)), message)
        elif topic == "/acoustic_channel/links":
            late.append(("links", 0, message))
        elif topic == "/step_report":
            add_step(run, message)
        elif topic == "/episode_summary":
            add_summary(run, message)
        elif topic == "/scenario":
            run.scenario = read_scenario(message.data)
    add_late(run, late, clock.lookup())
    if not run.rows["poses"]:
        raise LookupError(f"{path}: holds no /auv_<i>/odom: not a recorded run")
    return run


def read_scenario(text):
    """Parses the recorded scenario; one that does not parse is left out."""
    try:
        scenario = yaml.safe_load(text)
    except yaml.YAMLError as error:
        print(f"bag_report: /scenario is ignored: {error}", file=sys.stderr)
        return {}
    return scenario if isinstance(scenario, dict) else {}


def add_late(run, late, episode_at):
    """Adds what carries no episode number of its own, and each AUV's distance to its target."""
    target_positions = defaultdict(dict)
    targets = 1 + max((index for kind, index, _ in late if kind == "target"), default=-1)
    for kind, index, message in late:
        if kind == "target":
            p = message.pose.pose.position
            target_positions[message.header.stamp.to_nsec()][index] = (p.x, p.y, p.z)
    for kind, index, message in late:
        t = message.header.stamp.to_sec()
        episode = episode_at(t)
        if kind == "links":
            for link in message.links:
                add_link(run, episode, t, link)
            continue
        p, q = message.pose.pose.position, message.pose.pose.orientation
        v, w = message.twist.twist.linear, message.twist.twist.angular
        if kind == "target":
            run.add("targets", episode=episode, t=t, target=index, x=p.x, y=p.y, z=p.z,
                    vx=v.x, vy=v.y, vz=v.z)  # fmt: skip
            continue
        own = target_positions[message.header.stamp.to_nsec()].get(index % max(targets, 1))
        distance = math.dist(own, (p.x, p.y, p.z)) if own else math.nan
        run.add("poses", episode=episode, t=t, auv=index, x=p.x, y=p.y, z=p.z, qw=q.w, qx=q.x,
                qy=q.y, qz=q.z, u=v.x, v=v.y, w=v.z, p=w.x, q=w.y, r=w.z,
                distance=distance)  # fmt: skip


def name_of(names, value):
    """Returns names[value], or the number itself where there is none."""
    return names[value] if value < len(names) else str(value)


def add_task(run, auv, m):
    """Adds one TaskState."""
    run.add(
        "tasks", episode=m.episode, t=m.header.stamp.to_sec(), step=m.step, auv=auv,
        phase=name_of(PHASES, m.phase), quality=name_of(QUALITIES, m.quality), role=int(m.role),
        target_known=int(m.target_known), estimate_x=m.target_position.x,
        estimate_y=m.target_position.y, estimate_z=m.target_position.z,
        estimate_std=m.target_std, distance=m.target_distance,
        tracking_error=m.tracking_error, confidence=m.confidence,
        neighbour_age=m.neighbour_age, policy_id=m.policy_id,
    )  # fmt: skip


def add_link(run, episode, t, m):
    """Adds one LinkState."""
    run.add(
        "links", episode=episode, t=t, last_drop_reason=name_of(REASONS, m.last_drop_reason),
        **{name: getattr(m, name) for name in TABLES["links"][2:-1]},
    )  # fmt: skip


def add_step(run, m):
    """Adds one StepReport."""
    distances = list(m.distances)
    run.add(
        "steps", episode=m.episode, t=m.header.stamp.to_sec(), step=m.step, reward=m.reward,
        mean_distance=sum(distances) / len(distances) if distances else math.nan,
        colliding_pairs=m.colliding_pairs, smallest_separation=m.smallest_separation,
        truncated=int(m.truncated),
    )  # fmt: skip


def add_summary(run, m):
    """Adds one EpisodeSummary."""
    values = {name: getattr(m, name) for name in TABLES["episodes"][2:]}
    values["complete"] = int(m.complete)
    run.add("episodes", episode=m.episode, t=m.header.stamp.to_sec(), **values)


def write_tables(run, folder):
    """Writes one CSV file per table."""
    for name, columns in TABLES.items():
        with open(os.path.join(folder, f"{name}.csv"), "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(run.rows[name])


def parse_arguments(arguments):
    """Returns the parsed command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("bag", help="recorded run")
    parser.add_argument("-o", "--out", help="output folder (default: the bag's name + _report)")
    parser.add_argument("--episode", type=int, help="draw this episode only (default: all)")
    parser.add_argument("--max-figures", type=int, default=10, help="draw at most so many")
    parser.add_argument("--no-figures", action="store_true", help="write the CSV files only")
    parser.add_argument(
        "--salvage", action="store_true", help="read what is whole of a truncated bag"
    )
    return parser.parse_args(arguments)


def main(arguments=None):
    """Runs the tool; returns the exit status."""
    options = parse_arguments(arguments)
    try:
        with open_bag(options.bag, options.salvage) as bag:
            run = read_run(bag, options.bag)
    except BagError as error:
        print(f"bag_report: {error}", file=sys.stderr)
        return 2
    except LookupError as error:
        print(f"bag_report: {error}", file=sys.stderr)
        return 1
    episodes = sorted(set(run.column("poses", "episode")))
    if options.episode is not None:
        if options.episode not in episodes:
            print(f"bag_report: no episode {options.episode}; there are {episodes}",
                  file=sys.stderr)  # fmt: skip
            return 2
        episodes = [options.episode]
    folder = options.out or os.path.splitext(options.bag)[0] + "_report"
    os.makedirs(folder, exist_ok=True)
    write_tables(run, folder)
    if not options.no_figures:
        from bag_figure import draw_episode  # matplotlib takes a second to load

        for episode in episodes[: options.max_figures]:
            draw_episode(run, episode, os.path.join(folder, f"report_episode_{episode}"))
    print(f"bag_report: {len(episodes)} episode(s), written to {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
