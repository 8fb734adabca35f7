#!/usr/bin/python3
"""Measures a built and sourced workspace: environment, trainer and ROS graph (scripts/bench/bench_ros.sh).

Prints a report and writes everything as JSON.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time

from stg_common.program import run_program
from stg_common.stated import stated

HERE = os.path.dirname(os.path.realpath(__file__))
THRESHOLDS = ("no_loss", "1000", "1020", "1030", "1040")
ALGORITHMS = "ippo,happo,maddpg,matd3,masac,madqn"  # in addition to MAPPO, the default
# Options that an algorithm needs in addition to the preset, to reach the goal (docs/algorithms).
BESIDE = {"madqn": ["--reward", "own", "--gamma", "0.8"]}
# Each part, and the options that it reads.
TRAINS = {"seeds", "workers", "steps", "bin"}
PARTS = {
    "environment": {"seconds", "bin"},
    "training": TRAINS,
    "algorithms": TRAINS | {"algorithms"},
    "ros": set(),
}
GOAL = ("1030", 60.0)  # return and seconds that every seed should reach


class BenchError(Exception):
    """A benchmark that cannot be run."""


def positive(text):
    """A positive number, e.g. a duration."""
    value = float(text)
    if not 0.0 < value < 1e9:
        raise argparse.ArgumentTypeError("must be positive")
    return value


def count(text):
    """An argument that is a positive whole number."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(prog="./stg bench", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--seconds", type=positive, default=3.0, help="duration of each environment benchmark (%(default)s)"
    )
    parser.add_argument(
        "--seeds", default="0,1,2,3,4", help="seeds of the trainings (%(default)s); '' for none"
    )
    parser.add_argument(
        "--algorithms",
        default=ALGORITHMS,
        help="trained once each, with the first seed (%(default)s; mappo is trained with all "
        "seeds); '' for none",
    )
    parser.add_argument(
        "--workers", type=count, default=os.cpu_count() or 1, help="threads of train (%(default)s)"
    )
    parser.add_argument("--steps", type=count, help="environment steps of a training (the preset's)")
    parser.add_argument("--out", default="results/bench.json", help="JSON file (%(default)s)")
    parser.add_argument("--only", choices=PARTS, help="one part, e.g. algorithms")
    parser.add_argument("--no-ros", action="store_true", help="leave the ROS graph out")
    parser.add_argument("--bin", help="folder of the programs (default: the workspace's)")
    options = parser.parse_args(argv)
    try:
        options.seeds = [int(text) for text in options.seeds.split(",") if text]
    except ValueError:
        parser.error("--seeds: a list of numbers such as 0,1,2")
    options.parts = [options.only] if options.only else list(PARTS)
    if options.no_ros and "ros" in options.parts:
        options.parts.remove("ros")
    if not options.parts:
        parser.error("--only ros and --no-ros leave nothing to do")
    check_effect(parser, options, stated(parser, argv))
    return options


def check_effect(parser, options, given):
    """Refuses options that no chosen part reads. given: the names of the options that the user set."""
    chosen = set().union(*(PARTS[part] for part in options.parts))
    read = {"out", "only"} | chosen | (set() if options.only else {"no_ros"})
    if not options.seeds:  # nothing is trained
        read -= {"workers", "steps", "algorithms"}
    for name in sorted(given - read):
        why = ", because --seeds is empty" if name in chosen else f" with --only {options.only}"
        parser.error(f"--{name.replace('_', '-')} has no effect{why}")


def program(folder, name):
    """Path of a program of marl_trainer."""
    prefixes = os.environ.get("CMAKE_PREFIX_PATH", "").split(":")
    folders = [os.path.join(p, "lib", "marl_trainer") for p in prefixes if p]
    if folder:
        folders = [folder]
    for candidate in folders:
        path = os.path.join(candidate, name)
        if os.access(path, os.X_OK):
            return path
    raise BenchError(f"{name} is not built, or the workspace is not sourced")


def last_json(text, command):
    """The JSON object on the last line of a program's output."""
    try:
        return json.loads(text.strip().splitlines()[-1])
    except (ValueError, IndexError) as error:
        raise BenchError(f"{' '.join(command)}: no JSON object on the last line") from error


def run(command):
    """Runs a command to its end and returns its output."""
    done = subprocess.run(command, stdout=subprocess.PIPE, universal_newlines=True, check=False)
    if done.returncode != 0:
        raise BenchError(f"{' '.join(command)}: exit status {done.returncode}")
    return done.stdout


def heading(text):
    """A section of the report."""
    print(f"\n{text}\n{'-' * len(text)}", flush=True)


def machine():
    """The machine of the measurement, and its load."""
    model = platform.processor() or "unknown"
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    load = os.getloadavg()[0]
    facts = {"cpu": model, "cores": os.cpu_count(), "load_at_start": round(load, 2)}
    heading("Machine")
    print(f"{model}, {facts['cores']} cores, load {load:.2f} at the start")
    if load > 0.5:
        print("note: other programs are running, so the figures below are too low")
    return facts


