#!/usr/bin/python3
"""Flies the classical controllers through every condition of the field, on what they know and on truth.

Usage: field_tables.py OUT [--episodes N] [--evaluate FILE] [--controllers NAME ...] [--conditions NAME
...] [--scenarios NAME ...] [--workers N], in a
built and sourced workspace. Writes OUT/field.md and OUT/field.csv; OUT/flights.jsonl keeps what was
flown, and a run that is started again goes on from there.
"""

import argparse
import csv
import math
import os
import sys

import flights
from stg_common.program import run_program

SEED = 5000000  # of the block for reporting
# The paper's laws at the lengths of the field, chosen by hand on seeds from 7000.
CONTROLLERS = {
    "encircle": "encircle",
    "pursuit_separated": "pursuit_separated:gain=0.1,standoff=90,cap=0.9,repulsion=0.05,repulsion-range=60",
    "pursuit": "pursuit:gain=0.1,standoff=90,cap=0.9",
}
# Name in the JSON, heading, digits.
COLUMNS = (
    ("return", "return", 0), ("band_share", "in band", 3), ("worst_band_share", "worst AUV", 3),
    ("gap_closed", "gap closed", 2), ("whole_lost_rate", "lost", 3), ("lost_in_world", "lost in the world", 3),
    ("time_to_reacquire", "reacquire [s]", 0), ("tracking_error", "error, tail [m]", 1),
    ("own_rmse", "own frame [m]", 1), ("own_95", "95 % [m]", 1), ("world_rmse", "world [m]", 1),
    ("vertical_rmse", "vertical [m]", 1), ("nees", "NEES", 1), ("information_age", "age [s]", 1),
    ("spread", "spread", 2), ("min_separation", "smallest separation [m]", 0), ("near_pairs", "pairs < 20 m", 4),
    ("colliding_pairs", "contact", 5), ("min_altitude", "altitude [m]", 0), ("groundings", "groundings", 2),
    ("collisions", "collisions", 2), ("packets", "packets", 0), ("packet_loss", "packet loss", 2),
    ("modem_energy", "modem [J]", 0),
)
# What a controller decides on: heading, keys, true states.
KNOWLEDGE = (("own", (), False), ("silent", flights.SILENCE, False), ("true states", (), True))


def close_gaps(cells):
    """Sets gap_closed of each flight of one condition: how far its share in the band is from the best on
    own estimates towards that law on true states. Nothing where the two are less than 0.02 apart."""
    own = {c: f["band_share"] for c, knows, f in cells if knows == "own"}
    truth = {c: f["band_share"] for c, knows, f in cells if knows == "true states"}
    best = max(own, key=own.get)
    gap = truth[best] - own[best]
    for _, _, found in cells:
        closed = (found["band_share"] - own[best]) / gap if gap >= 0.02 else float("nan")
        found["gap_closed"], found["gap_closed_std"] = closed, float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("out")
    parser.add_argument("--episodes", type=flights.count, default=100)
    parser.add_argument("--evaluate", default="evaluate", help="program, where not rosrun's")
    parser.add_argument("--controllers", nargs="+", default=list(CONTROLLERS))
    parser.add_argument("--scenarios", nargs="+", default=["field"])
    parser.add_argument("--conditions", nargs="+", default=list(flights.CONDITIONS))
    parser.add_argument("--workers", type=flights.count, default=1)
    arguments = parser.parse_args()
    known = flights.Flights(
        os.path.join(arguments.out, "flights.jsonl"), arguments.evaluate, arguments.workers
    )
    rows = []
    for scenario in arguments.scenarios:
        for condition in arguments.conditions:
            cells = []
            for controller in arguments.controllers:
                for knows, overrides, privileged in KNOWLEDGE:
                    found = known.fly(
                        CONTROLLERS.get(controller, controller), scenario, condition,
                        arguments.episodes, SEED, overrides, privileged,
                    )
                    if "band_share" not in found:
                        raise flights.FlightError(f"{scenario}: is no scenario of open water")
                    cells.append((controller, knows, dict(found)))
                    print(scenario, condition, *cells[-1][:2], f"{found['band_share']:.3f}", file=sys.stderr)
            close_gaps(cells)
            rows += [[scenario, condition, *cell] for cell in cells]
    with open(os.path.join(arguments.out, "field.csv"), "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        names = [name for column, _, _ in COLUMNS for name in (column, column + "_std")]
        table.writerow(["scenario", "condition", "controller", "knows", "episodes", *names])
        for *cell, found in rows:
            table.writerow([*cell, found["episodes"], *(found[name] for name in names)])
    with open(os.path.join(arguments.out, "field.md"), "w", encoding="utf-8") as file:
        file.write(
            f"# The field, flown by classical controllers\n{arguments.episodes} episodes a cell from "
            f"seed {SEED}, means over episodes; by `scripts/results/controllers/field_tables.py`. Metrics: "
            "[field.md](../../field.md#metrics). A controller decides on its own estimates (own), on them "
            "with every packet lost (silent), or on true states. Gap closed: 0 is the best law on its own "
            "estimates, 1 the same law on true states; a dash where the two differ by less than 0.02.\n"
        )
        for scenario in arguments.scenarios:
            heads = ["condition", "controller", "knows"] + [head for _, head, _ in COLUMNS]
            file.write(f"\n## {scenario}\n| " + " | ".join(heads) + " |\n")
            file.write("|---|---|---|" + "---:|" * len(COLUMNS) + "\n")
            for name, condition, controller, knows, found in rows:
                if name != scenario:
                    continue
                values = [
                    "-" if math.isnan(found[column]) else f"{found[column]:.{digits}f}"
                    for column, _, digits in COLUMNS
                ]
                cells = [condition, f"`{controller}`", knows, *values]
                file.write("| " + " | ".join(cells) + " |\n")


if __name__ == "__main__":
    run_program("field_tables", main, flights.FlightError, status=1)
