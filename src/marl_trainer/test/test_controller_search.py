"""The search for a controller's constants finds them, keeps every trial, and uses only its own seeds."""

import csv
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

PACKAGE = pathlib.Path(__file__).resolve().parents[1]
# In place of `evaluate`: the return has its peak at gain 2, and a contact costs more than it gains.
EVALUATE = f"""#!{sys.executable}
import json, math, sys
given = dict(zip(sys.argv[1::2], sys.argv[2::2]))
open(given["--csv"], "w").write("episode\\n" + "0\\n" * int(given["--episodes"]))
constants = dict(c.split("=") for c in given["--policy"].partition(":")[2].split(",") if c)
gain, cap = float(constants.get("gain", 0.1)), float(constants.get("cap", 1.0))
print(json.dumps({{"return": 100 - math.log(gain / 2) ** 2 + cap, "contact": cap,
                   "seed_block": "choosing" if int(given["--seed"]) < 1000000 else "reporting"}}))
"""
SEARCH = {
    "controller": "pursuit", "space": {"gain": [0.05, 20.0], "cap": [0.0, 1.0]}, "start": [{}],
    "scenarios": ["medium"], "conditions": ["nominal"], "episodes": 3, "seed": 7,
    "trials": 40, "random_trials": 15, "step": [0.2, 0.02], "draws": 4,
    "score": {"return": 1.0, "contact": -2.0},
}


