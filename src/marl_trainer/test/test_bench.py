"""Tests of the benchmark script. Stand-ins replace the programs that it runs."""

import json
import os
import subprocess
import tempfile
import unittest

HERE = os.path.dirname(os.path.realpath(__file__))
BENCH = os.path.join(HERE, "..", "..", "..", "scripts", "bench", "bench.py")

import stub_programs


class Bench(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.out = os.path.join(self.folder, "results", "bench.json")
        stub_programs.write_stubs(self.folder)

    def bench(self, *arguments):
        done = subprocess.run(
            [BENCH, "--bin", self.folder, "--out", self.out, *(["--no-ros"] if "--only" not in arguments else []), *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            check=False,
        )
        return done.returncode, done.stdout

    def test_report_and_file_hold_what_the_programs_measured(self):
        status, output = self.bench(
            *("--seeds", "0,1", "--workers", "2", "--seconds", "0.5", "--algorithms", "ippo,maddpg")
        )
        self.assertEqual(status, 0, output)
        with open(self.out, encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(report["environment"]["release_truth"]["env_steps_per_second"], 1000.0)
        self.assertEqual(report["environment"]["acoustic_scaling"]["scaling"][0]["agents"], 100)
        self.assertEqual(report["training"]["1"]["time_to_threshold"]["1030"]["seconds"], 70.0)
        # Seed 0 takes 50 s, and seed 1 takes 70 s. The update of the stand-ins takes 7.5 of 12.5 s.
        self.assertIn("in under 60 s: 1 of 2 seeds", output)
        self.assertIn("update 60 %", output)
        self.assertIn("(25 %)", output)
        train = [c for c in stub_programs.calls(self.folder) if c.startswith("train ")]
        self.assertEqual(len(train), 4)
        self.assertIn("--scenario medium_release --preset fast --seed 1 --workers 2", train[1])
        self.assertIn("--seed 0 --workers 2", train[3])
        self.assertIn("--algorithm maddpg", train[3])
        self.assertEqual(
            report["algorithms"]["ippo"]["time_to_threshold"]["1030"]["seconds"], 50.0
        )
        self.assertRegex(output, r"maddpg +3\.0 ")

    def test_one_algorithm_alone_and_one_that_never_gets_there(self):
        status, output = self.bench(
            *("--only", "algorithms", "--algorithms", "madqn,matd3", "--seeds", "3")
        )
        self.assertEqual(status, 0, output)
        calls = stub_programs.calls(self.folder)
        self.assertEqual([c.split()[0] for c in calls], ["train", "train"])
        self.assertIn("--algorithm madqn --reward own --gamma 0.8", calls[0])
        self.assertNotIn("--gamma", calls[1])
        self.assertIn("madqn: with --reward own --gamma 0.8", output)
        with open(self.out, encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(list(report["algorithms"]), ["madqn", "matd3"])
        self.assertNotIn("environment", report)
        self.assertIsNone(report["algorithms"]["madqn"]["time_to_threshold"]["1030"])
        self.assertIn("madqn: never 1030 without a loss in 1,000 steps; best return 1041.5", output)
        self.assertNotIn("matd3: never", output)

    def test_missing_program_is_named(self):
        os.remove(os.path.join(self.folder, "bench_env"))
        status, output = self.bench("--seeds", "")
        self.assertEqual(status, 1)
        self.assertIn("bench: bench_env is not built", output)
        self.assertFalse(os.path.exists(self.out))

    def test_options_that_no_chosen_part_reads_are_refused(self):
        for arguments, reason in (
            (("--only", "environment", "--seeds", "1"), "--seeds has no effect with --only environment"),
            (("--only", "training", "--algorithms", "ippo"), "--algorithms has no effect with --only training"),
            (("--only", "algorithms", "--seconds", "1"), "--seconds has no effect with --only algorithms"),
            (("--only", "training", "--no-ros"), "--no-ros has no effect with --only training"),
            (("--only", "ros"), "--bin has no effect with --only ros"),
            (("--seeds", "", "--steps", "9"), "--steps has no effect, because --seeds is empty"),
        ):
            status, output = self.bench(*arguments)
            self.assertEqual(status, 2, output)
            self.assertIn(reason, output)
        self.assertFalse(os.path.exists(self.out))

    def test_failing_program_is_an_error(self):
        with open(os.path.join(self.folder, "train"), "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\nexit 3\n")
        status, output = self.bench("--seeds", "0")
        self.assertEqual(status, 1)
        self.assertIn("exit status 3", output)


if __name__ == "__main__":
    unittest.main()
