"""Tests of the reproduce command. Stand-ins replace the programs that it runs."""

import gzip
import json
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import time
import unittest


import hangups
import stub_programs
from study_case import STUDY, StudyCase
from stg_study.files import locked
from stg_study.jobs import plan
from stg_study.study import load_study
from stg_study.data import Results
from stg_common.files import FileError


class Reproduce(StudyCase):
    def test_whole_study_then_nothing_to_do_then_only_what_is_missing(self):
        status, output, calls = self.reproduce_all()
        self.assertEqual(status, 0, output)
        self.assertEqual(sum(c.startswith("train ") for c in calls), 4)
        self.assertEqual(sum(c.startswith("evaluate ") for c in calls), 16)
        self.assertIn("\n20/20 jobs (100 %), 0 failed\n", output)

        # 2 conditions x (2 methods + 2 controllers) x 2 seeds, 4 episodes, all metrics.
        self.assertEqual(len(self.rows("episodes.csv.gz")), 64)
        self.assertEqual(len(self.rows("results.csv")), 16 * (len(stub_programs.METRICS) + 1))
        self.assertEqual(len(self.rows("curves.csv")), 4 * 20)
        self.assertEqual([r["seconds_to_no_loss"] for r in self.rows("runs.csv")], ["3"] * 4)
        page = self.read("medium_release.md")
        for table in ("Table 1:", "Table S3:", "Table S4:", "Table S7:", "Table S9:"):
            self.assertIn(table, page)
        self.assertIn("| STG-MAPPO (paper) | Combined stress | 1002.0 ± 44.1 |", page)
        for name in ("convergence", "final_stage", "final_boxes", "ablation", "per_seed",
                     "reward_components", "stress"):  # fmt: skip
            path = self.path("figures", f"{name}_medium_release.png")
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
                self.assertIn("--episodes 4 --seed 5010000", call)
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

    def start(self, *arguments, **options):
        """Starts the command and waits until its training sleeps; returns the process and the run's
        folder."""
        process = subprocess.Popen(
            self.command("--methods", "stg", "--seeds", "0", *arguments),
            env=dict(os.environ, STUB_SLEEP="60"),
            universal_newlines=True,
            **{"stdout": subprocess.PIPE, **options},
        )
        self.addCleanup(process.kill)
        run = self.path("work/runs/medium_release/stg/seed0")
        deadline = time.monotonic() + 60.0
        while not os.path.exists(os.path.join(run, "sleeping")):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        return process, run

    def test_interrupted_training_saves_and_is_resumed(self):
        process, run = self.start()
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, output)
        self.assertIn("the same command continues", output)
        self.assertTrue(os.path.exists(os.path.join(run, "checkpoint_000000000001.ckpt")))
        stub_programs.calls(self.folder)
        status, output, calls = self.reproduce("--methods", "stg", "--seeds", "0")
        self.assertEqual(status, 0, output)
        train = [c for c in calls if c.startswith("train ")]
        self.assertEqual([c.endswith("--resume") for c in train], [True])

    def test_a_closed_terminal_stops_it_as_ctrl_c_does(self):
        ours, terminal = os.openpty()
        process, run = self.start(
            start_new_session=True,
            stdin=terminal,
            stdout=terminal,
            stderr=subprocess.STDOUT,
            preexec_fn=hangups.takes(terminal),
        )
        os.close(terminal)
        os.close(ours)  # its output now has nowhere to go
        # The signal does not end it at once. It waits until the training has saved.
        self.assertGreater(process.wait(timeout=60), 0)
        self.assertTrue(os.path.exists(os.path.join(run, "checkpoint_000000000001.ckpt")))

    def test_a_hangup_that_nohup_ignores_is_ignored(self):
        process, _ = self.start(preexec_fn=hangups.ignore)
        self.assertTrue(hangups.ignored_by(process.pid))
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)

    def test_a_second_one_in_the_same_folder_is_refused(self):
        process, _ = self.start()
        stub_programs.calls(self.folder)
        status, output, calls = self.reproduce("--methods", "stg", "--seeds", "0")
        self.assertEqual((status, calls), (1, []), output)
        self.assertEqual(
            output, f"reproduce: {self.path('work')}: another program is writing into it\n"
        )
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)

    def test_a_run_that_another_program_writes_into_is_not_removed(self):
        training = plan(load_study(self.study), self.path("work"), self.folder)[0][0]
        os.makedirs(training.folder)
        with locked(training.folder):
            with self.assertRaisesRegex(OSError, "another program is writing into it"):
                training.prepare()
            self.assertTrue(os.path.isdir(training.folder))
        training.prepare()

    def test_a_full_disk_is_told_with_the_file(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))  # noqa: E731
        done = subprocess.run(
            self.command("--methods", "stg", "--seeds", "0", "--no-report"),
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True,
            preexec_fn=limit, check=False,
        )  # fmt: skip
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stderr, f"reproduce: {self.path('study.yaml')}: File too large\n")
        self.assertIn("medium_release", self.read("study.yaml"))

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
        """A missing training leaves dashes. The report does not show it as measured."""
        status, output, _ = self.reproduce_all("--no-training")
        self.assertEqual(status, 0, output)
        page = self.read("medium_release.md")
        row = next(line for line in page.splitlines() if line.startswith("| STG-MAPPO | –"))
        self.assertEqual(set(row.split(" | ")[1:]) - {"– |"}, {"–"})
        self.assertIn("| pursuit (tuned) |", page)
        self.assertNotIn("convergence", page)

    def test_damaged_studies_are_refused_in_one_line(self):
        for text, what in (
            (STUDY + "steps: 7\n", rf"study.yaml:{STUDY.count(chr(10)) + 1}: steps: duplicate key"),
            ("a: \xff", "study.yaml:1: is not text"),
            ("\n" + "[" * 9999, "study.yaml:2: nested too deeply"),
            ("name: 2026-99-99\n", "study.yaml:1: this value"),
            (" " * 2000000, "study.yaml: has 2000000 bytes"),
        ):
            with open(self.study, "w", encoding="latin-1") as file:
                file.write(text)
            self.refused(what)
        os.remove(self.study)
        os.mkfifo(self.study)
        self.refused("study.yaml: is not a regular file")

    def test_damaged_runs_are_refused_in_one_line(self):
        only = ("--methods", "stg", "--seeds", "0")
        self.assertEqual(self.reproduce(*only)[0], 0)
        run = "work/runs/medium_release/stg/seed0"
        evaluation = "work/evaluations/medium_release/nominal/pursuit_seed0"
        summary = json.loads(self.read(run, "summary.json"))
        found = json.loads(self.read(evaluation + ".json"))
        for name, content, what in (
            (f"{run}/summary.json", [], "summary.json: is not an object"),
            (f"{run}/summary.json", {**summary, "env_steps": "1000"}, "env_steps: is not a finite"),
            (f"{run}/summary.json", {**summary, "wall_seconds": []}, "wall_seconds: is not a finite"),
            (f"{run}/summary.json", {**summary, "parameters": [1]}, "parameters: is not an object"),
            (f"{run}/summary.json", {**summary, "time_to_threshold": {"1000": 3}}, "1000: is not an"),
            (f"{run}/config.json", [1], "config.json: is not an object"),
            (f"{run}/config.json", {"lr": [[1]]}, "config.json: lr: must be a value"),
            (f"{run}/study_job.json", {"arguments": [1]}, "arguments: is not a text"),
            (f"{evaluation}.json", [found], "pursuit_seed0.json: is not an object"),
            (f"{evaluation}.json", {**found, "summary": 1}, "summary: is not an object"),
            (f"{evaluation}.json", {**found, "summary": {}}, "return: missing"),
        ):
            whole = self.read(name)
            with open(self.path(name), "w", encoding="utf-8") as file:
                json.dump(content, file)
            self.refused(what, "--no-report", *only)
            with open(self.path(name), "w", encoding="utf-8") as file:
                file.write(whole)
        os.mkfifo(self.path("fifo"))
        os.replace(self.path("fifo"), self.path(run, "config.json"))
        self.refused("config.json: is not a regular file", "--no-report", *only)

    def test_damaged_results_are_refused_in_one_line(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        names = ("episodes.csv.gz", "curves.csv", "runs.csv", "options.csv")
        whole = {name: self.read_bytes(name) for name in names}
        curves = whole["curves.csv"].decode()
        episodes = gzip.decompress(whole["episodes.csv.gz"])
        for name, content, what in (
            ("episodes.csv.gz", whole["episodes.csv.gz"][:-200], r"episodes.csv.gz:\d+: damaged"),
            ("episodes.csv.gz", episodes, "episodes.csv.gz:1: damaged"),
            ("episodes.csv.gz", gzip.compress(episodes.replace(b",return,", b",gain,")),
             "episodes.csv.gz:1: no column return"),
            ("episodes.csv.gz", gzip.compress(episodes.replace(b"nominal,stg,0,", b"nominal,stg,x,")),
             r"episodes.csv.gz:\d+: seed: 'x'"),
            ("curves.csv", curves.replace("stg,0,100,", "stg,0,100,many,", 1), r"curves.csv:\d+: "),
            ("curves.csv", curves.replace("stg,0,100,", "stg,0,many,", 1), "env_steps: 'many'"),
            ("curves.csv", b"\xff\n", "curves.csv:1: is not text"),
            ("runs.csv", "a,b\n", "runs.csv:1: no column scenario"),
            ("options.csv", "method,option,value\nstg,lr\n", "options.csv:2: 2 cells"),
        ):
            with open(self.path(name), "wb") as file:
                file.write(content if isinstance(content, bytes) else content.encode())
            with self.assertRaisesRegex(FileError, what):
                Results(self.out).scores("medium_release", "nominal", "stg", "return")
            with open(self.path(name), "wb") as file:
                file.write(whole[name])
        with open(self.path("curves.csv"), "w", encoding="utf-8") as file:
            file.write(curves.replace(",tail_distance", ",distance"))
        self.refused("curves.csv:1: no column tail_distance", "--report-only")

    def test_reports_of_less_than_the_study_asks_for(self):
        """Results lack a seed, a condition, or a validation that two seeds have in common."""
        self.assertEqual(self.reproduce()[0], 0)
        episodes = gzip.decompress(self.read_bytes("episodes.csv.gz")).decode().splitlines(True)
        curves = self.read("curves.csv").splitlines(True)
        few = [line for line in episodes if "combined_stress" not in line and ",pursuit,0," not in line]
        apart = [line for k, line in enumerate(curves) if not k or k % 2 == int(line.split(",")[2])]
        for rows in (few, episodes[:1]):
            with open(self.path("episodes.csv.gz"), "wb") as file:
                file.write(gzip.compress("".join(rows).encode()))
            with open(self.path("curves.csv"), "w", encoding="utf-8") as file:
                file.writelines(apart)
            status, output, _ = self.reproduce_all("--report-only")
            self.assertEqual(status, 0, output)
            page = self.read("medium_release.md")
            seeds = re.findall(r"^\| pursuit \(tuned\) \| (\d+) \| – \|", page, re.MULTILINE)
            self.assertEqual(seeds, ["1"] if rows is few else [])

    def test_labels_that_cannot_be_drawn_are_refused(self):
        self.assertEqual(self.reproduce("--no-training")[0], 0)
        text = self.read("study.yaml").replace("label: STG-MAPPO", "label: $\\frac{$")
        with open(self.path("study.yaml"), "w", encoding="utf-8") as file:
            file.write(text)
        self.refused(r"study.yaml: methods.stg.label: ", "--report-only")

    def test_a_reader_that_leaves_ends_it_without_a_word(self):
        command = " ".join(map(shlex.quote, self.command("--no-report", "--no-training")))
        run = subprocess.run(
            ["bash", "-c", f"{command} | head -0; exit ${{PIPESTATUS[0]}}"],
            stderr=subprocess.PIPE, universal_newlines=True, check=False,
        )  # fmt: skip
        self.assertEqual((run.returncode, run.stderr), (141, ""))

    def test_results_folder_is_ignored_by_git_where_it_holds_runs(self):
        self.assertEqual(self.reproduce("--methods", "stg", "--seeds", "0")[0], 0)
        self.assertEqual(self.read("work", ".gitignore"), "*\n")
        with open(self.path("work/evaluations/medium_release/nominal/pursuit_seed0.json")) as file:
            self.assertIn("--seed 5000000", " ".join(json.load(file)["identity"]["arguments"]))


if __name__ == "__main__":
    unittest.main()