class Tune(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name in ("train", "evaluate"):
            (self.folder / name).write_text(EVALUATE)
            (self.folder / name).chmod(0o755)

    def run_tune(self, **changes):
        """Runs the program; returns the finished process."""
        search = dict(SEARCH, **changes)
        file = self.folder / "search.yaml"
        if file.is_fifo():
            file.unlink()
        file.write_text(yaml.safe_dump(search))
        return self.run_file()

    def run_file(self):
        """Runs the program with the search that is there; returns the finished process."""
        return subprocess.run(
            [sys.executable, str(PACKAGE / "scripts" / "tune"), "--search", str(self.folder / "search.yaml"),
             "--out", str(self.folder / "out"), "--bin", str(self.folder)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)

    def trials(self):
        """Returns the rows of the table."""
        with open(self.folder / "out" / "trials.csv", encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    def test_finds_the_best_constants_and_keeps_every_trial(self):
        run = self.run_tune()
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("40 trials, 120 episodes", run.stdout)
        rows = self.trials()
        self.assertEqual([int(row["trial"]) for row in rows], list(range(40)))
        self.assertEqual(rows[0]["gain"], "", "the shipped constants come first")
        best = max(rows, key=lambda row: float(row["score"]))
        self.assertAlmostEqual(float(best["gain"]), 2.0, delta=0.4)
        self.assertLess(float(best["cap"]), 0.1)
        self.assertAlmostEqual(
            float(best["score"]), float(best["return"]) - 2.0 * float(best["contact"]), delta=1e-3)

    def test_a_search_that_is_started_again_flies_nothing_twice(self):
        self.run_tune(trials=5)
        first = self.trials()
        (self.folder / "evaluate").write_text("#!/bin/false\n")
        self.assertEqual(self.run_tune(trials=5).returncode, 0)
        self.assertEqual(self.trials(), first)

    def test_a_search_goes_on_without_the_folder_of_its_flights(self):
        self.run_tune(trials=5)
        first = self.trials()
        shutil.rmtree(self.folder / "out" / "work")
        self.assertEqual(self.run_tune(trials=6).returncode, 0)
        self.assertEqual(self.trials()[:5], first)
        flown = list((self.folder / "out" / "work" / "flights").glob("*.csv"))
        self.assertEqual(len(flown), 1)

    def test_kept_results_without_a_scored_metric_are_flown_again(self):
        self.assertEqual(self.run_tune(trials=5, score={"return": 1.0}).returncode, 0)
        shutil.rmtree(self.folder / "out" / "work")
        run = self.run_tune(trials=5)
        self.assertEqual(run.returncode, 0, run.stderr)
        flown = list((self.folder / "out" / "work" / "flights").glob("*.csv"))
        self.assertEqual(len(flown), 5)

    def test_the_best_fly_again_on_other_episodes(self):
        # From the second seed on, the return of every episode has another peak: gain 4.
        other = EVALUATE.replace("gain / 2", "gain / (2 if given['--seed'] == '7' else 4)")
        (self.folder / "evaluate").write_text(other)
        run = self.run_tune(finals={"trials": 5, "episodes": 6, "seed": 90}, set=["time.episode_steps=9"])
        self.assertEqual(run.returncode, 0, run.stderr)
        trials = {row["trial"]: row for row in self.trials()}
        with open(self.folder / "out" / "finals.csv", encoding="utf-8", newline="") as file:
            finals = list(csv.DictReader(file))
        best = sorted(trials.values(), key=lambda row: -float(row["score"]))[:5]
        self.assertEqual({row["trial"] for row in finals}, {row["trial"] for row in best} | {"0"})
        self.assertEqual([float(row["score"]) for row in finals],
                         sorted((float(row["score"]) for row in finals), reverse=True))  # fmt: skip
        chosen = finals[0]
        self.assertIn(f"chosen: trial {chosen['trial']}: {chosen['score']} pursuit:", run.stdout)
        self.assertEqual(chosen["gain"], max((row["gain"] for row in finals if row["gain"]), key=float))
        self.assertIn(f"40 trials, {40 * 3 + len(finals) * 6} episodes", run.stdout)

    def test_overrides_reach_evaluate(self):
        (self.folder / "evaluate").write_text(
            EVALUATE.replace('"contact": cap', '"contact": sys.argv.count("time.dt_s=0.5")'))
        self.run_tune(trials=1, random_trials=0, set=["time.dt_s=0.5"])
        self.assertEqual(self.trials()[0]["contact"], "1")

    def test_seeds_for_reporting_are_refused(self):
        run = self.run_tune(seed=5000000)
        self.assertEqual(run.returncode, 2)
        self.assertRegex(run.stderr, "^tune: .*to the reporting block, but must belong to the choosing block")

    def test_unknown_keys_are_refused(self):
        run = self.run_tune(trails=3)
        self.assertEqual(run.returncode, 2)
        self.assertIn("missing or unknown: trails", run.stderr)

    def test_damaged_files_are_refused_in_one_line(self):
        def refused(what, run):
            self.assertEqual(run.returncode, 2, what)
            self.assertRegex(run.stderr, rf"^tune: [^\n]*{what}[^\n]*\n$")

        for changes in ({"space": {"gain": 3}}, {"space": {"gain": [2.0, "x"]}}, {"start": 3},
                        {"start": [{"gain": "x"}]}, {"scenarios": []}, {"trials": "4"},
                        {"seed": True}, {"score": []}, {"step": [0.1]}, {"controller": 3}, {"set": "x"}, {"finals": {"trials": 1}}):  # fmt: skip
            refused(f"search.yaml: {list(changes)[0]}: is not", self.run_tune(**changes))
        for start, what in (({"gain": 0}, "gain: 0 must be positive"), ({"gian": 1}, "gian is not in")):
            refused(f"search.yaml: start: {what}", self.run_tune(start=[start]))
        refused("search.yaml: start, random", self.run_tune(start=[], random_trials=0))
        refused("score: evaluate does not report joy", self.run_tune(score={"joy": 1.0}))
        file = self.folder / "search.yaml"
        for text, what in (
            (yaml.safe_dump(SEARCH) + "trials: 5\n", r"search.yaml:\d+: trials: duplicate key"),
            ("\n" + "[" * 9999, "search.yaml:2: "),
        ):  # fmt: skip
            file.write_text(text)
            refused(what, self.run_file())
        file.unlink()
        os.mkfifo(file)
        refused("search.yaml: is not a regular file", self.run_file())

    def test_a_flight_that_fails_is_told_in_one_line(self):
        (self.folder / "evaluate").write_text("#!/bin/sh\necho why >&2\nexit 3\n")
        run = self.run_tune()
        self.assertEqual(run.returncode, 2)
        self.assertRegex(run.stderr, r"^tune: pursuit on medium nominal: exit status 3 \(log: [^\n]*\)\n$")

    def test_shipped_searches_name_choosing_seeds_and_constants_of_their_space(self):
        files = sorted((PACKAGE / "studies" / "search").glob("*.yaml"))
        files = [file for file in files if "controller" in yaml.safe_load(file.read_text())]
        self.assertGreaterEqual(len(files), 4)
        for file in files:
            search = yaml.safe_load(file.read_text())
            self.assertEqual(set(search) - {"set", "finals"}, set(SEARCH), file)
            self.assertLess(search["seed"] + search["episodes"], 1000000, file)
            finals = search.get("finals", search)
            self.assertLess(finals["seed"] + finals["episodes"], 1000000, file)
            for values in search["start"]:
                self.assertLessEqual(set(values), set(search["space"]), file)


if __name__ == "__main__":
    unittest.main()
