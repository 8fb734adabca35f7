#!/usr/bin/python3
"""Evaluates the shipped policies and the built-in controllers in acoustic mode, side by side.

In a built and sourced workspace. Writes OUT/tables.md, OUT/results.csv and OUT/summary.md, where
each policy stands beside the controller that returns most on its own estimates. SILENT_FOLDER/SCENARIO.onnx, where given, was trained without messages.
"""

import argparse
import csv
import json
import os
import subprocess
import sys

from stg_common.files import FileError
from stg_common.program import run_program

CONDITIONS = (
    "nominal", "fast_target", "far_initialization", "limited_sensing", "degraded_communication",
    "combined_stress",
)
with open(os.path.join(os.path.dirname(os.path.realpath(__file__)), "shipped_teacher.txt")) as _file:
    TEACHER = _file.read().strip()
# The best trial of scripts/results/controllers/pursuit_separated.yaml, which is in the results.
RETUNED = (
    "pursuit_separated:gain=3.555,cap=1,standoff=0.01383,repulsion=0.1501,repulsion-range=0.05969,"
    "feedforward=1.26,approach-speed=0.0006658,approach-gain=0.865,wall-margin=0.02707"
)
SILENCE = ("--set", "channel.extended.loss_probability=1.0")
COLUMNS = (
    ("return", 1), ("return_std", 1), ("tail_distance", 4), ("tracking_error", 5),
    ("lost_rate", 3), ("colliding_pairs", 3), ("tail_colliding_pairs", 3), ("band_rate", 2),
)
SCENARIOS = ("medium", "hard")
EPISODES, SEED = 100, 5_000_000  # of the reporting block: nothing was chosen by them


def evaluate(policy, scenario, condition, options=()):
    """Returns the metrics that `evaluate` prints on its last line."""
    command = [
        "rosrun", "marl_trainer", "evaluate", "--policy", policy, "--scenario", scenario,
        "--condition", condition, "--episodes", str(EPISODES), "--seed", str(SEED), *options,
    ]
    output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return json.loads(output.strip().splitlines()[-1])


def fliers(scenario, policies, silent):
    """Returns [(label, policy, options)], the rows of one condition."""
    shipped = os.path.join(policies, scenario + ".onnx")
    rows = [(f"policies/{scenario}.onnx", shipped, ()), ("the same, all packets lost", shipped, SILENCE)]
    if silent:
        rows.append(
            ("trained and flown without messages", os.path.join(silent, scenario + ".onnx"), SILENCE)
        )
    return rows + [
        ("pursuit_separated", "pursuit_separated", ()),
        ("pursuit_separated, retuned", RETUNED, ()),
        ("the teacher's law on own estimates", TEACHER, ()),
        ("pursuit_separated, all packets lost", "pursuit_separated", SILENCE),
        ("pursuit", "pursuit", ()),
    ]


CONTROLLERS = {  # on their own estimates, with messages: label to a name for the summary
    "pursuit_separated": "as shipped",
    "pursuit_separated, retuned": "retuned",
    "the teacher's law on own estimates": "teacher's law",
    "pursuit": "pursuit",
}


def summary(rows):
    """Returns the lines of the summary, from the rows of results.csv without their header."""
    lines = [
        "| scenario, condition | return: policy / best controller | which | tail error [mm] "
        "| contact | contact, tail |",
        "|---|---:|---|---:|---:|---:|",
    ]
    names = [name for name, _ in COLUMNS]
    cells = {}
    for scenario, condition, label, *values in rows:
        cell = cells.setdefault((scenario, condition), {})
        cell[label] = dict(zip(names, (float(value) for value in values)))
    for (scenario, condition), cell in cells.items():
        policy = cell[f"policies/{scenario}.onnx"]
        best = max(CONTROLLERS, key=lambda label: cell[label]["return"])
        other = cell[best]
        pairs = [f"{policy[name] * scale:.{digits}f} / {other[name] * scale:.{digits}f}"
                 for name, scale, digits in (("return", 1, 1), ("tracking_error", 1000, 2),
                                             ("colliding_pairs", 1, 3),
                                             ("tail_colliding_pairs", 1, 3))]  # fmt: skip
        lines.append(f"| {scenario}, {condition} | {pairs[0]} | {CONTROLLERS[best]} | "
                     + " | ".join(pairs[1:]) + " |")  # fmt: skip
    return lines + [""]


def write(out, page, lines, table, rows):
    """Writes the lines of a page and the rows of a CSV file, header first, into a folder."""
    os.makedirs(out, exist_ok=True)
    with open(os.path.join(out, page), "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    with open(os.path.join(out, table), "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("out", metavar="OUT")
    parser.add_argument("silent", metavar="SILENT_FOLDER", nargs="?")
    arguments = parser.parse_args()
    out, silent = arguments.out, arguments.silent
    for scenario in SCENARIOS if silent else ():
        if not os.path.isfile(os.path.join(silent, scenario + ".onnx")):
            raise FileError(silent, f"there is no {scenario}.onnx in it")
    package = subprocess.run(
        ["rospack", "find", "stg_bringup"], check=True, stdout=subprocess.PIPE, text=True
    ).stdout.strip()
    os.makedirs(out, exist_ok=True)
    lines = []
    rows = [["scenario", "condition", "who"] + [name for name, _ in COLUMNS]]
    for scenario in SCENARIOS:
        lines += [
            f"## {scenario}", "",
            "| condition | who | return | tail distance [m] | tail error [m] | lost | contact "
            "| contact, tail | in band |",
            "|---|---|---:|---:|---:|---:|---:|---:|---:|",
        ]
        for condition in CONDITIONS:
            for label, policy, options in fliers(scenario, os.path.join(package, "policies"), silent):
                found = evaluate(policy, scenario, condition, options)
                text = [f"{found[name]:.{digits}f}" for name, digits in COLUMNS]
                lines.append(
                    f"| {condition} | {label} | {text[0]} ± {text[1]} | " + " | ".join(text[2:]) + " |"
                )
                rows.append([scenario, condition, label] + [found[name] for name, _ in COLUMNS])
                print(lines[-1], file=sys.stderr)
        lines.append("")
    write(out, "tables.md", lines, "results.csv", rows)
    with open(os.path.join(out, "summary.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(summary(rows[1:])))


if __name__ == "__main__":
    run_program("shipped_tables", main, subprocess.CalledProcessError, status=1)
