#!/usr/bin/python3
"""Compares installed programs with those of a source build: results bit for bit, processor time in pairs.

    compare_programs.py devel/lib /usr/lib --policy src/stg_bringup/policies/medium.onnx --pairs 6

The programs take turns, so that other work of the machine slows both alike. Exit
status 1: a result differs.
"""

import argparse
import hashlib
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile


def jobs(policy):
    """Returns {name: (program, arguments)}. FOLDER in the arguments stands for a new output folder."""
    evaluate = ["--policy", policy, "--episodes", "1000", "--seed", "3000"]
    field = ["--policy", "encircle", "--scenario", "field", "--episodes", "40", "--seed", "3000", "--workers", "1"]
    train = ["--scenario", "medium_separated", "--steps", "300000", "--workers", "1", "--seed", "1", "--out", "FOLDER"]
    return {
        "evaluate medium": ("marl_trainer/evaluate", [*evaluate, "--scenario", "medium", "--workers", "1"]),
        "evaluate hard": ("marl_trainer/evaluate", [*evaluate, "--scenario", "hard", "--workers", "1"]),
        "evaluate field": ("marl_trainer/evaluate", field),
        "train": ("marl_trainer/train", train),
    }


def digest(output, folder):
    """Returns a digest of the results that must be equal: the last line, and the policies that were
    written."""
    found = hashlib.sha256(output.strip().split(b"\n")[-1] if not any(folder.iterdir()) else b"")
    for file in sorted(folder.rglob("*.onnx")):
        found.update(file.name.encode() + file.read_bytes())
    return found.hexdigest()[:16]


def fly(program, arguments):
    """Runs a program; returns its processor time [s] and the digest of its results."""
    with tempfile.TemporaryDirectory() as folder:
        words = [folder if word == "FOLDER" else word for word in arguments]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            raise SystemExit(f"compare_programs: {program}: {done.stderr.decode()[-400:]}")
        return after.ru_utime - before.ru_utime, digest(done.stdout, pathlib.Path(folder))


def main(argv):
    """Compares the programs and prints a line for each job."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("built", type=pathlib.Path, help="folder of PACKAGE/PROGRAM of the source build")
    parser.add_argument("installed", type=pathlib.Path, help="the same folder of the packages")
    parser.add_argument("--policy", required=True, help="policy file for both")
    parser.add_argument("--pairs", type=int, default=6)
    parser.add_argument("--jobs", default="", help="names with commas between them (default: all)")
    options = parser.parse_args(argv)
    differs = False
    for name, (program, arguments) in jobs(options.policy).items():
        if options.jobs and name not in options.jobs.split(","):
            continue
        ratios, results = [], set()
        for pair in range(options.pairs):
            times = {}
            for place in (options.built, options.installed)[:: 1 if pair % 2 == 0 else -1]:
                times[place], result = fly(place / program, arguments)
                results.add(result)
            ratios.append(times[options.installed] / times[options.built])
        differs = differs or len(results) > 1
        same = "the same results" if len(results) == 1 else "DIFFERENT RESULTS"
        print(
            f"{name}: {same}; processor time installed / built {statistics.median(ratios):.4f} "
            f"({min(ratios):.3f} to {max(ratios):.3f}, {options.pairs} pairs, {times[options.built]:.1f} s each)",
            flush=True,
        )
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
