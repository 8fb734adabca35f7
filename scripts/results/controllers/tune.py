#!/usr/bin/python3
"""Searches for the constants of a controller as policies are trained: on validation seeds only, with
a budget that is stated.

Usage: tune.py SEARCH.yaml TRIALS.csv [--trials N] [--evaluate FILE] [--workers N], in a built and
sourced workspace. SEARCH.yaml, such as those beside this file, says what is searched (its keys are
explained in pursuit_separated.yaml). TRIALS.csv gets a row for each trial, in the order they were
flown. What was flown is kept beside it in TRIALS.jsonl: started again, a search goes on.

Search: the constants of `start`, then random within `space` (uniform; where a range spans a decade
or more, of the logarithm), then near the best so far. The same file draws the same constants.
"""

import argparse
import csv
import math
import os
import random
import sys

import flights
from stg_common.files import Damaged
from stg_common.program import run_program
from stg_common.yaml_files import read_yaml


def is_count(value):
    """Whether a value is a whole number that is not negative."""
    return type(value) is int and value >= 0


def is_number(value):
    """Whether a value is a finite number."""
    return type(value) in (int, float) and abs(value) < math.inf


def are_names(value):
    """Whether a value is a list of names, at least one."""
    return isinstance(value, list) and bool(value) and all(isinstance(v, str) for v in value)


def are_constants(value):
    """Whether a value is a mapping from names to numbers."""
    return isinstance(value, dict) and all(
        isinstance(name, str) and is_number(number) for name, number in value.items()
    )


def is_pair(value):
    """Whether a value is two numbers."""
    return isinstance(value, list) and len(value) == 2 and all(map(is_number, value))


def is_space(value):
    """Whether a value maps names to ranges."""
    return isinstance(value, dict) and all(
        isinstance(name, str) and is_pair(ends) and ends[0] <= ends[1]
        for name, ends in value.items()
    )


def are_starts(value):
    """Whether a value is a list of constants."""
    return isinstance(value, list) and all(map(are_constants, value))


KEYS = {  # what each must be: as a test, and in words
    "controller": (lambda value: isinstance(value, str), "a name"),
    "space": (is_space, "a mapping from names to [least, most]"),
    "start": (are_starts, "a list of mappings from names to numbers"),
    "scenarios": (are_names, "a list of names"),
    "conditions": (are_names, "a list of names"),
    "episodes": (lambda value: is_count(value) and value > 0, "a positive whole number"),
    "seed": (is_count, "a whole number that is not negative"),
    "trials": (lambda value: is_count(value) and value > 0, "a positive whole number"),
    "random_trials": (is_count, "a whole number that is not negative"),
    "step": (lambda value: is_pair(value) and min(value) > 0.0, "[first, last], positive shares"),
    "draws": (is_count, "a whole number that is not negative"),
    "score": (are_constants, "a mapping from names to numbers"),
}


def read(file):
    """Returns the search of a file; throws FileError where it is none."""
    search = read_yaml(file)
    if not isinstance(search, dict):
        raise Damaged(file, "is no mapping")
    wrong = set(KEYS).symmetric_difference(search)
    if wrong:
        raise Damaged(file, f"missing or unknown: {', '.join(sorted(map(str, wrong)))}")
    for key, (good, what) in KEYS.items():
        if not good(search[key]):
            raise Damaged(file, f"{key}: is not {what}")
    for name, value in ((n, v) for start in search["start"] for n, v in start.items()):
        if name not in search["space"]:
            raise Damaged(file, f"start: {name} is not in the space, so that no trial would tell of it")
        if is_logarithmic(search["space"][name]) and value <= 0.0:
            raise Damaged(file, f"start: {name}: {value} is not positive, and its range is searched by"
                                " its logarithm")  # fmt: skip
    if not search["start"] and not search["random_trials"]:
        raise Damaged(file, "start, random_trials: there is nothing to begin with")
    return search


def is_logarithmic(ends):
    """Whether a range is searched by the logarithm: one that spans a decade or more."""
    return ends[0] > 0.0 and ends[1] / ends[0] >= 10.0


def draw(space, centre, step, rng):
    """Returns constants: anywhere, or with a centre near it, by `step` of the range."""
    values = {}
    for name, (lo, hi) in space.items():
        logarithmic = is_logarithmic((lo, hi))
        a, b = (math.log(lo), math.log(hi)) if logarithmic else (lo, hi)
        if centre is None or name not in centre:
            x = rng.uniform(a, b)
        else:
            x = math.log(centre[name]) if logarithmic else centre[name]
            x = min(b, max(a, rng.gauss(x, step * (b - a))))
        values[name] = float(f"{math.exp(x) if logarithmic else x:.4g}")
    return values


def text_of(controller, values):
    """Returns how `evaluate --policy` takes them."""
    constants = ",".join(f"{name}={value:g}" for name, value in values.items())
    return controller + (":" + constants if constants else "")


def fly(search, known, values):
    """Returns (score, means over all cells of what is scored)."""
    found = [
        known.fly(text_of(search["controller"], values), scenario, condition, search["episodes"],
                  search["seed"])
        for scenario in search["scenarios"] for condition in search["conditions"]
    ]
    blocks = {str(cell.get("seed_block")) for cell in found}
    if blocks != {"choosing"}:
        sys.exit(f"tune: nothing may be chosen by seeds of the {', '.join(sorted(blocks))} block")
    unknown = [name for name in search["score"] if not all(is_number(cell.get(name)) for cell in found)]
    if unknown:
        sys.exit(f"tune: score: evaluate tells of no {', '.join(unknown)}")
    means = {name: sum(cell[name] for cell in found) / len(found) for name in search["score"]}
    return sum(weight * means[name] for name, weight in search["score"].items()), means


def trials_of(search, known):
    """Flies the search; yields (trial, score, means, constants) of each trial."""
    rng = random.Random(search["draws"])
    best = None
    first, last = search["step"]
    start, chance = search["start"], len(search["start"]) + search["random_trials"]
    for trial in range(search["trials"]):
        progress = (trial - chance) / max(1, search["trials"] - 1 - chance)
        if trial < len(start):
            values = start[trial]
        elif trial < chance:
            values = draw(search["space"], None, 0.0, rng)
        else:
            values = draw(search["space"], best[1], first * (last / first) ** progress, rng)
        score, means = fly(search, known, values)
        if best is None or score > best[0]:
            best = (score, values)
            print(f"trial {trial}: {score:.4f} {text_of(search['controller'], values)}")
        yield trial, score, means, values


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("search")
    parser.add_argument("out")
    parser.add_argument("--trials", type=flights.count, help="instead of the file's")
    parser.add_argument("--evaluate", default="evaluate", help="program, where not rosrun's")
    parser.add_argument("--workers", type=flights.count, default=1)
    arguments = parser.parse_args()
    search = read(arguments.search)
    search["trials"] = arguments.trials or search["trials"]
    known = flights.Flights(
        os.path.splitext(arguments.out)[0] + ".jsonl", arguments.evaluate, arguments.workers
    )
    names = list(search["space"])
    with open(arguments.out, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["trial", "score", *search["score"], *names])
        for trial, score, means, values in trials_of(search, known):
            # Empty: the controller's own constant.
            table.writerow([trial, f"{score:.4f}", *(f"{mean:.6g}" for mean in means.values()),
                            *(values.get(name, "") for name in names)])  # fmt: skip
            file.flush()
    cells = len(search["scenarios"]) * len(search["conditions"])
    print(f"{search['trials']} trials, {search['trials'] * cells * search['episodes']} episodes")


if __name__ == "__main__":
    run_program("tune", main, flights.FlightError, status=1)
