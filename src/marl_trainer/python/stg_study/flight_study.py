"""A study of flights: compares controllers and finished policies without a training.

Its file has `kind: flights`. A section is a table of scenarios x conditions x variants. Each of the section's
pilots flies them, with each of its kinds of knowledge. All fly the same episodes.
"""

import dataclasses
import itertools
import os
from typing import List

import yaml

from stg_common.files import FileError
from stg_study.files import write_atomically
from stg_study.jobs import Flight, combined
from stg_study.study import StudyError, build, is_name
from stg_study.trained import check_trainings

SHIPPED_POLICIES = ("../../../stg_bringup/policies", "../../../../share/stg_bringup/policies")


@dataclasses.dataclass
class Knowledge:
    """Information for a pilot's decisions: overrides of the scenario, or true states for a built-in
    controller."""

    set: List[str] = dataclasses.field(default_factory=list)
    privileged: bool = False


@dataclasses.dataclass
class Pilot:
    """A pilot: a controller with its constants, or a policy file.

    In the name of a file, {shipped} is the folder of the shipped policies, {policies} the folder of
    --policies, {scenario} the scenario, and {seed} each of `seeds`. The seeds are those of trainings; the row
    then has mean and standard deviation over them. `trained` has the options in which these trainings differ
    from those of other pilots; the config.json beside each policy must agree (trained.py).
    """

    policy: str
    seeds: List[int] = dataclasses.field(default_factory=list)
    trained: dict = dataclasses.field(default_factory=dict)

    def is_file(self):
        """True if it is a policy file."""
        return self.policy.endswith(".onnx")


@dataclasses.dataclass
class Section:
    """One table. `pilots` has the kinds of knowledge of each pilot; `variants` has the overrides of each."""

    title: str
    conditions: List[str]
    pilots: dict
    scenarios: List[str]
    variants: dict = dataclasses.field(default_factory=lambda: {"": []})
    episodes: int = 0  # 0: the number of the study


@dataclasses.dataclass
class Column:
    """A metric of `evaluate`: its heading, its digits, and the factor of its unit on the page."""

    metric: str
    title: str
    digits: int = 2
    scale: float = 1.0
    std: bool = False  # the page also has the standard deviation
    beside: bool = False  # the table of one pilot beside the best of the others has it, too


@dataclasses.dataclass
class FlightStudy:
    """The flights of a study, and how they are shown."""

    kind: str
    name: str
    title: str
    episodes: int
    columns: List[object]
    sections: List[object]
    pilots: dict = dataclasses.field(default_factory=dict)
    knows: dict = dataclasses.field(default_factory=lambda: {"own": {}})
    seed: int = 5000000  # seed of the first episode, in the reporting block
    notes: str = ""
    # The other pilots are compared with this pilot by this metric, episode by episode.
    compare: str = ""
    compare_metric: str = "band_share"
    # True: a column has the share of the gap to true states that a row closes.
    gap_closed: bool = False
    # Folders of trainings, in the folder of the table. The page shows their validation.csv.
    trainings: List[str] = dataclasses.field(default_factory=list)
    # A second table: the first of these pilots, and the best of the others.
    beside: List[str] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Cell:
    """One row of a table, and the jobs that fly it, one for each seed of training."""

    section: str
    scenario: str
    condition: str
    variant: str
    pilot: str
    knows: str
    jobs: List[Flight]

    def key(self):
        """The values that rows with the same episodes have in common."""
        return (self.section, self.scenario, self.condition, self.variant)


def is_flight_study(data):
    """True if the content of a file is a study of flights."""
    return isinstance(data, dict) and data.get("kind") == "flights"


def flight_study_from(data, where):
    """Makes a FlightStudy from a mapping. Raises StudyError if it is invalid."""
    study = build(FlightStudy, where, data)
    study.columns = [build(Column, f"{where}: columns[{i}]", c) for i, c in enumerate(study.columns)]
    study.sections = [build(Section, f"{where}: sections[{i}]", s) for i, s in enumerate(study.sections)]
    study.knows = {k: build(Knowledge, f"{where}: knows.{k}", v) for k, v in study.knows.items()}
    study.pilots = {
        name: build(Pilot, f"{where}: pilots.{name}", {"policy": what} if isinstance(what, str) else what)
        for name, what in study.pilots.items()
    }
    if not is_name(study.name):
        raise StudyError(f"{where}: name: must consist of letters, digits, '_' and '-'")
    if study.episodes < 1 or study.seed < 0:
        raise StudyError(f"{where}: episodes must be positive, seed not negative")
    for section in study.sections:
        for pilot, kinds in section.pilots.items():
            if not isinstance(kinds, list) or not kinds or any(k not in study.knows for k in kinds):
                known = ", ".join(study.knows)
                raise StudyError(f"{where}: sections.{section.title}.{pilot}: must be some of {known}")
        if not all(isinstance(v, list) for v in section.variants.values()):
            raise StudyError(f"{where}: sections.{section.title}.variants: must be lists of overrides")
    _check_effect(study, where)
    return study


