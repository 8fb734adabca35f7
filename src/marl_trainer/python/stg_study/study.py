"""The content of a study, and the strict reader of its YAML file."""

import dataclasses
import os
import reprlib
from typing import Dict, List, Optional

import yaml

from stg_common.yaml_files import read_yaml
from stg_study.files import write_atomically


class StudyError(Exception):
    """An error in a file or an option. The message names both."""


@dataclasses.dataclass
class ScenarioEntry:
    """A scenario and, if any, the paper's scenario with whose tables it is compared."""

    name: str
    paper: Optional[str] = None  # medium | hard
    seeds: List[int] = dataclasses.field(default_factory=list)  # seeds instead of the study's, if any


@dataclasses.dataclass
class Method:
    """A way to train. `paper` and `ablation` name its rows in the paper's tables, if any. A method with
    `ablation` is in our ablation table.

    `set` overrides scenario keys in training and evaluation, `train_set` only in training (a reward), and
    `evaluate_set` only in evaluation. `train` adds options of the train command.
    """

    name: str
    label: str
    variant: str = "stg"
    paper: Optional[str] = None
    ablation: Optional[str] = None
    set: List[str] = dataclasses.field(default_factory=list)
    train_set: List[str] = dataclasses.field(default_factory=list)
    evaluate_set: List[str] = dataclasses.field(default_factory=list)
    train: Dict[str, object] = dataclasses.field(default_factory=dict)

    def reward(self):
        """The reward of the training: "scenario" (the scenario's own), "variant" (that of its variant) or
        "own" (one that `train_set` makes)."""
        if any(key.startswith("reward.") for key in self.train_set):
            return "own"
        return "scenario" if self.variant == "stg" else "variant"


@dataclasses.dataclass
class Reference:
    """A built-in controller, with additional options of the evaluate command."""

    name: str
    label: str
    policy: str
    arguments: List[str] = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Study:
    """Seeds x methods x scenarios x conditions, and the settings of training and evaluation."""

    name: str
    title: str
    scenarios: List[ScenarioEntry]
    conditions: List[str]
    methods: List[Method]
    controllers: List[Reference]
    preset: str = "fast"
    seeds: List[int] = dataclasses.field(default_factory=lambda: [0, 1, 2])
    steps: int = 1000000  # environment steps of each training
    episodes: int = 30  # of each evaluation
    evaluation_seed: int = 5000000  # for training seed 0, in the reporting block
    evaluation_seed_stride: int = 10000  # between two training seeds
    agents: int = 4  # divides returns where the paper averages over the agents
    train: Dict[str, object] = dataclasses.field(default_factory=dict)
    notes: str = ""

    def evaluation_seed_of(self, seed):
        """First evaluation seed for the training seed `seed`; episode e has this seed + e."""
        return self.evaluation_seed + self.evaluation_seed_stride * seed

    def seeds_of(self, scenario):
        """Training seeds on a scenario."""
        return scenario.seeds or self.seeds

    def method_names(self):
        """Names of methods, then of controllers, in the order of the tables."""
        return [m.name for m in self.methods] + [c.name for c in self.controllers]

    def labels(self):
        """Label of every method and controller by its name."""
        return {entry.name: entry.label for entry in self.methods + self.controllers}


def _fail(where, message):
    raise StudyError(f"{where}: {message}")


def is_option(name, value):
    """True if an option of the train command can have this name and value."""
    return isinstance(name, str) and isinstance(value, (int, float, str))


def is_name(text):
    """True if a text can be part of the name of a file."""
    return bool(text) and all(c.isalnum() or c in "_-" for c in text)


def _check_type(where, value, expected):
    """Refuses a value of the wrong type. A whole number is accepted only as such, and so is a bool."""
    if expected is int:
        good = isinstance(value, int) and not isinstance(value, bool)
    elif expected == Optional[str]:
        good = value is None or isinstance(value, str)
    elif expected in (str, bool):
        good = isinstance(value, expected)
    elif expected is float:
        good = isinstance(value, (int, float)) and not isinstance(value, bool)
    elif expected == List[int]:
        good = isinstance(value, list) and all(
            isinstance(v, int) and not isinstance(v, bool) for v in value
        )
    elif expected == List[str]:
        good = isinstance(value, list) and all(isinstance(v, str) for v in value)
    elif expected == Dict[str, object]:
        good = isinstance(value, dict) and all(is_option(k, v) for k, v in value.items())
    else:
        good = isinstance(value, dict if expected is dict else list)
    if not good:
        _fail(where, f"{reprlib.repr(value)} has the wrong type")


