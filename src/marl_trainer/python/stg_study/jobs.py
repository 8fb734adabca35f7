"""The trainings and evaluations of a study: their command lines, and the checks if they are complete."""

import glob
import hashlib
import json
import os
import shutil

from stg_common.csv_files import number, optional, table_rows, written
from stg_common.files import Damaged, FileError, expect, member, opened, read_json
from stg_study.files import locked, write_atomically

# Block of stg_env/env/seed_blocks.hpp, as named by evaluate. No choice has used these episodes.
REPORTING = "reporting"


def read_record(path):
    """The object in a JSON file. None if a job that was cut off left no file or a part of one. Raises
    FileError if the file has other content."""
    if not os.path.exists(path):
        return None
    try:
        record = read_json(path)
    except Damaged:
        return None
    return expect(path, record, dict)


def policy_files(path):
    """The policy file, or one file for each AUV if every AUV has its own; empty if there are none."""
    if os.path.isfile(path):
        return [path]
    stem, extension = os.path.splitext(path)
    return sorted(glob.glob(f"{glob.escape(stem)}_[0-9]*{extension}"))


def policy_hash(path):
    """SHA-256 of the policy's files, or None if there are none."""
    digest = hashlib.sha256()
    files = policy_files(path)
    for name in files:
        with opened(name) as file:
            for block in iter(lambda: file.read(1 << 20), b""):
                digest.update(block)
    return digest.hexdigest() if files else None


def _options(mapping):
    return [text for key, value in mapping.items() for text in ("--" + key, str(value))]


def combined(earlier, later):
    """Both lists of overrides "key=value" as one, without those of `earlier` whose key `later` sets, too."""
    keys = {text.partition("=")[0] for text in later}
    return [text for text in earlier if text.partition("=")[0] not in keys] + list(later)


def _overrides(values):
    return [text for value in values for text in ("--set", value)]


class Training:
    """One training run: a scenario, a method and a seed. All its files are in its folder."""

    kind = "training"
    RECORD = "study_job.json"  # the options with which the folder's run was started

    def __init__(self, study, scenario, method, seed, work, bin_dir):
        self.name = f"train {scenario.name} {method.name} seed {seed}"
        self.scenario, self.method, self.seed = scenario.name, method.name, seed
        self.folder = os.path.join(work, "runs", scenario.name, method.name, f"seed{seed}")
        self.policy = os.path.join(self.folder, "policy_best.onnx")
        self.log = self.folder + ".log"
        self.summary_file = os.path.join(self.folder, "summary.json")
        self.progress_file = os.path.join(self.folder, "progress.csv")
        self.steps = study.steps
        self.arguments = [
            *("--scenario", scenario.name, "--preset", study.preset, "--variant", method.variant),
            *("--seed", str(seed), "--steps", str(study.steps)),
            *_options({**study.train, **method.train}),
            *_overrides(combined(method.set, method.train_set)),
        ]
        self._program = os.path.join(bin_dir, "train")

    def conflict(self):
        """The reason why the folder cannot be used, because it has other content; None if it can."""
        record = self._arguments()
        if record is None and os.path.isdir(self.folder) and os.listdir(self.folder):
            return f"{self.folder} is neither empty nor the folder of a run of a study"
        if record is not None and record != self.arguments:
            return (
                f"{self.folder} was trained with other options ({' '.join(record)}); "
                "use another --out, or delete that folder"
            )
        return None

    def _arguments(self):
        """The options with which the folder's run was started, or None."""
        path = os.path.join(self.folder, self.RECORD)
        record = read_record(path)
        if record is None:
            return None
        arguments = member(path, record, "arguments", list)
        return [expect(path, text, str, "arguments") for text in arguments]

    def summary(self):
        """The summary of the finished run, or None."""
        summary = read_record(self.summary_file)
        if summary is not None:
            expect(self.summary_file, summary.get("stopped", ""), str, "stopped")
            expect(self.summary_file, summary.get("env_steps", 0), float, "env_steps")
        return summary

    def validations(self, metrics=()):
        """The content of progress.csv at every validation: the text `env_steps`, and the numbers
        `wall_seconds` and validation_<metric> including all of the `metrics`, under these names."""
        needed = ["validation_return", "validation_lost_rate", *metrics]
        columns = {
            "env_steps": written(number), "wall_seconds": number, "validation_seconds": str,
            **dict.fromkeys(needed, optional(number)),
        }  # fmt: skip
        found = []
        for row in table_rows(
            self.progress_file,
            columns,
            lambda name: optional(number) if name.startswith("validation_") else str,
        ):
            del row["validation_seconds"]
            if row["validation_return"] is None:
                continue
            if any(row[name] is None for name in row if name.startswith("validation_")):
                raise Damaged(self.progress_file, f"half a validation at {row['env_steps']} steps")
            found.append(row)
        return found

    def complete(self):
        """True if the run reached its last step and wrote its policy."""
        summary = self.summary()
        return (
            summary is not None
            and summary.get("stopped") == "finished"
            and summary.get("env_steps", 0) >= self.steps
            and self._arguments() == self.arguments
            and bool(policy_files(self.policy))
        )

    def prepare(self):
        """Command that starts or continues the run. A run without a checkpoint starts again."""
        resume = bool(glob.glob(os.path.join(self.folder, "checkpoint_*.ckpt")))
        if not resume and os.path.isdir(self.folder):
            with locked(self.folder):
                pass  # a training whose study was killed may still be saving
            shutil.rmtree(self.folder)
        os.makedirs(self.folder, exist_ok=True)
        write_atomically(
            os.path.join(self.folder, self.RECORD), json.dumps({"arguments": self.arguments})
        )
        command = [self._program, *self.arguments, "--out", self.folder, "--workers", "1"]
        return command + (["--resume"] if resume else [])

    def finish(self, output):
        """Nothing to do after a training."""

    def fraction_done(self):
        """Share of the steps, from the progress file."""
        try:
            with opened(self.progress_file) as file:
                file.seek(0, os.SEEK_END)
                file.seek(max(0, file.tell() - 4096))
                lines = file.read().decode(errors="replace").splitlines()
            return min(1.0, number(lines[-1].split(",")[0]) / self.steps)
        except (FileError, ValueError, IndexError):
            return 0.0