def _check_effect(study, where):
    """Refuses what no flight and no table uses. Raises StudyError."""
    flown_by = {pilot for section in study.sections for pilot in section.pilots}
    known = {k for section in study.sections for kinds in section.pilots.values() for k in kinds}
    for name in study.pilots:
        if name not in flown_by:
            raise StudyError(f"{where}: pilots.{name}: has no effect, because no section flies it")
    for name, knowledge in study.knows.items():
        is_default = name == "own" and knowledge == Knowledge()
        if name not in known and not is_default:
            raise StudyError(f"{where}: knows.{name}: has no effect, because no pilot of a section has it")
    if study.compare and study.compare not in flown_by:
        raise StudyError(f"{where}: compare: '{study.compare}' is no pilot of a section; there are {', '.join(sorted(flown_by))}")
    if not study.compare and study.compare_metric != FlightStudy.compare_metric:
        raise StudyError(f"{where}: compare_metric: has no effect without compare")
    if len(study.beside) == 1:
        raise StudyError(f"{where}: beside: must have a pilot and at least one other, with which it is compared")
    for name in study.beside:
        for section in study.sections:
            if "own" not in section.pilots.get(name, []):
                raise StudyError(f"{where}: beside: '{name}' does not fly with 'own' in the section {section.title}")
    for i, column in enumerate(study.columns):
        if column.beside and not study.beside:
            raise StudyError(f"{where}: columns[{i}].beside: has no effect, because the study has no list beside")


def save_flight_study(study, path):
    """Writes the study in the form that the reader reads."""
    write_atomically(path, yaml.safe_dump(dataclasses.asdict(study), sort_keys=False, width=96))


def shipped_policies():
    """The folder of the shipped policies."""
    here = os.path.dirname(os.path.realpath(__file__))
    for relative in SHIPPED_POLICIES:
        folder = os.path.normpath(os.path.join(here, relative))
        if os.path.isdir(folder):
            return folder
    raise StudyError("the folder of shipped policies is missing")


def _policy(pilot, scenario, seed, policies):
    """The argument of `evaluate --policy`."""
    if not pilot.is_file():
        return pilot.policy
    if policies is None and "{policies}" in pilot.policy:
        raise StudyError(f"'{pilot.policy}' needs --policies FOLDER")
    try:
        path = pilot.policy.format(
            shipped=shipped_policies(), policies=policies, scenario=scenario, seed=seed
        )
    except (KeyError, ValueError, IndexError):
        raise StudyError(f"'{pilot.policy}': the name in braces is unknown") from None
    if not os.path.exists(path):
        raise FileError(path, "there is no such policy")
    return path


def plan_flights(study, work, bin_dir, policies=None):
    """Returns the cells of all tables, in order. policies: the folder of --policies."""
    cells, trainings = [], {}
    for number, section in enumerate(study.sections):
        places = itertools.product(section.scenarios, section.conditions, section.variants.items())
        for scenario, condition, (variant, overrides) in places:
            for name, kinds in section.pilots.items():
                pilot = study.pilots.get(name) or Pilot(name)
                for knows in kinds:
                    words = (f"{number}", scenario, condition, variant, name, knows)
                    slug = "_".join("".join(c if c.isalnum() else "-" for c in w) for w in words)
                    jobs = []
                    for seed in pilot.seeds or [None]:
                        episodes = section.episodes or study.episodes
                        arguments = ["--scenario", scenario, "--condition", condition]
                        arguments += ["--episodes", str(episodes), "--seed", str(study.seed)]
                        for override in combined(overrides, study.knows[knows].set):
                            arguments += ["--set", override]
                        arguments += ["--privileged"] if study.knows[knows].privileged else []
                        base = os.path.join(work, "flights", slug + ("" if seed is None else f"_{seed}"))
                        policy = _policy(pilot, scenario, seed, policies)
                        if "{policies}" in pilot.policy:
                            trainings[name, seed] = policy
                        label = " ".join(filter(None, ("fly", *words[1:])))
                        jobs.append(Flight(label, policy, arguments, episodes, base, bin_dir, pilot.is_file()))
                    cells.append(Cell(section.title, scenario, condition, variant, name, knows, jobs))
    check_trainings(study, [(name, seed, path) for (name, seed), path in trainings.items()])
    return cells


def flown(cell, metric):
    """(mean, std) of a metric over episodes, or over the means of seeds; None if it has no value."""
    if any(job.summary().get(metric) is None for job in cell.jobs):
        return None
    means = [job.summary()[metric] for job in cell.jobs]
    if len(means) == 1:
        std = cell.jobs[0].summary().get(metric + "_std")
        return float(means[0]), None if std is None else float(std)
    mean = sum(means) / len(means)
    return mean, (sum((m - mean) ** 2 for m in means) / (len(means) - 1)) ** 0.5

