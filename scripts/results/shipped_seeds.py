#!/usr/bin/python3
"""Evaluates the shipped policies' recipe over seeds of training, with and without messages.

In a built and sourced workspace. Writes OUT/seeds.md and OUT/seeds.csv. RUNS/SCENARIO_SEED and
RUNS/silent_SCENARIO_SEED are what train_shipped.sh left, the silent ones trained with `--set channel.extended.loss_probability=1.0`.
"""

import argparse
import glob
import os
import re
import statistics
import subprocess
import sys

from shipped_tables import COLUMNS, CONDITIONS, SCENARIOS, SILENCE, FileError, evaluate, run_program, write

METRICS = [(name, digits) for name, digits in COLUMNS if name != "return_std"]
KINDS = (("", "with messages", ()), ("silent_", "without messages", SILENCE))


def trainings(runs, kind, scenario):
    """Returns [(seed, policy)] of the finished trainings of one kind."""
    found = []
    for policy in glob.glob(os.path.join(runs, f"{kind}{scenario}_*", "hold", "policy_last.onnx")):
        seed = re.fullmatch(rf"{kind}{scenario}_(\d+)", policy.split(os.sep)[-3])
        if seed:
            found.append((int(seed[1]), policy))
    if len(found) < 2:
        raise FileError(
            f"{runs}/{kind}{scenario}_SEED", f"{len(found)} finished trainings, needs two or more"
        )
    return sorted(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("out", metavar="OUT")
    parser.add_argument("runs", metavar="RUNS")
    arguments = parser.parse_args()
    out, runs = arguments.out, arguments.runs
    lines = []
    table = [["scenario", "condition", "trained and flown", "seed"] + [name for name, _ in METRICS]]
    policies = {(s, kind): trainings(runs, kind, s) for s in SCENARIOS for kind, _, _ in KINDS}
    os.makedirs(out, exist_ok=True)
    for scenario in SCENARIOS:
        lines += [
            f"## {scenario}", "",
            "| condition | trained and flown | seeds | return | tail distance [m] | tail error [m] | lost "
            "| contact | contact, tail | in band |",
            "|---|---|---|---:|---:|---:|---:|---:|---:|---:|",
        ]
        for condition in CONDITIONS:
            for kind, label, options in KINDS:
                rows = []
                for seed, policy in policies[scenario, kind]:
                    found = evaluate(policy, scenario, condition, options)
                    rows.append([found[name] for name, _ in METRICS])
                    table.append([scenario, condition, label, seed] + rows[-1])
                cells = [
                    f"{statistics.mean(values):.{digits}f} ± {statistics.stdev(values):.{digits}f}"
                    for (_, digits), values in zip(METRICS, zip(*rows))
                ]
                lines.append(f"| {condition} | {label} | {len(rows)} | " + " | ".join(cells) + " |")
                print(lines[-1], file=sys.stderr)
        lines.append("")
    write(out, "seeds.md", lines, "seeds.csv", table)


if __name__ == "__main__":
    run_program("shipped_seeds", main, subprocess.CalledProcessError, status=1)
