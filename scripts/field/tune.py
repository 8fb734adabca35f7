#!/usr/bin/python3
"""Searches for the constants of a classical controller on the field, as its policies are trained:
on validation seeds, with a budget of environment steps.

Usage: tune.py CONTROLLER OUT [--trials N] [--episodes N] [--evaluate FILE] [--scenario NAME], in a
built and sourced workspace. OUT keeps every trial as a line of JSON; started again, it goes on. The
best trials and the budget are printed.

Search: random within SPACE (uniform; where a range spans a decade or more, of the logarithm), the
first trial being the shipped constants, the second half of the trials near the best so far. Seeds
5000 and up, of the block for choosing; tables are made with those for reporting.
"""

import argparse
import math
import random
import sys

import flights

SPACE = {
    "encircle": {
        "slow": (0.8, 1.4), "fast": (1.6, 2.3), "inward": (1.0, 8.0), "lead": (0.0, 10.0),
        "spread": (0.05, 2.0), "spread-limit": (0.05, 0.5), "clearance": (25.0, 90.0),
        "horizon": (15.0, 90.0), "layer": (8.0, 40.0),
    },
    "pursuit_separated": {
        "gain": (0.005, 0.5), "standoff": (60.0, 120.0), "cap": (0.3, 1.0),
        "repulsion": (0.01, 1.0), "repulsion-range": (20.0, 120.0), "feedforward": (0.0, 1.5),
    },
    "pursuit": {
        "gain": (0.005, 0.5), "standoff": (60.0, 120.0), "cap": (0.3, 1.0),
        "feedforward": (0.0, 1.5),
    },
}
CONDITIONS = ("nominal", "fast_target", "degraded_communication", "strong_current")
SEED = 5000


def score(found):
    """What is searched for: time in the band, evenly spread, and nobody near or aground."""
    return (
        found["band_share"] + 0.25 * found["spread"] - 5.0 * found["near_pairs"]
        - 50.0 * found["colliding_pairs"] - 0.1 * (found["groundings"] + found["collisions"])
    )


def draw(space, best, rng):
    """Returns constants, anywhere or, with a best, a tenth of the range around it."""
    values = {}
    for name, (lo, hi) in space.items():
        logarithmic = lo > 0.0 and hi / lo >= 10.0
        a, b = (math.log(lo), math.log(hi)) if logarithmic else (lo, hi)
        if best is None or name not in best:
            x = rng.uniform(a, b)
        else:
            centre = math.log(best[name]) if logarithmic else best[name]
            x = min(b, max(a, rng.gauss(centre, 0.1 * (b - a))))
        values[name] = float(f"{math.exp(x) if logarithmic else x:.4g}")
    return values


def text_of(controller, values):
    """Returns how `evaluate --policy` takes them."""
    constants = ",".join(f"{name}={value:g}" for name, value in values.items())
    return controller + (":" + constants if constants else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("controller", choices=sorted(SPACE))
    parser.add_argument("out")
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--episodes", type=int, default=16, help="of each trial and condition")
    parser.add_argument("--scenario", default="field")
    parser.add_argument("--evaluate", default="evaluate", help="program, where not rosrun's")
    arguments = parser.parse_args()
    known = flights.Flights(arguments.out, arguments.evaluate)
    rng = random.Random(1)
    trials, steps = [], 0
    for trial in range(arguments.trials):
        near = trial > arguments.trials // 2
        values = draw(SPACE[arguments.controller], trials[0][1] if near else None, rng)
        if trial == 0:
            values = {}
        found = [
            known.fly(text_of(arguments.controller, values), arguments.scenario, condition,
                      arguments.episodes, SEED)
            for condition in CONDITIONS
        ]
        trials.append((sum(score(f) for f in found) / len(found), values))
        trials.sort(key=lambda each: -each[0])
        steps += 3000 * arguments.episodes * len(CONDITIONS)
        print(f"trial {trial}: best {trials[0][0]:.4f}", file=sys.stderr)
    print(f"{arguments.trials} trials, {steps / 1e6:.1f} million environment steps")
    for value, values in trials[:5]:
        print(f"{value:.4f} {text_of(arguments.controller, values)}")


if __name__ == "__main__":
    main()
