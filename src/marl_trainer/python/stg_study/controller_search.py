"""A search for the constants of a controller. Like the training of policies, it uses only seeds for choosing
and has a stated budget.

The search flies the constants of `start`, then random ones within `space` (uniform; in the logarithm if a
range spans a decade or more), then constants near the best ones so far. The same file always draws the same
constants. With few episodes, luck affects the choice, too. So with `finals`, the best trials fly again, with
more episodes from another seed of the block for choosing, and the best of these is chosen.
"""

import hashlib
import io
import math
import os
import random

from stg_common.files import Damaged
from stg_study.collect import csv_text
from stg_study.files import write_atomically
from stg_study.finished import Finished
from stg_study.jobs import Flight
from stg_study.runner import Runner
from stg_study.study import StudyError

CHOOSING = "choosing"  # the block of seeds for choices


def is_count(value):
    """True if a value is a whole number that is not negative."""
    return type(value) is int and value >= 0


def is_number(value):
    """True if a value is a finite number."""
    return type(value) in (int, float) and abs(value) < math.inf


def are_names(value):
    """True if a value is a list of at least one name."""
    return isinstance(value, list) and bool(value) and all(isinstance(v, str) for v in value)


def are_constants(value):
    """True if a value maps names to numbers."""
    return isinstance(value, dict) and all(
        isinstance(name, str) and is_number(number) for name, number in value.items()
    )


def is_pair(value):
    """True if a value is a list of two numbers."""
    return isinstance(value, list) and len(value) == 2 and all(map(is_number, value))


def is_space(value):
    """True if a value maps names to ranges."""
    return isinstance(value, dict) and all(
        isinstance(name, str) and is_pair(ends) and ends[0] <= ends[1]
        for name, ends in value.items()
    )


def are_starts(value):
    """True if a value is a list of constants."""
    return isinstance(value, list) and all(map(are_constants, value))


