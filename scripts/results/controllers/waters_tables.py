#!/usr/bin/python3
"""Flies the controllers through the tasks of docs/waters.md and writes their table.

Usage: waters_tables.py OUT [--episodes N] [--evaluate FILE] [--workers N] [--known] in a built and sourced
workspace. Writes OUT/waters.md and OUT/waters.csv; OUT/flights.jsonl keeps what was flown, and a run
that is started again goes on from there. Searches fly twice as many episodes. --known: flies nothing and
writes the table of what was flown.
"""

import argparse
import csv
import json
import os
import sys

import flights
from stg_common.files import read_text
from stg_common.program import run_program

SEED = 5000000  # of the block for reporting
PURSUIT = "pursuit_separated:gain=0.1,standoff=90,cap=0.9,repulsion=0.05,repulsion-range=60"
FORMATION = "formation:weave-below=0.5"
ALL = ("own", "silent", "true states")
TALK = ("own", "silent")
OWN = ("own",)
# Scenario, condition, episodes as a multiple, rows of controller and what it knows.
TASKS = (
    ("hunt", "nominal", 1, ((FORMATION, ALL), ("contain", OWN), ("encircle", ALL))),
    ("search", "nominal", 2, (
        ("search_map", TALK), ("parallel_sweep", OWN), ("greedy_search", OWN),
        ("expanding_square", OWN), ("encircle", ("own", "true states")),
    )),
    ("search_evasive", "nominal", 2, (
        ("search_map", TALK), ("search_map:form=1", OWN), ("parallel_sweep", OWN),
        ("encircle", ("own", "true states")), (FORMATION, ("true states",)),
    )),
    ("field", "sparse", 1, ((FORMATION, ALL), ("search_map:form=1", OWN), ("encircle", OWN))),
    ("field", "combined_stress", 1, (("search_map", TALK), (FORMATION, OWN), ("encircle", OWN), (PURSUIT, OWN))),
    ("field", "clutter", 1, (("encircle", TALK), (FORMATION, OWN))),
    ("field", "fast_target", 1, ((FORMATION, TALK), ("encircle", OWN))),
    ("many8", "nominal", 1, (("encircle", TALK), (FORMATION, OWN))),
)
# Name in the JSON, heading, digits.
COLUMNS = (
    ("return", "return", 0), ("band_share", "in band", 3), ("worst_band_share", "worst AUV", 3),
    ("whole_lost_rate", "lost", 3), ("found", "found", 3), ("time_to_detect", "detected after [s]", 0),
    ("time_to_gather", "gathered after [s]", 0), ("spread", "spread", 2), ("info_spread", "info spread", 2),
    ("own_rmse", "own frame [m]", 1), ("own_95", "95 % [m]", 1), ("nees", "NEES", 1),
    ("followed", "followed", 3), ("target_net_speed", "net speed", 2), ("near_pairs", "pairs < 20 m", 4),
    ("colliding_pairs", "contact", 5), ("groundings", "groundings", 2),
)


def row_of(task, condition, controller, knows, found):
    """A line of the table in Markdown."""
    values = [f"{found[column]:.{digits}f}" for column, _, digits in COLUMNS]
    name = controller if controller != PURSUIT else "pursuit_separated"
    return f"| {task} | {condition} | `{name}` | {knows} | {found['episodes']} | " + " | ".join(values) + " |\n"


def write(out, rows):
    """Writes both files."""
    with open(os.path.join(out, "waters.csv"), "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        names = [name for column, _, _ in COLUMNS for name in (column, column + "_std")]
        table.writerow(["scenario", "condition", "controller", "knows", "episodes", *names])
        for *cell, found in rows:
            table.writerow([*cell, found["episodes"], *(found[name] for name in names)])
    with open(os.path.join(out, "waters.md"), "w", encoding="utf-8") as file:
        file.write(
            f"# Waters where a law is not enough\nEpisodes from seed {SEED} on, means over episodes, standard "
            "deviations in `waters.csv`; by `scripts/results/controllers/waters_tables.py`. Tasks, laws and metrics: "
            "[waters](../../waters.md). A controller decides on its own estimates (own), on them with every "
            "packet lost (silent), or on true states, which leave nothing to search.\n\n"
        )
        heads = ["scenario", "condition", "controller", "knows", "episodes"]
        heads += [head for _, head, _ in COLUMNS]
        file.write("| " + " | ".join(heads) + " |\n|---|---|---|---|---:|" + "---:|" * len(COLUMNS) + "\n")
        for row in rows:
            file.write(row_of(*row))


def rows_known(file):
    """What was flown before on the seeds for reporting, in the order of the tasks."""
    rows = []
    for line in read_text(file).splitlines():
        flight = json.loads(line)
        policy, scenario, condition, _, seed, *rest = flight["asked"]
        if seed == SEED:
            knows = "true states" if "--privileged" in rest else "silent" if rest else "own"
            rows.append((scenario, condition, policy, knows, flight["found"]))
    order = [task[:2] for task in TASKS]
    return sorted(rows, key=lambda row: (order.index(row[:2]), row[2], ALL.index(row[3])))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("out")
    parser.add_argument("--episodes", type=flights.count, default=200)
    parser.add_argument("--evaluate", default="evaluate", help="program, where not rosrun's")
    parser.add_argument("--workers", type=flights.count, default=1)
    parser.add_argument("--known", action="store_true", help="only what was flown before")
    arguments = parser.parse_args()
    file = os.path.join(arguments.out, "flights.jsonl")
    if arguments.known:
        write(arguments.out, rows_known(file))
        return
    known = flights.Flights(file, arguments.evaluate, arguments.workers)
    rows = []
    for scenario, condition, times, laws in TASKS:
        for controller, kinds in laws:
            for knows in kinds:
                found = known.fly(
                    controller, scenario, condition, times * arguments.episodes, SEED,
                    flights.SILENCE if knows == "silent" else (), knows == "true states",
                )
                rows.append((scenario, condition, controller, knows, found))
                print(*rows[-1][:4], f"{found['band_share']:.3f}", file=sys.stderr, flush=True)
    write(arguments.out, rows)


if __name__ == "__main__":
    run_program("waters_tables", main, flights.FlightError, status=1)
