"""Tests of the search of options: its draws, its choice and its files."""

import csv
import math
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from unittest import mock

import yaml

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))

import stub_programs
from stg_study import search, study

SEARCH = """
scenario: medium_release
steps: 1000
trials: 4
training_seeds: [1000, 1001]
fixed: {masac: {critic-hidden: "128,128"}}
algorithms:
  mappo: {lr: {log: [1.0e-4, 1.0e-2]}, epochs: [2, 3]}
  masac: {tau: [0.01]}
"""


def sample(**changes):
    return search.Search(**{**yaml.safe_load(SEARCH), **changes})


class Draws(unittest.TestCase):
    def test_the_first_trial_is_the_preset_and_all_lie_in_the_space(self):
        trials = search.trials_of(sample(trials=40), "mappo")
        self.assertEqual(len(trials), 40)
        self.assertEqual(trials[0], {})
        rates = [trial["lr"] for trial in trials[1:]]
        self.assertTrue(all(1e-4 <= rate <= 1e-2 for rate in rates))
        # The draws are even in the logarithm. Half of them are below the geometric mean, 1e-3, +- 4 sigma.
        below = sum(rate < 1e-3 for rate in rates)
        self.assertLess(abs(below - 19.5), 4.0 * 39**0.5 / 2.0)
        self.assertEqual({trial["epochs"] for trial in trials[1:]}, {2, 3})

    def test_rounding_does_not_leave_a_narrow_interval(self):
        # With two digits these would become 0.99, which is below, and 1, which is above.
        narrow = sample(algorithms={"masac": {"gamma": {"log": [0.992, 0.998]}}}, trials=40)
        drawn = [trial["gamma"] for trial in search.trials_of(narrow, "masac")[1:]]
        self.assertTrue(all(0.992 <= gamma <= 0.998 for gamma in drawn), drawn)
        self.assertEqual(len(set(drawn)), len(drawn))

    def test_draws_depend_on_the_seed_and_on_no_other_algorithm(self):
        alone = sample(algorithms={"mappo": sample().algorithms["mappo"]})
        self.assertEqual(search.trials_of(alone, "mappo"), search.trials_of(sample(), "mappo"))
        other = search.trials_of(sample(draw_seed=2), "mappo")
        self.assertNotEqual(other, search.trials_of(sample(), "mappo"))

    def test_the_same_trial_of_every_algorithm_has_the_same_options(self):
        folder = os.path.join(study.shipped_studies(), "search")
        shipped = search.load_search(os.path.join(folder, "equal_terms.yaml"))
        self.assertGreaterEqual(shipped.trials, 20)
        self.assertGreaterEqual(len(shipped.training_seeds), 3)
        on_policy = [search.trials_of(shipped, name) for name in ("mappo", "ippo", "happo")]
        self.assertEqual(on_policy[0], on_policy[1])
        self.assertEqual(on_policy[0], on_policy[2])
        # The gradient steps per update (epochs times minibatches) are then equal, too.
        maddpg, masac = (search.trials_of(shipped, name) for name in ("maddpg", "masac"))
        shared = set(shipped.algorithms["maddpg"]) & set(shipped.algorithms["masac"])
        self.assertGreaterEqual(shared, {"lr", "critic-lr", "tau", "n-step", "batch"})
        for option in shared:
            self.assertEqual([t.get(option) for t in maddpg], [t.get(option) for t in masac], option)
        for mappo, other in zip(on_policy[0], masac):
            self.assertEqual(mappo.get("lr"), other.get("lr"))
        self.assertGreater(len({str(trial) for trial in on_policy[0]}), 19)

    def test_the_best_is_the_highest_return_and_the_earlier_of_equals(self):
        scores = [None] + [search.Score(value, 0.0, 0.0, 1.0) for value in (3.0, 5.0, 5.0)]
        self.assertEqual(search.choose_best(scores), 2)
        self.assertIsNone(search.choose_best([None]))

    def test_mistakes_are_refused_by_name(self):
        for changes, name in (
            ({"algorithms": {"mappo": {"lr": {"log": [1e-2, 1e-4]}}}}, "mappo.lr"),
            ({"algorithms": {"mappo": {"lr": []}}}, "mappo.lr"),
            ({"algorithms": {"mappo": 3}}, "algorithms.mappo"),
            ({"trials": 0}, "trials"),
            ({"training_seeds": [1, 1]}, "training_seeds"),
            ({"scenaro": "a"}, "scenaro"),
            ({"algorithms": {"mappo": {"lr": {"log": [1.0, math.inf]}}}}, "mappo.lr"),
            ({"algorithms": {"mappo": {"lr": [[1]]}}}, "mappo.lr"),
            ({"algorithms": {"../mappo": {}}}, "../mappo"),
            ({"algorithms": {"mappo": {None: [1]}}}, "mappo.None"),
            ({"fixed": {"mappo": 3}}, "fixed.mappo"),
            ({"fixed": {"mappo": {"lr": []}}}, "fixed.mappo.lr"),
            ({"fixed": {"ippo": {"lr": 0.1}}}, "fixed.ippo: has no effect, because algorithms does not have ippo"),
        ):
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "search.yaml")
                with open(path, "w", encoding="utf-8") as file:
                    yaml.safe_dump({**yaml.safe_load(SEARCH), **changes}, file)
                with self.assertRaises(study.StudyError) as caught:
                    search.load_search(path)
                self.assertIn(name, str(caught.exception))
                self.assertIn(path, str(caught.exception))

    def test_the_shipped_search_gives_every_algorithm_as_many_trials(self):
        folder = os.path.join(study.shipped_studies(), "search")
        shipped = search.load_search(os.path.join(folder, "equal_terms.yaml"))
        self.assertEqual(len(shipped.algorithms), 7)
        trained = study.load_study(study.find_study("equal_terms"))
        self.assertFalse(set(shipped.training_seeds) & set(trained.seeds))