KEYS = {  # required keys: test of the value, and its text for messages
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


def are_overrides(value):
    """True if a value is a list of texts."""
    return isinstance(value, list) and all(isinstance(v, str) for v in value)


def are_finals(value):
    """True if a value states how the best trials fly again."""
    return (isinstance(value, dict) and set(value) == {"trials", "episodes", "seed"}
            and all(is_count(v) for v in value.values()) and value["trials"] > 0
            and value["episodes"] > 0)  # fmt: skip


MAY = {  # optional keys, with their defaults
    "set": (are_overrides, "a list of KEY=VALUE", []),  # overrides of the scenarios
    "finals": (are_finals, "trials, episodes, seed", None),
}


def checked(search, file):
    """Returns the search of a file. Raises Damaged if it is invalid."""
    wrong = set(KEYS).symmetric_difference(search) - set(MAY)
    if wrong:
        raise Damaged(file, f"missing or unknown: {', '.join(sorted(map(str, wrong)))}")
    for key, (good, what, otherwise) in MAY.items():
        if key in search and not good(search[key]):
            raise Damaged(file, f"{key}: is not {what}")
        search.setdefault(key, otherwise)
    for key, (good, what) in KEYS.items():
        if not good(search[key]):
            raise Damaged(file, f"{key}: is not {what}")
    for name, value in ((n, v) for start in search["start"] for n, v in start.items()):
        if name not in search["space"]:
            raise Damaged(file, f"start: {name} is not in the key space, so no trial would use it")
        if is_logarithmic(search["space"][name]) and value <= 0.0:
            raise Damaged(file, f"start: {name}: {value} must be positive, because its range is searched by"
                                " its logarithm")  # fmt: skip
    if not search["start"] and not search["random_trials"]:
        raise Damaged(file, "start, random_trials: give at least one of the two")
    return search


def is_logarithmic(ends):
    """True if a range is searched in the logarithm, because it spans a decade or more."""
    return ends[0] > 0.0 and ends[1] / ends[0] >= 10.0


def draw(space, centre, step, rng):
    """Returns random constants: anywhere, or near a centre if there is one, by `step` of the range."""
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
    """Returns the constants in the form that `evaluate --policy` takes."""
    constants = ",".join(f"{name}={value:g}" for name, value in values.items())
    return controller + (":" + constants if constants else "")


class Interrupted(Exception):
    """The search was asked to stop. The same command continues it."""


def _jobs(search, policy, work, bin_dir):
    """The flights of one trial: one cell for each scenario and condition."""
    jobs = []
    overrides = [word for one in search["set"] for word in ("--set", one)]
    for scenario in search["scenarios"]:
        for condition in search["conditions"]:
            arguments = ["--scenario", scenario, "--condition", condition]
            arguments += ["--episodes", str(search["episodes"]), "--seed", str(search["seed"]), *overrides]
            key = hashlib.sha256(" ".join([policy, *arguments]).encode()).hexdigest()[:16]
            base = os.path.join(work, "flights", key)
            name = f"{policy} on {scenario} {condition}"
            jobs.append(Flight(name, policy, arguments, search["episodes"], base, bin_dir, block=CHOOSING))
    return jobs


def _results(search, jobs, parallel, finished):
    """The scored metrics of each job. Flies what is neither flown nor kept."""

    def kept(job):
        numbers = finished.find(job.words())
        return numbers if numbers is not None and set(search["score"]) <= set(numbers) else None

    waiting = [job for job in jobs if kept(job) is None and not job.complete()]
    if waiting:
        runner = Runner([], waiting, parallel, io.StringIO())
        if not runner.run():
            raise Interrupted
        if runner.failed:
            raise StudyError(runner.failed[0])
    found = [kept(job) or job.summary() for job in jobs]
    unknown = [name for name in search["score"] if not all(is_number(cell.get(name)) for cell in found)]
    if unknown:
        raise StudyError(f"score: evaluate does not report {', '.join(unknown)}")
    for job, cell in zip(jobs, found):
        if kept(job) is None:
            finished.add(job.words(), {name: cell[name] for name in search["score"]})
    return found


def _fly(search, values, places, parallel):
    """Returns (score, means of the scored metrics over all cells)."""
    work, bin_dir, finished = places
    jobs = _jobs(search, text_of(search["controller"], values), work, bin_dir)
    found = _results(search, jobs, parallel, finished)
    means = {name: sum(cell[name] for cell in found) / len(found) for name in search["score"]}
    return sum(weight * means[name] for name, weight in search["score"].items()), means


def _trials(search, places, parallel):
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
        score, means = _fly(search, values, places, parallel)
        if best is None or score > best[0]:
            best = (score, values)
            print(f"trial {trial}: {score:.4f} {text_of(search['controller'], values)}", flush=True)
        yield trial, score, means, values


def _row(search, trial, score, means, values):
    """A row of the tables. An empty cell means the controller's own constant."""
    return [trial, f"{score:.4f}", *(f"{mean:.6g}" for mean in means.values()),
            *(values.get(name, "") for name in search["space"])]  # fmt: skip


def _write(search, out, name, rows):
    """Writes OUT/NAME, a table of trials."""
    header = ["trial", "score", *search["score"], *search["space"]]
    write_atomically(os.path.join(out, name), csv_text(header, rows))


def _finals(search, trials, out, places, parallel):
    """Flies the best trials and the first one again. Writes OUT/finals.csv, the best one first."""
    again = dict(search, episodes=search["finals"]["episodes"], seed=search["finals"]["seed"])
    order = sorted(trials, key=lambda one: -one[1])[: search["finals"]["trials"]]
    if trials[0] not in order:
        order.append(trials[0])
    flown = []
    for trial, _, _, values in order:
        score, means = _fly(again, values, places, parallel)
        flown.append((trial, score, means, values))
        ranked = sorted(flown, key=lambda one: -one[1])
        _write(search, out, "finals.csv", [_row(search, *one) for one in ranked])
    best = max(flown, key=lambda one: one[1])
    print(f"chosen: trial {best[0]}: {best[1]:.4f} {text_of(search['controller'], best[3])}", flush=True)
    return len(flown) * again["episodes"]


def run_search(search, out, work, bin_dir, parallel):
    """Flies the search. Writes OUT/trials.csv, with one row per trial in the order of the flights, and
    OUT/finals.csv."""
    places = (work, bin_dir, Finished(out))
    trials = []
    for one in _trials(search, places, parallel):
        trials.append(one)
        _write(search, out, "trials.csv", [_row(search, *each) for each in trials])
    cells = len(search["scenarios"]) * len(search["conditions"])
    episodes = search["trials"] * search["episodes"]
    if search["finals"]:
        episodes += _finals(search, trials, out, places, parallel)
    print(f"{search['trials']} trials, {episodes * cells} episodes")
