"""Collects the results of a study's jobs in the CSV files from which the report is made."""

import csv
import gzip
import io
import os
import re

from stg_common.csv_files import number, table_rows
from stg_common.files import Damaged, expect, member, read_json
from stg_study.files import write_atomically

FILES = {
    "results": "results.csv",  # scenario, condition, method, seed, metric: mean and std
    "episodes": "episodes.csv.gz",  # every evaluation episode, all metrics
    "curves": "curves.csv",  # every validation of every training, all metrics
    "runs": "runs.csv",  # every training: steps, times, speed, networks
    "options": "options.csv",  # options of train for every method, from its first training
}
THRESHOLDS = ("no_loss", "1000", "1020", "1030", "1040")


def csv_text(header, rows):
    """A header and rows of values as the text of a CSV file."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(header)
    table.writerows([str(value) for value in row] for row in rows)
    return text.getvalue()


def _short(value, digits=6):
    """A number with the digits that the tables need, because results are stored in repositories."""
    return f"{float(value):.{digits}g}"


def read_rows(path):
    """The rows of a CSV file, which may be compressed (.gz), as dictionaries of texts."""
    return list(table_rows(path))


def write_rows(path, header, rows):
    """Writes a file for read_rows. The same rows always make the same file."""
    data = csv_text(header, rows).encode()
    write_atomically(path, gzip.compress(data, mtime=0) if path.endswith(".gz") else data)


def _run_cells(job):
    """Cells of runs.csv for a complete training: steps, times, speed, networks."""
    path, summary = job.summary_file, job.summary()
    speed = [_short(member(path, summary, n, float)) for n in ("wall_seconds", "env_steps_per_second")]
    times = expect(path, summary.get("time_to_threshold", {}), dict, "time_to_threshold")
    reached = []
    for name in THRESHOLDS:
        moment = expect(path, times.get(name) or {}, dict, f"time_to_threshold.{name}")
        reached.append(_short(member(path, moment, "seconds", float)) if moment else "")
    # Older runs do not have the sizes.
    sizes = expect(path, summary.get("parameters", {}), dict, "parameters")
    if any(not re.fullmatch(r"\w+", name) or type(size) is not int for name, size in sizes.items()):
        raise Damaged(path, "parameters: must be a whole number for each network")
    networks = " ".join(f"{name}:{size}" for name, size in sizes.items())
    flops = summary.get("update_flops_per_env_step")
    flops = "" if flops is None else _short(expect(path, flops, float, "update_flops_per_env_step"))
    return [summary["env_steps"], *speed, *reached, networks, flops]


def _options_of(job):
    """{option: value} of a complete training; a list is split into its elements."""
    path = os.path.join(job.folder, "config.json")
    options = expect(path, read_json(path), dict)
    texts = {}
    for name, value in options.items():
        parts = value if isinstance(value, list) else [value]
        if any(isinstance(part, (dict, list)) for part in parts):
            raise Damaged(path, f"{name}: must be a value or a list of values")
        texts[name] = expect(path, ";".join(map(str, parts)), str, expect(path, name, str))
    return texts


class Kept:
    """The rows of some methods and controllers in the CSV files of a folder."""

    def __init__(self, folder, names):
        self._folder, self._names = folder, set(names)

    def rows(self, kind, header):
        """Rows with the columns of `header`; cells are empty if an older file does not have them."""
        path = os.path.join(self._folder, FILES[kind])
        if not self._names or not os.path.exists(path):
            return []
        found = [row for row in read_rows(path) if row.get("method") in self._names]
        return [[row.get(name, "") for name in header] for row in found]


def collect(study, trainings, evaluations, out, kept=()):
    """Writes the CSV files into `out` from the complete jobs. Rows of the methods and controllers in `kept`
    are taken from the existing files. Returns the number of jobs that are not complete."""
    kept = Kept(out, kept)
    places = {name: place for place, name in enumerate(study.method_names())}
    results, episodes, curves, runs, options = [], [], [], [], {}
    metrics, curve_metrics = [], []
    missing = 0
    for job in evaluations:
        if not job.complete():
            missing += 1
            continue
        key = (job.scenario, job.condition, job.method, job.seed)
        needed = {"episode": str, **dict.fromkeys(metrics, number)}
        rows = list(table_rows(job.csv, needed, lambda name: number))
        metrics = metrics or [name for name in rows[0] if name not in ("episode", "seed")]
        for row in rows:
            episodes.append((*key, row["episode"], *(_short(row[name], 5) for name in metrics)))
        summary = job.summary()
        for name in metrics:
            of_job = (member(job.json, summary, n, float) for n in (name, name + "_std"))
            results.append((*key, job.episodes, name, *map(_short, of_job)))
    for job in trainings:
        if not job.complete():
            missing += 1
            continue
        key = (job.scenario, job.method, job.seed)
        for row in job.validations(curve_metrics):
            curve_metrics = curve_metrics or [n for n in row if n.startswith("validation_")]
            values = (_short(row[name]) for name in curve_metrics)
            curves.append((*key, row["env_steps"], _short(row["wall_seconds"]), *values))
        runs.append((*key, study.preset, *_run_cells(job)))
        if job.method not in options:
            options[job.method] = _options_of(job)

    os.makedirs(out, exist_ok=True)

    def write(name, header, rows):
        before = kept.rows(name, header)
        if before:
            method = header.index("method")
            rows = sorted([*before, *rows], key=lambda row: places[row[method]])
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
    rows = [(method, *item) for method, texts in options.items() for item in texts.items()]
    write("options", ["method", "option", "value"], rows)
    return missing
