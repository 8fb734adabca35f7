"""A random search of every algorithm's options with equal trials. Validation returns decide the choice."""

import dataclasses
import math
import os
import random
import reprlib
from typing import Dict, List

import yaml

from stg_common.files import Damaged
from stg_common.yaml_files import read_yaml
from stg_study.files import write_atomically
from stg_study.finished import Finished
from stg_study.jobs import Training
from stg_study.collect import csv_text
from stg_study.statistics import final_stage, mean_std
from stg_study.study import Method, ScenarioEntry, Study, StudyError, build, is_name, is_option
from stg_study.study import shipped_studies

LOG_DIGITS = 2  # significant digits of a value from an interval, if this keeps it in the interval


@dataclasses.dataclass
class Search:
    """The content of a search. `algorithms` has the options of each algorithm and their sources: a list of
    values, or {"log": [least, most]}."""

    scenario: str
    algorithms: dict
    preset: str = "fast"
    steps: int = 256000  # environment steps of a trial
    trials: int = 10  # of each algorithm; the first one is the unchanged preset
    training_seeds: List[int] = dataclasses.field(default_factory=lambda: [1000, 1001, 1002])
    draw_seed: int = 1
    train: Dict[str, object] = dataclasses.field(default_factory=dict)  # options of every trial
    fixed: dict = dataclasses.field(default_factory=dict)  # options of all trials of an algorithm
    spaces: dict = dataclasses.field(default_factory=dict)  # anchors for `algorithms`; not read


def find_search(name_or_path):
    """Path of a search, given as a file or by the name of a shipped search."""
    if os.path.exists(name_or_path) and not os.path.isdir(name_or_path):
        return name_or_path
    folder = os.path.join(shipped_studies(), "search")
    path = os.path.join(folder, name_or_path + ".yaml")
    if os.path.isfile(path):
        return path
    names = sorted(f[:-5] for f in os.listdir(folder) if f.endswith(".yaml"))
    raise StudyError(f"--search: no file or search '{name_or_path}'; there are " + ", ".join(names))


def load_search(path):
    """Reads a search from a YAML file. Raises StudyError if it is invalid."""
    search = build(Search, path, read_yaml(path))
    seeds = search.training_seeds
    if search.trials < 1 or search.steps < 1:
        raise StudyError(f"{path}: trials and steps must be positive")
    if not seeds or min(seeds) < 0 or len(set(seeds)) != len(seeds):
        raise StudyError(f"{path}: training_seeds: must be at least one seed, not negative and not repeated")
    for key, table in (("algorithms", search.algorithms), ("fixed", search.fixed)):
        for algorithm, options in table.items():
            where = f"{path}: {key}.{algorithm}"
            if not isinstance(algorithm, str) or not is_name(algorithm):
                raise StudyError(f"{where}: must consist of letters, digits, '_' and '-'")
            if not isinstance(options, dict):
                raise StudyError(f"{where}: must be a mapping")
            if algorithm not in search.algorithms:
                raise StudyError(f"{where}: has no effect, because algorithms does not have {algorithm}")
            for option, value in options.items():
                if not isinstance(option, str):
                    raise StudyError(f"{where}.{option}: is not a name of an option")
                if key == "algorithms":
                    _check_source(f"{where}.{option}", value)
                elif not is_option(option, value):
                    raise StudyError(f"{where}.{option}: is not a value of an option")
    return search


def _check_source(where, source):
    """Refuses a source from which nothing can be drawn."""
    if isinstance(source, list) and source and all(is_option("", value) for value in source):
        return
    ends = source.get("log") if isinstance(source, dict) and len(source) == 1 else None
    good = isinstance(ends, list) and len(ends) == 2
    good = good and all(isinstance(end, (int, float)) for end in ends)
    if not (good and 0.0 < ends[0] < ends[1] < math.inf):
        shown = reprlib.repr(source)
        raise StudyError(f"{where}: {shown} is neither a list of values nor {{log: [low, high]}}")


def draw(source, generator):
    """One value from a list, or from an interval, uniform in the logarithm. It has LOG_DIGITS significant
    digits unless this moves it out of the interval."""
    if isinstance(source, list):
        return generator.choice(source)
    low, high = source["log"]
    value = math.exp(generator.uniform(math.log(low), math.log(high)))
    rounded = float(f"{value:.{LOG_DIGITS}g}")
    return rounded if low <= rounded <= high else min(max(value, low), high)


def trials_of(search, algorithm):
    """The options of every trial of an algorithm. Draws are paired: algorithms that draw an option from the
    same source get the same value in the same trial. So with equal epochs and minibatches, they make the same
    number of gradient steps per update."""
    space = search.algorithms[algorithm]
    drawn = [
        {
            option: draw(source, random.Random(f"{search.draw_seed} {trial} {option}"))
            for option, source in space.items()
        }
        for trial in range(1, search.trials)
    ]
    return [{}] + drawn