def build(kind, where, data):
    """Makes the dataclass `kind` from the mapping `data`; unknown and missing keys are errors."""
    if not isinstance(data, dict):
        _fail(where, "must be a mapping")
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for key in data:
        if key not in fields:
            _fail(f"{where}.{key}", "unknown key; there are " + ", ".join(fields))
    for key, field in fields.items():
        has_default = (
            field.default is not dataclasses.MISSING
            or field.default_factory is not dataclasses.MISSING
        )
        if key not in data and not has_default:
            _fail(f"{where}.{key}", "missing")
        if key in data:
            _check_type(f"{where}.{key}", data[key], field.type)
    return kind(**data)


def _check(study, path):
    names = study.method_names()
    for name in names + [s.name for s in study.scenarios] + study.conditions:
        if not is_name(name):
            _fail(path, f"'{name}' must consist of letters, digits, '_' and '-'")
    for key, values in (
        ("methods and controllers", names),
        ("scenarios", [s.name for s in study.scenarios]),
        ("conditions", study.conditions),
        ("seeds", study.seeds),
    ):
        if not values or len(set(values)) != len(values):
            _fail(path, f"{key}: must not be empty and must not repeat")
    for scenario in study.scenarios:
        if len(set(scenario.seeds)) != len(scenario.seeds) or min(scenario.seeds, default=0) < 0:
            _fail(f"{path}: scenarios.{scenario.name}.seeds", "must not be negative or repeat")
    if min(study.steps, study.episodes, study.agents) < 1 or min(study.seeds) < 0:
        _fail(path, "steps, episodes and agents must be positive, seeds not negative")
    if study.evaluation_seed < 0 or study.evaluation_seed_stride < study.episodes:
        _fail(path, "evaluation_seed_stride: evaluations of two seeds must not share episodes")
    for scenario in study.scenarios:
        if scenario.paper not in (None, "medium", "hard"):
            where = f"{path}: scenarios.{scenario.name}.paper"
            _fail(where, f"'{scenario.paper}' is not medium or hard")


def study_from(data, where):
    """Makes a Study from the mapping `data`. `where` names its source in errors."""
    if not isinstance(data, dict):
        _fail(where, "must be a mapping")
    data = dict(data)
    kinds = {"scenarios": ScenarioEntry, "methods": Method, "controllers": Reference}
    for key, kind in kinds.items():
        entries = data.get(key)
        if not isinstance(entries, list):
            _fail(f"{where}: {key}", "must be a list")
        data[key] = [build(kind, f"{where}: {key}[{i}]", e) for i, e in enumerate(entries)]
    study = build(Study, where, data)
    _check(study, where)
    return study


def load_study(path):
    """Reads a study from a YAML file."""
    return study_from(read_yaml(path), path)


def save_study(study, path):
    """Writes the resolved study in the form that load_study reads."""
    write_atomically(path, yaml.safe_dump(dataclasses.asdict(study), sort_keys=False, width=96))


def shipped_studies():
    """Folder of the shipped studies, in the source or the install space."""
    here = os.path.dirname(os.path.realpath(__file__))
    for relative in ("../../studies", "../../../../share/marl_trainer/studies"):
        folder = os.path.normpath(os.path.join(here, relative))
        if os.path.isdir(folder):
            return folder
    raise StudyError("the folder of shipped studies is missing")


def find_study(name_or_path):
    """Path of a study, given as a file or by the name of a shipped study."""
    if os.path.exists(name_or_path) and not os.path.isdir(name_or_path):
        return name_or_path
    names = []
    for folder in (shipped_studies(), os.path.join(shipped_studies(), "flights")):
        path = os.path.join(folder, name_or_path + ".yaml")
        if os.path.isfile(path):
            return path
        names += sorted(f[:-5] for f in os.listdir(folder) if f.endswith(".yaml"))
    raise StudyError(f"--study: no file or study '{name_or_path}'; there are " + ", ".join(names))