class Flight:
    """Episodes of `evaluate`: one policy or controller under one condition, from one seed on.

    base: path of its files, without their endings. is_file: the policy is a file, and the result depends on
    its content. block: the episodes must be in this block of seeds.
    """

    kind = "evaluation"
    training = None

    def __init__(self, name, policy, arguments, episodes, base, bin_dir, is_file=False, block=REPORTING):
        self.name, self.policy, self.arguments, self.episodes = name, policy, arguments, episodes
        self.csv, self.json, self.log = base + ".csv", base + ".json", base + ".log"
        self._program = os.path.join(bin_dir, "evaluate")
        self._is_file, self._block = is_file, block

    def words(self):
        """The policy and the options, in the order of a command line."""
        return [self.policy, *self.arguments]

    def _identity(self):
        """Everything that the result depends on: the options and the policy's content."""
        return {
            "arguments": self.arguments,
            "policy": policy_hash(self.policy) if self._is_file else self.policy,
        }

    def conflict(self):
        """There are no conflicts: an evaluation with other options is repeated."""
        return None

    def complete(self):
        """True if the result exists, is complete, and is for this policy and these options."""
        result = read_record(self.json)
        if result is None or result.get("identity") != self._identity():
            return False
        if not os.path.exists(self.csv):
            return False
        try:
            return sum(1 for _ in table_rows(self.csv)) == self.episodes
        except Damaged:
            return False  # it is evaluated again

    def prepare(self):
        """Command that evaluates into a temporary file."""
        os.makedirs(os.path.dirname(self.csv), exist_ok=True)
        command = [self._program, "--policy", self.policy, *self.arguments]
        return command + ["--csv", self.csv + ".part", "--workers", "1"]

    def summary(self):
        """The metrics of the complete result."""
        return member(self.json, read_json(self.json), "summary", dict)

    def episode_values(self, metric):
        """The metric of every episode of the complete result, in order."""
        return [row[metric] for row in table_rows(self.csv, {metric: number})]

    def finish(self, output):
        """Stores the result. `output` ends with the JSON object of the evaluate command."""
        summary = json.loads(output.strip().splitlines()[-1])
        block = summary.get("seed_block")
        if block != self._block:
            raise FileError(
                self.name, f"its episodes belong to the {block} block, but must belong to the {self._block} block"
            )
        os.replace(self.csv + ".part", self.csv)
        result = {"identity": self._identity(), "summary": summary}
        write_atomically(self.json, json.dumps(result, indent=1))

    def fraction_done(self):
        """Always 0, because evaluations are short."""
        return 0.0


class Evaluation(Flight):
    """A method or controller of a study, under one condition and with one block of evaluation seeds."""

    def __init__(self, study, scenario, condition, entry, seed, work, bin_dir, training=None):
        base = os.path.join(
            work, "evaluations", scenario.name, condition, f"{entry.name}_seed{seed}"
        )
        arguments = [
            *("--scenario", scenario.name, "--condition", condition),
            *("--episodes", str(study.episodes)),
            *("--seed", str(study.evaluation_seed_of(seed))),
        ]
        if training is None:
            arguments += entry.arguments
        else:
            if entry.variant != "stg":
                arguments += ["--variant", entry.variant]
            arguments += _overrides(combined(entry.set, entry.evaluate_set))
        name = f"evaluate {scenario.name} {condition} {entry.name} seed {seed}"
        policy = training.policy if training else entry.policy
        super().__init__(name, policy, arguments, study.episodes, base, bin_dir, is_file=bool(training))
        self.scenario, self.condition = scenario.name, condition
        self.method, self.seed = entry.name, seed
        self.training = training


def plan(study, work, bin_dir):
    """All trainings and all evaluations of a study, each list in the order of execution."""
    trainings, evaluations = [], []
    for scenario in study.scenarios:
        for controller in study.controllers:
            for seed in study.seeds_of(scenario):
                for condition in study.conditions:
                    evaluations.append(
                        Evaluation(study, scenario, condition, controller, seed, work, bin_dir)
                    )
    # One seed of all methods, then the next one: a study that is cut short has complete comparisons.
    runs = [
        (k, scenario, seed)
        for scenario in study.scenarios
        for k, seed in enumerate(study.seeds_of(scenario))
    ]
    for _, scenario, seed in sorted(runs, key=lambda run: run[0]):
        for method in study.methods:
            training = Training(study, scenario, method, seed, work, bin_dir)
            trainings.append(training)
            for condition in study.conditions:
                evaluations.append(
                    Evaluation(study, scenario, condition, method, seed, work, bin_dir, training)
                )
    return trainings, evaluations
