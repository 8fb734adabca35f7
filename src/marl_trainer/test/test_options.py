"""Options of the reproduce command, and the overrides that it composes."""

import unittest

import yaml
from stg_study.jobs import plan
from stg_study.study import study_from

from study_case import STUDY, StudyCase


class Options(StudyCase):
    def test_options_without_effect_are_refused(self):
        for option in (
            ["--preset=fast"], ["--policies=x"], ["--jobs=2"], ["--bin=x"], ["--work=x"],
            ["--no-training"], ["--keep"], ["--methods=stg"], ["--scenarios=x"], ["--seeds=0"],
            ["--steps=9"], ["--episodes=4"], ["--no-report"], ["--quick"],
        ):  # fmt: skip
            with self.subTest(option):
                self.refused(f"{option[0].split('=')[0]}: has no effect", "--report-only", *option)
        self.refused("--keep: needs --methods", "--keep")
        self.refused("--policies: only a study of flights", "--policies", "x")

    def test_an_override_of_the_training_replaces_that_of_the_method(self):
        method = {"name": "a", "label": "a", "set": ["k=1", "j=1"], "train_set": ["k=2"],
                  "evaluate_set": ["j=3"]}  # fmt: skip
        study = study_from({**yaml.safe_load(STUDY), "methods": [method]}, "study")
        trainings, evaluations = plan(study, "work", "bin")
        self.assertEqual(trainings[0].arguments[-4:], ["--set", "j=1", "--set", "k=2"])
        flown = next(e for e in evaluations if e.training)
        self.assertEqual(flown.arguments[-4:], ["--set", "k=1", "--set", "j=3"])


if __name__ == "__main__":
    unittest.main()