class SearchedTraining(Training):
    """A training of a search. Its results are kept, so it is done even where its folder is missing."""

    def __init__(self, finished, *arguments):
        super().__init__(*arguments)
        self._finished = finished

    def _kept(self):
        return None if os.path.isdir(self.folder) else self._finished.find(self.arguments)

    def complete(self):
        """True if the run reached its last step here, or if its results are kept."""
        return self._kept() is not None or super().complete()

    def score(self):
        """(return, lost rate, wall seconds) of the finished training. Keeps them."""
        kept = self._kept()
        if kept is None:
            rows = self.validations()
            if not rows:
                raise Damaged(self.progress_file, "contains no validation")
            rows = final_stage(rows)
            kept = {
                "return": sum(row["validation_return"] for row in rows) / len(rows),
                "lost_rate": sum(row["validation_lost_rate"] for row in rows) / len(rows),
                "wall_seconds": rows[-1]["wall_seconds"],
            }
            if kept != self._finished.find(self.arguments):
                self._finished.add(self.arguments, kept)
        return kept["return"], kept["lost_rate"], kept["wall_seconds"]


def plan_search(search, algorithms, out, work, bin_dir):
    """Returns {algorithm: [[SearchedTraining]]}: for each trial, one training per seed."""
    finished = Finished(out)
    study = Study(
        name="search",
        title="",
        scenarios=[ScenarioEntry(search.scenario)],
        conditions=["nominal"],
        methods=[],
        controllers=[],
        preset=search.preset,
        steps=search.steps,
        train=search.train,
    )
    fixed = search.fixed
    return {
        algorithm: [
            [
                SearchedTraining(
                    finished,
                    study,
                    study.scenarios[0],
                    Method(f"{algorithm}_{k}", "", train={"algorithm": algorithm, **fixed.get(algorithm, {}), **options}),
                    seed,
                    work,
                    bin_dir,
                )
                for seed in search.training_seeds
            ]
            for k, options in enumerate(trials_of(search, algorithm))
        ]
        for algorithm in algorithms
    }


@dataclasses.dataclass
class Score:
    """The results by which a trial is judged: means over its seeds and the last fifth of their
    validations."""

    value: float  # return, summed over the AUVs
    std: float  # of the return, over seeds; 0 for one seed
    lost_rate: float
    wall_seconds: float  # of one training


def score_of(trainings):
    """Score of a trial, or None if a training is not finished. Keeps the results of those that are."""
    done = [training.score() for training in trainings if training.complete()]
    if len(done) < len(trainings):
        return None
    returns, lost, seconds = zip(*done)
    value, std = mean_std(returns)
    return Score(value, std or 0.0, sum(lost) / len(lost), sum(seconds) / len(seconds))


def choose_best(scores):
    """Index of the best trial: highest return, the earlier one if equal; None if there is none."""
    known = [k for k, score in enumerate(scores) if score is not None]
    return max(known, key=lambda k: (scores[k].value, -k)) if known else None


def write_search(search, trainings, out):
    """Writes trials.csv, chosen.yaml and report.md into `out`. Returns the number of missing trials."""
    rows, chosen, missing = [], {}, 0
    page = [
        "# The search before the study of equal terms\n",
        f"Every algorithm has {search.trials} trials of {search.steps:,} environment steps on "
        f"`{search.scenario}`. Each trial is trained with the seeds "
        f"{', '.join(map(str, search.training_seeds))}. The options of a trial are random values "
        "from [the search](search.yaml); the same trial of every algorithm has the same values. "
        "Trial 0 is the unchanged preset. The score is the return in the validations of a training, "
        "in held-out episodes of the choosing block: mean over the last fifth of the validations, "
        "mean ± std over seeds. The evaluations of the study were not used.\n",
        "| Algorithm | Trial | Options | Score | Lost | Wall s |",
        "|---|---:|---|---:|---:|---:|",
    ]
    for algorithm, jobs in trainings.items():
        scores = [score_of(job) for job in jobs]
        best = choose_best(scores)
        missing += scores.count(None)
        for k, (options, score) in enumerate(zip(trials_of(search, algorithm), scores)):
            text = " ".join(f"--{name} {value}" for name, value in options.items())
            # The table has the digits that the choice used; the page rounds.
            figures, cells = [""] * 4, [""] * 3
            if score is not None:
                figures = [f"{value:.9g}" for value in dataclasses.astuple(score)]
                cells = [f"{score.value:.1f} ± {score.std:.1f}", f"{score.lost_rate:.4f}"]
                cells.append(f"{score.wall_seconds:.1f}")
            rows.append((algorithm, k, text, *figures, int(k == best)))
            mark = "**" if k == best else ""
            cells = [f"{mark}{cell or '–'}{mark}" for cell in cells]
            page.append(f"| {algorithm} | {k} | {text or 'preset'} | " + " | ".join(cells) + " |")
        if best is not None:
            chosen[algorithm] = trials_of(search, algorithm)[best]
    os.makedirs(out, exist_ok=True)
    header = ["algorithm", "trial", "options", "return", "return_std", "lost_rate"]
    header += ["wall_seconds", "chosen"]
    write_atomically(os.path.join(out, "trials.csv"), csv_text(header, rows))
    text = "# The options of the best trial of each algorithm. No options: the unchanged preset.\n"
    text += yaml.safe_dump(chosen, sort_keys=False)
    write_atomically(os.path.join(out, "chosen.yaml"), text)
    text = yaml.safe_dump(dataclasses.asdict(search), sort_keys=False, width=96)
    write_atomically(os.path.join(out, "search.yaml"), text)
    write_atomically(os.path.join(out, "report.md"), "\n".join(page) + "\n")
    return missing
