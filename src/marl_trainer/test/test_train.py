"""The train command as a user runs it: it is interrupted, resumed and refused."""

import csv
import hashlib
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

import roslib.packages


import hangups

# Five environments, because four have the same condition of a mix.
SMALL = ["--scenario", "medium_release", "--envs", "5", "--horizon", "20", "--minibatch", "100",
         "--actor-hidden", "8", "--critic-hidden", "8", "--workers", "1"]


class Train(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_folder = pathlib.Path(folder.name) / "run"
        (self.program,) = roslib.packages.find_node("marl_trainer", "train")

    def start(self, *options, **streams):
        """Starts a training in the run's folder."""
        process = subprocess.Popen(
            [self.program, "--out", str(self.run_folder), *SMALL, *options],
            universal_newlines=True,
            **{"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, **streams})
        self.addCleanup(process.kill)
        return process

    def train(self, *options):
        """Runs a whole training; returns its exit status and output."""
        process = self.start(*options)
        output, _ = process.communicate(timeout=60)
        return process.returncode, output

    def steps(self):
        """Returns the environment steps of the rows of the progress file."""
        file = self.run_folder / "progress.csv"
        with open(file, encoding="utf-8", newline="") as rows:
            return [int(row["env_steps"]) for row in csv.DictReader(rows)]

    def test_interrupted_it_saves_and_resume_goes_on(self):
        process = self.start("--steps", "100000000")
        self.wait_for_rows(process)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, output)
        before = self.steps()
        self.assertIn(f"stopped at {before[-1]} steps and saved; --resume continues", output)
        self.assertTrue((self.run_folder / "policy_last.onnx").exists())

        status, output = self.train("--resume", "--steps", str(before[-1] + 1000))
        self.assertEqual(status, 0, output)
        after = self.steps()
        self.assertEqual(after[:len(before)], before)
        self.assertEqual(after[len(before):], list(range(before[-1] + 100, after[-1] + 1, 100)))
        self.assertEqual(after[-1], before[-1] + 1000)
        summary = json.loads((self.run_folder / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(summary["stopped"], "finished")

    def test_the_pages_say_truly_what_chooses_a_checkpoint_and_which_return_is_which(self):
        """Checks what report.CONVENTIONS says of returns and checkpoints with the programs themselves: a
        training on another reward, and its evaluation."""
        status, output = self.train("--steps", "2000", "--variant", "tau6", "--validation-interval", "200",
                                    "--validation-episodes", "2")  # fmt: skip
        self.assertEqual(status, 0, output)
        with open(self.run_folder / "progress.csv", encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["validation_return"]]
        self.assertGreater(len(rows), 5)
        best = max(rows, key=lambda row: float(row["validation_return"]))
        with open(self.run_folder / "policy_best.onnx", "rb") as file:
            kept = file.read()
        # The name of the policy ends with the step at which it was saved.
        self.assertIn(f"-seed0-{best['env_steps']}".encode(), kept)
        self.assertNotEqual(best["validation_return"], best["validation_scenario_return"])

        (evaluate,) = roslib.packages.find_node("marl_trainer", "evaluate")
        done = {}
        # The episodes of the validation, once with the reward of the scenario and once with the one of the
        # variant. They are flown as without the name of a variant.
        for reward in ("paper", "release"):
            command = [evaluate, "--policy", str(self.run_folder / "policy_best.onnx"), "--scenario",
                       "medium_release", "--variant", "tau6", "--episodes", "2", "--seed", "900000",
                       "--set", f"reward.kind={reward}"]  # fmt: skip
            text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
            done[reward] = json.loads(text.splitlines()[-1])
        self.assertEqual(done["release"]["seed_block"], "choosing")
        # The reward of the scenario gives `return`, whatever the variant trains with ...
        self.assertNotEqual(done["paper"]["return"], done["release"]["return"])
        # ... and does not change `training_return`, which is the return of the validation.
        self.assertEqual(done["paper"]["training_return"], done["release"]["training_return"])
        self.assertAlmostEqual(done["release"]["training_return"], float(best["validation_return"]),
                               delta=0.01 * abs(float(best["validation_return"])))  # fmt: skip
        self.assertAlmostEqual(done["release"]["return"], float(best["validation_scenario_return"]),
                               delta=0.01 * abs(float(best["validation_scenario_return"])))  # fmt: skip

    def wait_for_rows(self, process):
        """Waits until a training has written three collections."""
        end = time.monotonic() + 30
        while process.poll() is None and time.monotonic() < end:
            if (self.run_folder / "progress.csv").exists() and len(self.steps()) > 2:
                break
            time.sleep(0.05)

    def test_a_closed_terminal_makes_it_save(self):
        ours, terminal = os.openpty()
        process = self.start("--steps", "100000000", start_new_session=True, stdout=terminal,
                             preexec_fn=hangups.takes(terminal))
        os.close(terminal)
        self.wait_for_rows(process)
        os.close(ours)
        process.send_signal(signal.SIGHUP)  # the shell sends it, too
        self.assertEqual(process.wait(timeout=30), 130)
        status, output = self.train("--resume", "--steps", str(self.steps()[-1] + 100))
        self.assertEqual(status, 0, output)

    def test_a_hangup_that_nohup_ignores_is_ignored(self):
        process = self.start("--steps", "100000000", preexec_fn=hangups.ignore)
        self.wait_for_rows(process)
        self.assertTrue(hangups.ignored_by(process.pid))
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)

    def test_two_in_one_folder(self):
        first = self.start("--steps", "100000000")
        self.wait_for_rows(first)
        for options in ((), ("--resume",)):
            status, output = self.train(*options)
            self.assertEqual(status, 2, output)
            self.assertEqual(
                output, f"train: {self.run_folder}: another program is writing into it\n")
        first.kill()  # this also frees its lock
        first.communicate(timeout=30)
        # The second run is refused, or begins anew if nothing was saved. In both cases it gets the folder.
        _, output = self.train("--steps", "100")
        self.assertNotIn("another program", output)

    def test_special_files_in_the_folder_do_not_hang_it(self):
        status, output = self.train("--steps", "200")
        self.assertEqual(status, 0, output)
        for name in ("config.json", "scenario.yaml", "progress.csv"):
            path = self.run_folder / name
            content = path.read_bytes()
            for make in (os.mkfifo, lambda path: os.symlink("/dev/zero", path)):
                path.unlink()
                make(path)
                status, output = self.train("--resume", "--steps", "400")
                self.assertEqual(status, 2, output)
                self.assertEqual(output, f"train: {path}: not a regular file\n")
            path.unlink()
            path.write_bytes(content)

    def test_a_configuration_that_was_damaged_is_told_by_file_and_key(self):
        status, output = self.train("--steps", "200")
        self.assertEqual(status, 0, output)
        path = self.run_folder / "config.json"
        good = json.loads(path.read_text(encoding="utf-8"))
        for key, value in (("envs", 1e300), ("envs", 0.5), ("steps", -1), ("lr", -1.0),
                           ("gamma", None), ("actor-hidden", [8.5]), ("algorithm", 3)):
            path.write_text(json.dumps({**good, key: value}), encoding="utf-8")
            status, output = self.train("--resume", "--steps", "400")
            self.assertEqual(status, 2, output)
            self.assertRegex(output, f"^train: {path}: .*{key}: .*\n$")

    def test_a_full_disk_under_the_output_is_no_success(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            process = self.start("--steps", "200", stdout=full, stderr=subprocess.PIPE)
            _, errors = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("standard output cannot be written", errors)
        self.assertTrue((self.run_folder / "policy_last.onnx").exists())

    def test_resume_takes_configuration_and_seed_from_the_folder(self):
        status, output = self.train("--steps", "400", "--seed", "7", "--gamma", "0.8",
                                    "--train-on", "nominal,fast_target", "--set",
                                    "reward.weights.separation=0.3")
        self.assertEqual(status, 0, output)
        before = self.state()
        resumed = subprocess.run(
            [self.program, "--resume", "--out", str(self.run_folder), "--steps", "650"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)
        self.assertEqual(resumed.returncode, 0, resumed.stdout)
        self.assertEqual(self.steps(), [100, 200, 300, 400, 500, 600, 700])
        after = self.state()
        self.assertEqual(after.pop("config.json"), dict(before.pop("config.json"), steps=650))
        self.assertEqual(after, before)
        self.assertEqual(len(after), 3)
        # A run with more steps than it was asked for still shows 100 %.
        shown = re.findall(r"([0-9.]+)% +[0-9]+ steps", resumed.stdout)
        self.assertEqual(shown[-1], "100.0", resumed.stdout)

    def state(self):
        """Returns what the files of the folder say of the run."""
        files = {path.name: path.read_text(encoding="utf-8")
                 for path in [*self.run_folder.glob("*.yaml"), self.run_folder / "config.json"]}
        return {name: json.loads(text) if name.endswith("json") else text
                for name, text in files.items()}

    def test_resume_says_what_is_missing(self):
        status, output = self.train("--resume")
        self.assertEqual(status, 2, output)
        self.assertIn("no run to resume: it has no config.json", output)
        self.assertFalse(self.run_folder.exists())
        self.run_folder.mkdir()
        (self.run_folder / "config.json").write_text("[]", encoding="utf-8")
        status, output = self.train("--resume")
        self.assertEqual(status, 2, output)
        self.assertIn("config.json: not the configuration of a training", output)

    def test_another_configuration_is_refused_by_name_and_nothing_is_lost(self):
        status, output = self.train("--steps", "300")
        self.assertEqual(status, 0, output)

        def contents():
            return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()
                    for path in self.run_folder.iterdir()}

        before = contents()
        for options, reason in (
                (("--resume", "--gamma", "0.8"), "--gamma is 0.8"),
                (("--resume", "--set", "reward.weights.separation=0.3"), "the scenario differs from"),
                ((), "holds another run"),
                (("--resume", "--lr", "-1"), "--lr")):
            status, output = self.train("--steps", "600", *options)
            self.assertEqual(status, 2, output)
            self.assertIn(reason, output)
        self.assertEqual(contents(), before)


if __name__ == "__main__":
    unittest.main()
