"""Gathers what the jobs of a study left into the CSV files that the report is made of."""

import csv
import gzip
import os

from stg_study.files import write_atomically
from stg_study.jobs import read_json

FILES = {
    "results": "results.csv",  # scenario, condition, method, seed, metric: mean and std
    "episodes": "episodes.csv.gz",  # every evaluation episode, all metrics
    "curves": "curves.csv",  # every validation of every training, all metrics
    "runs": "runs.csv",  # every training: steps, times, speed, networks
    "options": "options.csv",  # every method's options of train, as its first training had them
}
THRESHOLDS = ("no_loss", "1000", "1020", "1030", "1040")


def csv_text(header, rows):
    """A header and rows of values as the text of a CSV file."""
    lines = [",".join(header)]
    lines += [",".join(str(value) for value in row) for row in rows]
    return "\n".join(lines) + "\n"


def _short(value, digits=6):
    """A number with as many digits as the tables can use: results stand in repositories."""
    return f"{float(value):.{digits}g}"


def read_rows(path):
    """The rows of a CSV file, which may be compressed (.gz), as dictionaries."""
    open_file = gzip.open if path.endswith(".gz") else open
    with open_file(path, "rt", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write_rows(path, header, rows):
    """Writes what read_rows reads; the same rows make the same file."""
    data = csv_text(header, rows).encode()
    write_atomically(path, gzip.compress(data, mtime=0) if path.endswith(".gz") else data)


def collect(study, trainings, evaluations, out):
    """Writes the CSV files into `out` from the complete jobs; returns how many are not."""
    results, episodes, curves, runs, options = [], [], [], [], {}
    metrics, curve_metrics = [], []
    missing = 0
    for job in evaluations:
        if not job.complete():
            missing += 1
            continue
        key = (job.scenario, job.condition, job.method, job.seed)
        rows = read_rows(job.csv)
        metrics = metrics or [name for name in rows[0] if name not in ("episode", "seed")]
        for row in rows:
            episodes.append((*key, row["episode"], *(_short(row[name], 5) for name in metrics)))
        summary = read_json(job.json)["summary"]
        for name in metrics:
            mean, std = _short(summary[name]), _short(summary[name + "_std"])
            results.append((*key, job.episodes, name, mean, std))
    for job in trainings:
        if not job.complete():
            missing += 1
            continue
        key = (job.scenario, job.method, job.seed)
        for row in read_rows(os.path.join(job.folder, "progress.csv")):
            names = [n for n in row if n and n.startswith("validation_")]
            names.remove("validation_seconds")
            curve_metrics = curve_metrics or names
            if row[curve_metrics[0]]:
                values = (_short(row[name]) for name in curve_metrics)
                curves.append((*key, row["env_steps"], _short(row["wall_seconds"]), *values))
        summary = read_json(os.path.join(job.folder, "summary.json"))
        times = summary.get("time_to_threshold", {})
        reached = [_short(times[t]["seconds"]) if times.get(t) else "" for t in THRESHOLDS]
        speed = [_short(summary[name]) for name in ("wall_seconds", "env_steps_per_second")]
        # Older runs do not tell the sizes.
        networks = " ".join(f"{n}:{count}" for n, count in summary.get("parameters", {}).items())
        flops = summary.get("update_flops_per_env_step")
        sizes = [networks, "" if flops is None else _short(flops)]
        runs.append((*key, study.preset, summary["env_steps"], *speed, *reached, *sizes))
        options.setdefault(job.method, read_json(os.path.join(job.folder, "config.json")))

    os.makedirs(out, exist_ok=True)

    def write(name, header, rows):
        write_rows(os.path.join(out, FILES[name]), header, rows)

    key = ["scenario", "condition", "method", "seed"]
    write("results", key + ["episodes", "metric", "mean", "std"], results)
    write("episodes", key + ["episode"] + metrics, episodes)
    names = [name[len("validation_") :] for name in curve_metrics]
    run_key = ["scenario", "method", "seed"]
    write("curves", run_key + ["env_steps", "wall_seconds"] + names, curves)
    seconds = [f"seconds_to_{name}" for name in THRESHOLDS]
    header = ["preset", "env_steps", "wall_seconds", "env_steps_per_second"] + seconds
    sizes = ["parameters", "update_flop_per_env_step"]
    write("runs", run_key + header + sizes, runs)
    rows = [
        (method, name, ";".join(map(str, value)) if isinstance(value, list) else value)
        for method, config in options.items()
        for name, value in config.items()
    ]
    write("options", ["method", "option", "value"], rows)
    return missing
