"""Reads the results of a study and the paper's figures from their CSV files."""

import os
import re

import numpy as np

from stg_common.csv_files import count, number, optional, table_rows
from stg_common.files import Damaged
from stg_study.collect import FILES, THRESHOLDS
from stg_study.statistics import final_stage, mean_std

PAPER_FILE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "paper_tables.csv")

NETWORKS = re.compile(r"(\w+:\d{1,12}( \w+:\d{1,12})*)?")


def networks(text):
    """Networks and the numbers of their parameters in the form of runs.csv: "actor:12 critic:34"."""
    if not NETWORKS.fullmatch(text):
        raise ValueError
    return text


RUN = {
    "scenario": str, "method": str, "seed": str, "env_steps": count, "wall_seconds": number,
    "env_steps_per_second": number, "parameters": networks,
    "update_flop_per_env_step": optional(number),
    **{f"seconds_to_{name}": optional(number) for name in THRESHOLDS},
}  # fmt: skip
OPTION = {"method": str, "option": str, "value": str}
# Returns by another reward than `return`; older rows have none.
OTHER_RETURNS = ("training_return", "scenario_return")
CURVE = {"scenario": str, "method": str, "seed": count}  # and numbers
EPISODE = {**CURVE, "condition": str}  # and numbers



def _kind(name):
    """Kind of a column of episodes or curves: a number, which may be missing for returns."""
    return optional(number) if name == "return" or name in OTHER_RETURNS else number


class Paper:
    """The paper's Tables 1, 2 and S3-S9: (mean, std) of a table's row and metric."""

    def __init__(self, path=PAPER_FILE):
        self._values = {}
        self._algorithms = {}
        for row in table_rows(path, {"mean": number, "std": optional(number)}):
            key = (row["table"], row["algorithm"], row["condition"], row["seed"], row["metric"])
            if key in self._values:
                raise Damaged(path, f"{key} is given twice")
            self._values[key] = (row["mean"], row["std"])
            names = self._algorithms.setdefault(row["table"], [])
            if row["algorithm"] not in names:
                names.append(row["algorithm"])

    def get(self, table, algorithm, metric, condition="nominal", seed=""):
        """(mean, std) or None. std is None if the paper gives none."""
        return self._values.get((table, algorithm, condition, str(seed), metric))

    def algorithms(self, table):
        """Algorithms of a table in the paper's order."""
        return self._algorithms.get(table, [])

    def seeds(self, table, algorithm):
        """Seeds of a per-seed table."""
        return sorted({k[3] for k in self._values if k[0] == table and k[1] == algorithm})


class Results:
    """All data of the report, from the CSV files of one study."""

    def __init__(self, folder):
        self._scores = {}  # (scenario, condition, method, seed) -> {metric: values by episode}
        self._curves = {}  # (scenario, method, seed) -> {column: values by validation}
        self._path = {kind: os.path.join(folder, name) for kind, name in FILES.items()}
        self.runs = list(table_rows(self._path["runs"], RUN))
        self._options = {}  # method -> {option: value as text}
        for row in table_rows(self._path["options"], OPTION):
            self._options.setdefault(row["method"], {})[row["option"]] = row["value"]
        for row in table_rows(self._path["episodes"], EPISODE, _kind):
            key = tuple(row.pop(name) for name in ("scenario", "condition", "method", "seed"))
            self._append(self._scores, key, row)
        for row in table_rows(self._path["curves"], CURVE, _kind):
            key = tuple(row.pop(name) for name in ("scenario", "method", "seed"))
            self._append(self._curves, key, row)

    @staticmethod
    def _append(table, key, row):
        columns = table.setdefault(key, {name: [] for name in row})
        for name, value in row.items():
            columns[name].append(value)

    def _column(self, kind, columns, name):
        if name not in columns:
            raise Damaged(self._path[kind], f"no column {name}", 1)
        return columns[name]

    def scores(self, scenario, condition, method, metric):
        """[seeds, episodes] of an evaluation, or None if there is none."""
        rows = [
            self._column("episodes", columns, metric)
            for key, columns in sorted(self._scores.items())
            if key[:3] == (scenario, condition, method)
            and (metric in columns or metric not in OTHER_RETURNS)
        ]
        if not rows or any(value is None for row in rows for value in row):
            return None
        episodes = min(len(row) for row in rows)
        return np.array([row[:episodes] for row in rows])

    def evaluated_seeds(self, scenario, condition, method):
        """The seeds for the rows of scores()."""
        return sorted(key[3] for key in self._scores if key[:3] == (scenario, condition, method))

    def option(self, method, name):
        """An option of a method's training as text; empty if the method does not have it."""
        return self._options.get(method, {}).get(name, "")

    def runs_of(self, scenario, method):
        """Rows of the finished trainings of a method."""
        return [r for r in self.runs if r["scenario"] == scenario and r["method"] == method]

    def over_episodes(self, scenario, condition, method, metric):
        """(mean, std) over all episodes of all seeds, as in Tables S7 and S8; or None."""
        scores = self.scores(scenario, condition, method, metric)
        return None if scores is None else mean_std(scores.ravel())

    def over_seeds(self, scenario, condition, method, metric):
        """(mean, std) of the seeds' means, like the distances in Tables 1 and 2; or None."""
        scores = self.scores(scenario, condition, method, metric)
        return None if scores is None else mean_std(scores.mean(axis=1))

    def seeds(self, scenario, method):
        """Seeds with a training curve."""
        return sorted(key[2] for key in self._curves if key[:2] == (scenario, method))

    def all_seeds(self, scenario):
        """Seeds with a training curve of any method."""
        return sorted({key[2] for key in self._curves if key[0] == scenario})

    def curve(self, scenario, method, seed, column):
        """Values of a validation column, one per validation; None if they are unknown."""
        columns = self._curves[(scenario, method, seed)]
        if column in OTHER_RETURNS and column not in columns:
            return None
        values = self._column("curves", columns, column)
        return None if any(value is None for value in values) else values

    def final_points(self, scenario, method, seed, column):
        """The last fifth of the validations, or None."""
        values = self.curve(scenario, method, seed, column)
        return None if values is None else final_stage(values)

    def final_over_seeds(self, scenario, method, column):
        """(mean, std) over seeds of the final-stage means, as in Tables S3, S5 and S9; or None."""
        seeds = self.seeds(scenario, method)
        if not seeds:
            return None
        points = [self.final_points(scenario, method, s, column) for s in seeds]
        return None if any(p is None for p in points) else mean_std([np.mean(p) for p in points])
