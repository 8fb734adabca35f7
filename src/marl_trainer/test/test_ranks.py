"""Tests of the reproduce command over MPI processes."""

import importlib.util
import os
import shutil
import signal
import subprocess
import time
import unittest


import stub_programs
from study_case import StudyCase

MISSING = shutil.which("mpirun") is None or importlib.util.find_spec("mpi4py") is None


@unittest.skipIf(MISSING, "without mpirun or mpi4py")
class Ranks(StudyCase):
    ranks = 2

    def setUp(self):
        super().setUp()
        # mpirun refuses to run as root, and containers run as root.
        for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
            os.environ[name] = "1"

    def command(self, *arguments):
        mine = super().command(*arguments)
        mine[mine.index("--jobs") + 1] = "1"
        launcher = ["mpirun", "--oversubscribe", "-n", str(self.ranks)] if self.ranks else []
        return [*launcher, *mine]

    def parents(self):
        """Returns the processes that started the stubs, and forgets them."""
        path = os.path.join(self.folder, "parents")
        with open(path, encoding="utf-8") as file:
            lines = file.read().split()
        os.remove(path)
        return set(lines)

    def results(self):
        """Returns the names and contents of all files that the study publishes."""
        names = ("results.csv", "curves.csv", "runs.csv", "study.yaml")
        with open(self.path("episodes.csv.gz"), "rb") as file:
            return {"episodes.csv.gz": file.read(), **{name: self.read(name) for name in names}}

    def sleeping(self, process):
        """Waits until two trainings sleep; returns their folders."""
        folders = [self.path(f"work/runs/medium_release/stg/seed{seed}") for seed in (0, 1)]
        deadline = time.monotonic() + 60.0
        while not all(os.path.exists(os.path.join(f, "sleeping")) for f in folders):
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        return folders

    def start(self, *arguments):
        """Starts the command with trainings that sleep."""
        process = subprocess.Popen(
            self.command("--no-report", *arguments),
            env=dict(os.environ, STUB_SLEEP="60"),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
        )
        self.addCleanup(process.stdout.close)
        return process

    def resume(self, folders):
        """Runs the same command again, which continues the trainings."""
        for folder in folders:
            deadline = time.monotonic() + 60.0
            while not os.path.exists(os.path.join(folder, "checkpoint_000000000001.ckpt")):
                self.assertLess(time.monotonic(), deadline, "the training was not interrupted")
                time.sleep(0.05)
        stub_programs.calls(self.folder)
        status, output, calls = self.reproduce("--methods", "stg")
        self.assertEqual(status, 0, output)
        train = [c for c in calls if c.startswith("train ")]
        self.assertEqual([c.endswith("--resume") for c in train], [True, True])

    def test_results_do_not_depend_on_who_does_what(self):
        status, output, calls = self.reproduce()
        self.assertEqual(status, 0, output)
        self.assertIn("2 at a time", output)
        self.assertEqual(len(calls), 20)
        self.assertEqual(len(self.parents()), 2)
        spread = self.results()
        status, output, calls = self.reproduce()
        self.assertEqual((status, calls), (0, []), output)
        shutil.rmtree(self.out)
        self.ranks = 0
        self.assertEqual(self.reproduce()[0], 0)
        self.assertEqual(len(self.parents()), 1)
        self.assertEqual(self.results(), spread)

    def test_failed_training_is_named_and_the_rest_goes_on(self):
        # Two trainings come first. Rank 1 gets the second one.
        status, output, _ = self.reproduce("--no-training")
        self.assertEqual(status, 0, output)
        status, output, _ = self.reproduce(STUB_FAIL="tau6/seed0")
        self.assertEqual(status, 1, output)
        self.assertIn("FAILED: train medium_release tau6 seed 0: exit status 1, on ", output)
        self.assertIn("this stub fails", output)
        self.assertEqual(len(self.rows("runs.csv")), 3)
        status, output, calls = self.reproduce()
        self.assertEqual(status, 0, output)
        self.assertEqual(sorted(c.split()[0] for c in calls), ["evaluate", "evaluate", "train"])

    def test_asked_to_stop_all_trainings_save_and_are_resumed(self):
        process = self.start("--methods", "stg")
        folders = self.sleeping(process)
        process.send_signal(signal.SIGUSR1)  # mpirun passes the signal on to all
        output, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, output)
        self.assertIn("stopped; the same command continues", output)
        self.resume(folders)

    def test_a_lost_rank_ends_the_run_and_its_training_is_resumed(self):
        process = self.start("--methods", "stg")
        folders = self.sleeping(process)
        children = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(process.pid)], stdout=subprocess.PIPE, check=True
        )
        ranks = [int(pid) for pid in children.stdout.split()]
        self.assertEqual(len(ranks), 2)
        os.kill(ranks[1], signal.SIGKILL)
        output, _ = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0, output)
        self.resume(folders)

    def test_mistakes_end_all_ranks(self):
        status, output, calls = self.reproduce("--methods", "no_such")
        self.assertEqual((status, calls), (2, []), output)
        self.assertEqual(output.count("reproduce: --methods: 'no_such'"), 1, output)


if __name__ == "__main__":
    unittest.main()