class Tune(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        stub_programs.write_stubs(self.folder)
        self.search = os.path.join(self.folder, "search.yaml")
        with open(self.search, "w", encoding="utf-8") as file:
            file.write(SEARCH)

    def tune(self, *arguments):
        out = os.path.join(self.folder, "out")
        return subprocess.run(
            ["/usr/bin/python3", os.path.join(PACKAGE, "scripts", "tune"), "--search", self.search,
             "--out", out, "--bin", self.folder, "--jobs", "2", *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False,
        )  # fmt: skip

    def test_a_search_writes_its_trials_and_what_it_chose_and_runs_nothing_twice(self):
        done = self.tune()
        self.assertEqual(done.returncode, 0, done.stdout)
        calls = stub_programs.calls(self.folder)
        self.assertEqual(len(calls), 16)
        masac = [call for call in calls if "--algorithm masac" in call]
        self.assertEqual(sum("--critic-hidden 128,128" in call for call in masac), 8)
        self.assertEqual(sum("--tau 0.01" in call for call in masac), 6)
        with open(os.path.join(self.folder, "out", "trials.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 8)
        with open(os.path.join(self.folder, "out", "chosen.yaml"), encoding="utf-8") as file:
            chosen = yaml.safe_load(file)
        for algorithm in ("mappo", "masac"):
            mine = [row for row in rows if row["algorithm"] == algorithm]
            best = max(mine, key=lambda row: float(row["return"]))
            self.assertEqual([row for row in mine if row["chosen"] == "1"], [best])
            trial = search.trials_of(sample(), algorithm)[int(best["trial"])]
            self.assertEqual(chosen[algorithm], trial)
        self.assertEqual(self.tune().returncode, 0)
        self.assertEqual(stub_programs.calls(self.folder), [])

    def test_a_search_goes_on_without_the_folder_of_its_runs(self):
        self.assertEqual(self.tune("--algorithms", "mappo").returncode, 0)
        self.assertEqual(len(stub_programs.calls(self.folder)), 8)
        out = os.path.join(self.folder, "out")
        with open(os.path.join(out, "trials.csv"), encoding="utf-8") as file:
            before = file.read()
        shutil.rmtree(os.path.join(out, "work"))
        self.assertEqual(self.tune("--algorithms", "mappo").returncode, 0)
        self.assertEqual(stub_programs.calls(self.folder), [])
        with open(os.path.join(out, "trials.csv"), encoding="utf-8") as file:
            self.assertEqual(file.read(), before)
        self.assertEqual(self.tune().returncode, 0)
        calls = stub_programs.calls(self.folder)
        self.assertEqual(len(calls), 8)
        self.assertTrue(all("--algorithm masac" in call for call in calls))
        with open(self.search, "a", encoding="utf-8") as file:
            file.write("preset: full\n")
        self.tune("--algorithms", "mappo")
        self.assertEqual(len(stub_programs.calls(self.folder)), 8, "other options are other runs")

    def test_a_damaged_file_of_results_is_refused_in_one_line(self):
        path = os.path.join(self.folder, "out", "finished.json")
        os.makedirs(os.path.dirname(path))
        for content, what in (
            ("[]", "is not an object"), ('{"a": {"return": "high"}}', "return: is not a finite number"), ("{", "is not JSON"),
        ):  # fmt: skip
            with open(path, "w", encoding="utf-8") as file:
                file.write(content)
            done = self.tune()
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertRegex(done.stdout.splitlines()[-1], f"^tune: .*finished.json.*{re.escape(what)}")

    def test_the_table_has_the_digits_that_the_choice_was_made_from(self):
        scores = [search.Score(value, 0.0, 0.0, 1.0) for value in (1000.01, 1000.02, 1000.04, 1000.03)]
        with mock.patch.object(search, "score_of", lambda score: score):
            search.write_search(sample(), {"masac": scores}, self.folder)
        with open(os.path.join(self.folder, "trials.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["chosen"] for row in rows], ["0", "0", "1", "0"])
        self.assertEqual(max(rows, key=lambda row: float(row["return"])), rows[2])

    def test_damaged_runs_are_refused_in_one_line(self):
        self.assertEqual(self.tune("--algorithms", "masac").returncode, 0)
        run = os.path.join(self.folder, "out", "work", "runs", "medium_release", "masac_1", "seed1000")
        with open(os.path.join(run, "progress.csv"), encoding="utf-8") as file:
            lines = file.read().splitlines(keepends=True)
        many = lines[:-1] + [lines[-1].replace("1000,", "many,", 1)]
        for name, content, what in (
            ("progress.csv", "".join(many), f"progress.csv:{len(many)}: env_steps: 'many'"),
            ("progress.csv", lines[0], "progress.csv: contains no validation"),
            ("progress.csv", lines[1], "progress.csv:1: no column"),
            ("summary.json", "[]", "summary.json: is not an object"),
            ("study_job.json", '{"arguments": 3}', "study_job.json: arguments: is not a list"),
        ):
            path = os.path.join(run, name)
            with open(path, encoding="utf-8") as file:
                whole = file.read()
            with open(path, "w", encoding="utf-8") as file:
                file.write(content)
            done = self.tune("--algorithms", "masac")
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertRegex(done.stdout.splitlines()[-1], f"^tune: .*{re.escape(what)}")
            self.assertNotIn("Traceback", done.stdout)
            with open(path, "w", encoding="utf-8") as file:
                file.write(whole)
        self.assertEqual(self.tune("--algorithms", "masac").returncode, 0)

    def test_an_unknown_algorithm_is_refused(self):
        done = self.tune("--algorithms", "mappoo")
        self.assertEqual(done.returncode, 2)
        self.assertIn("mappoo", done.stdout)


if __name__ == "__main__":
    unittest.main()
