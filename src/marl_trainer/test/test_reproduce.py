"""Tests of the reproduce command with stand-ins for the programs it runs."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))

import stub_programs  # noqa: E402
from study_case import StudyCase  # noqa: E402


class Reproduce(StudyCase):
    def test_whole_study_then_nothing_to_do_then_only_what_is_missing(self):
        status, output, calls = self.reproduce_all()
        self.assertEqual(status, 0, output)
        self.assertEqual(sum(c.startswith("train ") for c in calls), 4)
        self.assertEqual(sum(c.startswith("evaluate ") for c in calls), 16)
        self.assertIn("\n20/20 jobs (100 %), 0 failed\n", output)

        # 2 conditions x (2 methods + 2 controllers) x 2 seeds, 4 episodes, all metrics.
        self.assertEqual(len(self.rows("episodes.csv.gz")), 64)
        self.assertEqual(len(self.rows("results.csv")), 16 * len(stub_programs.METRICS))
        self.assertEqual(len(self.rows("curves.csv")), 4 * 20)
        self.assertEqual([r["seconds_to_no_loss"] for r in self.rows("runs.csv")], ["3"] * 4)
        page = self.read("medium_release.md")
        for table in ("Table 1:", "Table S3:", "Table S4:", "Table S7:", "Table S9:"):
            self.assertIn(table, page)
        self.assertIn("| STG-MAPPO (paper) | Combined stress | 1002.0 ± 44.1 |", page)
        for name in ("convergence", "final_stage", "final_boxes", "ablation", "per_seed",
                     "reward_components", "stress"):  # fmt: skip
            for end in (".png", ".svg"):
                path = self.path("figures", f"{name}_medium_release{end}")
                self.assertGreater(os.path.getsize(path), 5000, path)
            self.assertIn(f"figures/{name}_medium_release.png", page)

        status, output, calls = self.reproduce()
        self.assertEqual((status, calls), (0, []), output)

        os.remove(self.path("work/evaluations/medium_release/nominal/pursuit_seed1.json"))
        with open(self.path("work/evaluations/medium_release/nominal/simple_seed0.csv"), "a") as f:
            f.write("a row too many\n")
        status, output, calls = self.reproduce()
        self.assertEqual(status, 0, output)
        self.assertEqual(sorted(c.split()[2] for c in calls), ["pursuit", "pursuit"])

        before = {name: self.read(name) for name in ("report.md", "medium_release.md")}
        for name in before:
            os.remove(self.path(name))
        shutil.rmtree(self.path("work"))
        status, output, calls = self.reproduce_all("--report-only")
        self.assertEqual((status, calls), (0, []), output)
        self.assertEqual({name: self.read(name) for name in before}, before)

    def test_command_lines_keep_seeds_and_overrides_apart(self):
        self.assertEqual(self.reproduce("--methods", "tau6", "--seeds", "1")[0], 0)
        shutil.rmtree(self.path("work"))
        _, _, calls = self.reproduce("--methods", "tau6", "--seeds", "1")
        train = [c for c in calls if c.startswith("train ")]
        self.assertEqual(len(train), 1)
        self.assertIn("--preset fast --variant tau6 --seed 1 --steps 1000", train[0])
        self.assertIn("--set a.b=1 --set reward.c=2", train[0])
        self.assertIn("--workers 1", train[0])
        for call in calls:
            if call.startswith("evaluate "):
                self.assertIn("--episodes 4 --seed 13000", call)
                self.assertNotIn("reward.c=2", call)
                policy = "policy_best.onnx" in call
                self.assertEqual("--variant tau6 --set a.b=1" in call, policy)
                self.assertNotIn("--resume", call)

    def test_changed_policy_is_evaluated_again(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        with open(self.path("work/runs/medium_release/stg/seed0/policy_best.onnx"), "w") as file:
            file.write("0.5 0")
        _, _, calls = self.reproduce("--methods", "stg", "--seeds", "0")
        self.assertEqual([c.split()[0] for c in calls], ["evaluate"] * 2)

    def test_runs_of_other_options_and_foreign_folders_are_refused(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        status, output, calls = self.reproduce("--methods", "stg", "--seeds", "0", "--steps", "77")
        self.assertEqual((status, calls), (2, []))
        self.assertIn("trained with other options", output)
        foreign = self.path("work/runs/medium_release/stg/seed1")
        os.makedirs(foreign)
        open(os.path.join(foreign, "thesis.txt"), "w").close()
        status, output, calls = self.reproduce("--methods", "stg", "--seeds", "1")
        self.assertEqual((status, calls), (2, []))
        self.assertTrue(os.path.exists(os.path.join(foreign, "thesis.txt")))

    def test_failed_training_is_named_and_the_rest_goes_on(self):
        status, output, calls = self.reproduce(STUB_FAIL="tau6/seed1")
        self.assertEqual(status, 1, output)
        self.assertIn("FAILED: train medium_release tau6 seed 1", output)
        self.assertIn("this stub fails", output)
        self.assertIn("3 jobs are missing in the results", output)
        self.assertEqual(len(self.rows("runs.csv")), 3)
        status, output, calls = self.reproduce()
        self.assertEqual(status, 0, output)
        self.assertEqual(sorted(c.split()[0] for c in calls), ["evaluate", "evaluate", "train"])

    def test_interrupted_training_saves_and_is_resumed(self):
        process = subprocess.Popen(
            self.command("--methods", "stg", "--seeds", "0"),
            env=dict(os.environ, STUB_SLEEP="60"),
            stdout=subprocess.PIPE,
            universal_newlines=True,
        )
        run = self.path("work/runs/medium_release/stg/seed0")
        deadline = time.monotonic() + 60.0
        while not os.path.exists(os.path.join(run, "sleeping")):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, output)
        self.assertIn("the same command goes on", output)
        self.assertTrue(os.path.exists(os.path.join(run, "checkpoint_000000000001.ckpt")))
        stub_programs.calls(self.folder)
        status, output, calls = self.reproduce("--methods", "stg", "--seeds", "0")
        self.assertEqual(status, 0, output)
        train = [c for c in calls if c.startswith("train ")]
        self.assertEqual([c.endswith("--resume") for c in train], [True])

    def test_mistakes_on_the_command_line_end_with_status_2(self):
        for arguments in (
            ["--methods", "no_such"],
            ["--seeds", "0,x"],
            ["--seeds", "1,1"],
            ["--bin", os.path.join(self.folder, "nowhere")],
            ["--study", "nowhere.yaml"],
        ):
            status, output, calls = self.reproduce(*arguments)
            self.assertEqual((status, calls), (2, []), output)
            self.assertIn("reproduce: ", output)

    def test_report_is_made_of_what_is_there(self):
        """A missing training leaves dashes, and the report says nothing of it as if measured."""
        status, output, _ = self.reproduce_all("--no-training")
        self.assertEqual(status, 0, output)
        page = self.read("medium_release.md")
        row = next(line for line in page.splitlines() if line.startswith("| STG-MAPPO | –"))
        self.assertEqual(set(row.split(" | ")[1:]) - {"– |"}, {"–"})
        self.assertIn("| pursuit (tuned) |", page)
        self.assertNotIn("convergence", page)

    def test_results_folder_is_ignored_by_git_where_it_holds_runs(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        self.assertEqual(self.read("work", ".gitignore"), "*\n")
        with open(self.path("work/evaluations/medium_release/nominal/pursuit_seed0.json")) as file:
            self.assertIn("--seed 3000", " ".join(json.load(file)["identity"]["arguments"]))


if __name__ == "__main__":
    unittest.main()
