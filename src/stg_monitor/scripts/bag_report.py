#!/usr/bin/python3
"""Turns a recorded run into CSV files and a figure of each episode.

Writes into the output folder: poses.csv, targets.csv, tasks.csv, links.csv, steps.csv,
episodes.csv, and report_episode_<n>.png and .svg with trajectories, distances, phases, link
quality and age of information. A column's name ends with its unit; times are simulated.

The chunks of a compressed bag, as record:=true writes them, have a checksum. In an uncompressed bag, a number
that the disk has changed cannot be detected; the last line of output says so.

Exit status: 0 done, 1 the bag holds no run, 2 wrong usage, or a file that cannot be read or written.
"""

import argparse
import bisect
import csv
import math
import os
import re
import sys
from collections import defaultdict

from stg_common.files import FileError
from stg_common.program import run_program
from stg_common.stated import stated
from stg_common.yaml_files import parse_yaml
from stg_view.bag_reading import BagError, messages, open_bag
from stg_view.scenario_reading import sections_of

PHASES = ("search", "approach", "stable", "lost")
QUALITIES = ("high", "medium", "low", "unavailable")
REASONS = (
    "none", "range", "loss", "collision", "half_duplex", "fading", "burst", "queue",
    "not_acquired",
)  # fmt: skip
ODOM = re.compile(r"^/(auv|target)_(\d+)/odom$")
TASK = re.compile(r"^/auv_(\d+)/task_state$")
# Only of episodes in open water; empty in others.
FIELD = (
    "estimate_rmse nees estimate_known information_age band_share time_lost time_to_reacquire"
    " losses spread near_pairs min_altitude min_clearance groundings collisions packets"
    " packet_loss modem_energy"
).split()
EPISODE = (
    "episode t seed scenario policy_id steps complete episode_return tail_distance"
    " tracking_error lost_rate action_norm saturation_rate control_cost"
    " communication_quality band_rate colliding_pairs tail_colliding_pairs min_separation"
    " time_to_band deadline_misses channel_misses"
).split()
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
    "episodes": EPISODE + FIELD,
}


# Unit by the name of a column in the files.
UNITS = {
    "_s": "t neighbour_age delay age average_age peak_age time_to_band",
    "_m": (
        "x y z distance mean_distance tail_distance tracking_error estimate_x estimate_y estimate_z"
        " estimate_std smallest_separation min_separation"
    ),
    "_mps": "u v w vx vy vz",
    "_radps": "p q r",
}
UNIT_OF = {name: unit for unit, names in UNITS.items() for name in names.split()}


class Run:
    """The rows of every table, by table name, and the recorded scenario."""

    def __init__(self):
        self.rows = {name: [] for name in TABLES}
        self.scenario = {}

    def add(self, table, **values):
        """Appends one row. The names must be the columns of the table."""
        self.rows[table].append([values[name] for name in TABLES[table]])

    def column(self, table, name, rows=None):
        """Returns one column of a table."""
        index = TABLES[table].index(name)
        return [row[index] for row in (self.rows[table] if rows is None else rows)]

    def of_episode(self, table, episode):
        """Returns the rows of one episode."""
        return [row for row in self.rows[table] if row[0] == episode]


class EpisodeClock:
    """Finds the episode of a simulated time. Simulated time continues from episode to episode."""

    def __init__(self):
        self.starts = {}

    def see(self, episode, t):
        """Stores that `episode` was running at time t."""
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
    topic = ""
    # The bag itself contains the definitions of its messages. Those of another program, or damaged ones, may
    # lack a field or have another type.
    try:
        for topic, message in messages(bag, path):
            take_message(run, clock, late, topic, message)
        topic = "poses, targets and links"
        add_late(run, late, clock.lookup())
    except (AttributeError, TypeError, ValueError, LookupError) as error:
        raise BagError(f"{path}: {topic}: not of the form that this program records: {error}") from None
    if not run.rows["poses"]:
        raise LookupError(f"{path}: holds no /auv_<i>/odom: not a recorded run")
    return run


def take_message(run, clock, late, topic, message):
    """Adds one message to the tables. `late` gets messages that need the whole run first."""
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


def read_scenario(text):
    """Parses the recorded scenario. An invalid one is left out."""
    try:
        scenario = parse_yaml(text, "/scenario")
        sections_of(scenario, "/scenario")
    except FileError as error:
        print(f"bag_report: {error}; it is ignored", file=sys.stderr)
        return {}
    return scenario


def add_late(run, late, episode_at):
    """Adds messages without an episode number of their own, and each AUV's distance to its target."""
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
    """Returns names[value], or the number itself if there is no name."""
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
    # Older bags do not have the newest columns.
    values = {name: getattr(m, name) for name in EPISODE[2:-1]}
    field = getattr(m, "field", False)
    values.update({name: getattr(m, name) if field else "" for name in FIELD})
    values["channel_misses"] = getattr(m, "channel_misses", "")
    values["complete"] = int(m.complete)
    run.add("episodes", episode=m.episode, t=m.header.stamp.to_sec(), **values)


def write_tables(run, folder):
    """Writes one CSV file per table."""
    for name, columns in TABLES.items():
        with open(os.path.join(folder, f"{name}.csv"), "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(name + UNIT_OF.get(name, "") for name in columns)
            writer.writerows(run.rows[name])


def write_report(run, folder, episodes):
    """Writes the tables, and the figures of these episodes."""
    os.makedirs(folder, exist_ok=True)
    write_tables(run, folder)
    if episodes:
        # Imported here, because matplotlib takes a second to load.
        from stg_view.bag_figure import draw_episode

        for episode in episodes:
            draw_episode(run, episode, os.path.join(folder, f"report_episode_{episode}"))


def parse_arguments(arguments):
    """Returns the parsed command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("bag", help="recorded run")
    parser.add_argument("-o", "--out", help="output folder (default: the bag's name + _report)")
    parser.add_argument("--episode", type=int, help="draw this episode only (default: all)")
    parser.add_argument("--max-figures", type=int, default=10, help="draw at most this number of figures (default: 10)")
    parser.add_argument("--no-figures", action="store_true", help="write the CSV files only")
    parser.add_argument(
        "--salvage", action="store_true", help="read the complete part of a truncated bag"
    )
    options = parser.parse_args(arguments)
    if options.max_figures < 0:
        parser.error("--max-figures must not be negative")
    given = stated(parser, arguments)
    for name, other, why in (
        ("episode", "no_figures", "no figure is drawn"),
        ("max_figures", "no_figures", "no figure is drawn"),
        ("max_figures", "episode", "one figure is drawn"),
    ):
        if name in given and other in given:
            option, beside = (f"--{word.replace('_', '-')}" for word in (name, other))
            parser.error(f"{option} has no effect with {beside}, because {why}")
    return options


def main(arguments=None):
    """Runs the tool; returns the exit status."""
    options = parse_arguments(arguments)
    try:
        with open_bag(options.bag, options.salvage) as bag:
            run = read_run(bag, options.bag)
            verified = bag.get_compression_info().compression != "none"
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
    try:
        write_report(run, folder, [] if options.no_figures else episodes[: options.max_figures])
    except OSError as error:
        print(f"bag_report: cannot write to {folder}: {error}", file=sys.stderr)
        return 2
    note = "" if verified else " (uncompressed bag: its numbers have no checksum)"
    print(f"bag_report: {len(episodes)} episode(s), written to {folder}{note}")
    return 0


if __name__ == "__main__":
    run_program("bag_report", main)