def bench_environment(options):
    """Environment steps per second in the two modes, and against the number of AUVs."""
    heading("Environment (observations and rewards included)")
    tool = program(options.bin, "bench_env")
    results = {}
    for name, scenario, workers, further in (
        ("release_truth", "medium_release", 1, []),
        ("release_truth_all_cores", "medium_release", os.cpu_count() or 1, []),
        ("acoustic", "medium", 1, []),
        ("acoustic_all_cores", "medium", os.cpu_count() or 1, []),
        ("scaling", "medium_release", 1, ["--scaling"]),
        ("acoustic_scaling", "medium", 1, ["--scaling"]),
    ):
        command = [tool, "--scenario", scenario, "--seconds", str(options.seconds)]
        command += ["--workers", str(workers), *further]
        result = last_json(run(command), command)
        results[name] = result
        if not further:
            print(
                f"{scenario:16} {workers} worker(s): {result['env_steps_per_second']:12,.0f} "
                f"environment steps/s, {result['agent_steps_per_second']:12,.0f} agent steps/s",
                flush=True,
            )
            continue
        print(f"{scenario}, against the number of AUVs (1 worker):")
        for row in result["scaling"]:
            print(
                f"    {row['agents']:4} AUVs: {row['env_steps_per_second']:12,.0f} "
                f"environment steps/s, {row['ns_per_agent_step']:7.0f} ns an agent step",
                flush=True,
            )
    return results


def time_to(summary, name):
    """Seconds until a threshold, or None if it was not reached."""
    moment = summary.get("time_to_threshold", {}).get(name)
    return moment["seconds"] if moment else None


def train(options, folder, algorithm, seed):
    """Summary of one training from scratch; prints its row."""
    out = os.path.join(folder, f"{algorithm or 'seed'}{seed}")
    command = [program(options.bin, "train"), "--scenario", "medium_release", "--preset", "fast"]
    command += ["--seed", str(seed), "--workers", str(options.workers), "--out", out]
    command += ["--algorithm", algorithm, *BESIDE.get(algorithm, [])] if algorithm else []
    command += ["--steps", str(options.steps)] if options.steps else []
    run(command)
    with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    times = [time_to(summary, name) for name in THRESHOLDS]
    cells = "  ".join("       -" if t is None else f"{t:8.1f}" for t in times)
    print(
        f"{algorithm or seed:>6}           {cells}  {summary['wall_seconds']:7.1f} s  "
        f"{summary['env_steps_per_second']:8,.0f}  "
        f"{summary['best_validation'].get('return', float('nan')):11.1f}",
        flush=True,
    )
    return summary


def bench_training(options):
    """Wall time from scratch to each return, one training after the other."""
    heading(f"Training (--preset fast, medium_release, {options.workers} workers)")
    cells = "  ".join(f"{name:>8}" for name in THRESHOLDS)
    print(f"seed  seconds to {cells}  whole run   steps/s  best return", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        results = {seed: train(options, folder, "", seed) for seed in options.seeds}
    if results:
        report_training(list(results.values()))
    return results


def bench_algorithms(options):
    """The same measurement for every other algorithm, with one seed."""
    if not options.algorithms or not options.seeds:
        return {}
    heading(f"Algorithms (--preset fast, medium_release, {options.workers} workers)")
    cells = "  ".join(f"{name:>8}" for name in THRESHOLDS)
    print(f"name  seconds to {cells}  whole run   steps/s  best return", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        results = {
            name: train(options, folder, name, options.seeds[0])
            for name in options.algorithms.split(",")
        }
    for name, summary in results.items():
        if name in BESIDE:
            print(f"{name}: with {' '.join(BESIDE[name])}")
        if time_to(summary, GOAL[0]) is None:
            print(
                f"{name}: never {GOAL[0]} without a loss in {summary['env_steps']:,} steps; best "
                f"return {summary['best_validation'].get('return', float('nan')):.1f}"
            )
    return results


def report_training(summaries):
    """Prints the time of each phase, and if the goal was reached."""
    total = sum(s["wall_seconds"] for s in summaries)
    phases = summaries[0]["phase_seconds"]
    spent = {name: sum(s["phase_seconds"][name] for s in summaries) for name in phases}
    shares = [f"{name} {100 * seconds / total:.0f} %" for name, seconds in spent.items()]
    print("time goes to: " + ", ".join(shares))
    rate = sum(s["update_gflops"] for s in summaries) / len(summaries)
    peak = sum(s["peak_sgemm_gflops"] for s in summaries) / len(summaries)
    share = 100 * rate / peak
    print(f"update: {rate:.1f} of the {peak:.1f} GF/s that sgemm reaches here ({share:.0f} %)")
    times = [time_to(s, GOAL[0]) for s in summaries]
    met = sum(t is not None and t < GOAL[1] for t in times)
    print(f"return {GOAL[0]} without a loss in under {GOAL[1]:.0f} s: {met} of {len(times)} seeds")


def make_room(path):
    """Makes the folder of a file. Refuses a path that cannot be written before anything is measured."""
    folder = os.path.dirname(path) or "."
    os.makedirs(folder, exist_ok=True)
    if os.path.isdir(path) or not os.access(path if os.path.exists(path) else folder, os.W_OK):
        raise BenchError(f"--out: {path} cannot be written")


def bench_ros():
    """Runs the benchmark of the ROS graph. Its last line is a JSON object."""
    heading("ROS graph")
    command = [os.path.join(HERE, "bench_ros.sh")]
    result = last_json(run(command), command)
    for name, figure in result.items():
        print(f"{name.replace('_', ' '):32s} {figure}", flush=True)
    return result


def main(argv):
    """Runs all benchmarks; returns the exit status."""
    options = parse(argv)
    make_room(options.out)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    report = {"date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), "machine": machine()}
    if "environment" in options.parts:
        report["environment"] = bench_environment(options)
    if "training" in options.parts and options.seeds:
        report["training"] = bench_training(options)
    if "algorithms" in options.parts:
        report["algorithms"] = bench_algorithms(options)
    if "ros" in options.parts:
        report["ros"] = bench_ros()
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump(report, file, indent=1)
        file.write("\n")
    print(f"\neverything as JSON: {options.out}")
    return 0


if __name__ == "__main__":
    run_program("bench", lambda: main(sys.argv[1:]), BenchError, status=1)
