#!/usr/bin/python3
"""Flies the learned policy of the field and the laws through the same episodes, and writes the page.

Usage: field_policy.py OUT [--policy FILE] [--episodes N] [--workers N] [--training FOLDER ...], in a built and
sourced workspace. Writes OUT/field_policy.md and OUT/field_policy/*.csv; OUT/field_policy/episodes keeps what was
flown, and a run that is started again goes on from there. Differences are paired by episode; their intervals are
bootstrapped over episodes.
"""

import argparse
import csv
import os
import pathlib
import subprocess

import numpy as np

SEED = 5_000_000  # of the block for reporting
SILENCE = ["channel.physical.noise.site_db=200.0"]
CONDITIONS = ("nominal", "fast_target", "far_initialization", "limited_sensing", "degraded_communication",
              "strong_current", "combined_stress")
SIZES = (1, 2, 3, 6, 8, 12, 16, 20)
PURSUIT = "pursuit_separated:gain=0.1,standoff=90,cap=0.9,repulsion=0.05,repulsion-range=60"
COLUMNS = (("band_share", "in band", 3), ("worst_band_share", "worst AUV", 3), ("whole_lost_rate", "lost", 3),
           ("spread", "spread", 2), ("world_rmse", "estimate [m]", 1), ("nees", "NEES", 1),
           ("near_pairs", "pairs < 20 m", 4), ("colliding_pairs", "contact", 5), ("groundings", "groundings", 2),
           ("time_to_band", "to the band [s]", 0), ("return", "return", 0))


def fly(arguments, name, pilot, scenario, condition, overrides, episodes):
    """Numbers of every episode, {column: array}; flown once and kept."""
    kept = arguments.out / "field_policy" / "episodes" / f"{name}.csv"
    kept.parent.mkdir(parents=True, exist_ok=True)
    if not kept.exists():
        command = [arguments.evaluate, "--policy", str(pilot), "--scenario", scenario, "--condition", condition,
                   "--episodes", str(episodes), "--seed", str(SEED), "--workers", str(arguments.workers),
                   "--csv", str(kept)]
        for pair in overrides:
            command += ["--set", pair]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(kept, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def interval(differences, resamples=4000):
    """Mean and its 95 % bootstrap interval over episodes."""
    random = np.random.default_rng(0)
    means = differences[random.integers(len(differences), size=(resamples, len(differences)))].mean(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(differences.mean()), float(low), float(high)


def table(arguments, tasks, pilots, episodes):
    """Markdown rows and CSV rows of tasks [(heading, scenario, condition, overrides)]."""
    lines = ["| waters | who | episodes | " + " | ".join(head for _, head, _ in COLUMNS) + " | in band, policy − it |",
             "|---|---|" + "---:|" * (len(COLUMNS) + 2)]
    records = []
    for heading, scenario, condition, overrides in tasks:
        flown = {}
        for who, pilot, extra in pilots:
            slug = f"{heading}_{who}".replace(" ", "-").replace(",", "").replace("`", "")
            flown[who] = fly(arguments, slug, pilot, scenario, condition, [*overrides, *extra], episodes)
            print(heading, who, round(float(flown[who]["band_share"].mean()), 4), flush=True)
        ours = flown[pilots[0][0]]["band_share"]
        for who, numbers in flown.items():
            cells = [f"{numbers[key].mean():.{digits}f}" for key, _, digits in COLUMNS]
            if who == pilots[0][0]:
                paired, record = "", [0.0, 0.0, 0.0]
            else:
                count = min(len(ours), len(numbers["band_share"]))
                record = interval(ours[:count] - numbers["band_share"][:count])
                paired = f"{record[0]:+.3f} [{record[1]:+.3f}, {record[2]:+.3f}]"
            lines.append(f"| {heading} | {who} | {len(numbers['band_share'])} | " + " | ".join(cells) + f" | {paired} |")
            records.append([heading, who, len(numbers["band_share"]), *(numbers[key].mean() for key, _, _ in COLUMNS), *record])
    return lines, records


def curve(folder):
    """Markdown of a training's validations: every task's share in the band, and how the last compares to the best."""
    with open(pathlib.Path(folder) / "validation.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = list(dict.fromkeys(row["task"] for row in rows))
    steps = list(dict.fromkeys(row["steps"] for row in rows))
    lines = ["| decisions of a swarm | seconds | " + " | ".join(names) + " | mean |",
             "|---:|---:|" + "---:|" * (len(names) + 1)]
    means = []
    for step in steps:
        of = {row["task"]: row for row in rows if row["steps"] == step}
        shares = [float(of[name]["band_share"]) for name in names]
        means.append(sum(shares) / len(shares))
        lines.append(f"| {int(step):,} | {float(of[names[0]]['seconds']):.0f} | "
                     + " | ".join(f"{share:.3f}" for share in shares) + f" | {means[-1]:.3f} |")
    lines.append("")
    lines.append(f"The last is {means[-1] / max(means):.3f} of the best ({means[-1]:.3f} of {max(means):.3f}).")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--policy", type=pathlib.Path, required=True)
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--swarm-episodes", type=int, default=32, help="of the tables of sizes and of silence")
    parser.add_argument("--evaluate", default="evaluate", help="program, where not in the path")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--training", nargs="*", default=[], help="folders of the trainings to show curves of")
    parser.add_argument("--notes", type=pathlib.Path, help="Markdown that the page begins with")
    parser.add_argument("--pursuit", action="store_true", help="pursuit_separated, too")
    parser.add_argument("--conditions", nargs="*", default=list(CONDITIONS))
    parser.add_argument("--sizes", nargs="*", type=int, default=list(SIZES))
    arguments = parser.parse_args()
    policy, law = ("policy", arguments.policy, []), ("`encircle`", "encircle", [])
    pilots = [policy, law] + ([("`pursuit_separated`", PURSUIT, [])] if arguments.pursuit else [])
    stress, records = table(arguments, [(c, "field", c, []) for c in arguments.conditions], pilots, arguments.episodes)
    swarms, more = table(arguments, [(f"{n} AUVs", "field", "nominal", [f"agents={n}"]) for n in arguments.sizes],
                         [policy, law], arguments.swarm_episodes)
    silence, last = table(arguments, [(f"{c}, silent", "field", c, SILENCE) for c in ("nominal", "combined_stress")],
                          [policy, law], arguments.swarm_episodes)
    page = ["# The field, flown by one learned policy",
            f"{arguments.episodes} episodes a cell from seed {SEED}, the same for everybody ({arguments.swarm_episodes} in "
            "the tables of sizes and of silence); by "
            "`scripts/results/controllers/field_policy.py`. The last column is the paired difference of the shares in the "
            "band with its 95 % bootstrap interval over episodes. Metrics: [field.md](../field.md#metrics); what the "
            "policy sees and does: [entities.md](../entities.md).", ""]
    if arguments.notes:
        page += [arguments.notes.read_text(encoding="utf-8").rstrip(), ""]
    page += ["## Four AUVs under stress", *stress, "", "## Other sizes, same file", *swarms, "",
             "## Every packet lost", *silence, ""]
    for folder in arguments.training:
        page += [f"## {pathlib.Path(folder).name.replace('_', ' ').capitalize()}", *curve(folder), ""]
    (arguments.out / "field_policy.md").write_text("\n".join(page).rstrip() + "\n", encoding="utf-8")
    with open(arguments.out / "field_policy" / "cells.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["waters", "who", "episodes", *(key for key, _, _ in COLUMNS), "difference", "low", "high"])
        writer.writerows(records + more + last)


if __name__ == "__main__":
    main()
