"""Shared by the tests of the reproduce command."""

import os
import shutil
import subprocess
import tempfile
import unittest

import stub_programs

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
from stg_study.collect import read_rows

REPRODUCE = os.path.join(PACKAGE, "scripts", "reproduce")

STUDY = """
name: sample
title: A sample
seeds: [0, 1]
steps: 1000
episodes: 4
scenarios: [{name: medium_release, paper: medium}]
conditions: [nominal, combined_stress]
methods:
  - {name: stg, label: STG-MAPPO, paper: STG-MAPPO, ablation: STG-MAPPO-full}
  - {name: tau6, label: raw, variant: tau6, set: ["a.b=1"], train_set: ["reward.c=2"]}
controllers:
  - {name: pursuit, label: pursuit (tuned), policy: pursuit}
  - {name: simple, label: pursuit (simple), policy: pursuit, arguments: ["--gain", "2"]}
"""


class StudyCase(unittest.TestCase):
    """A folder with stand-ins and a study, and the reproduce command for it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        stub_programs.write_stubs(self.folder)
        self.study = os.path.join(self.folder, "study.yaml")
        with open(self.study, "w", encoding="utf-8") as file:
            file.write(STUDY)
        self.out = os.path.join(self.folder, "out")

    def command(self, *arguments):
        runs = [] if "--report-only" in arguments else ["--bin", self.folder, "--jobs", "2"]
        return ["/usr/bin/python3", REPRODUCE, "--study", self.study, "--out", self.out,
                *runs, *arguments]  # fmt: skip

    def reproduce(self, *arguments, **environment):
        """Runs the command without a report; returns (status, output, command lines of the stubs)."""
        return self.reproduce_all("--no-report", *arguments, **environment)

    def reproduce_all(self, *arguments, **environment):
        done = subprocess.run(
            self.command(*arguments),
            env=dict(os.environ, **environment),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            check=False,
        )
        return done.returncode, done.stdout, stub_programs.calls(self.folder)

    def refused(self, what, *arguments):
        """Expects that the command ends in one line that says `what`."""
        status, output, calls = self.reproduce_all(*arguments)
        self.assertEqual((status, calls), (2, []), output)
        self.assertRegex(output.splitlines()[-1], f"^reproduce: .*{what}")
        self.assertNotIn("Traceback", output)

    def path(self, *parts):
        return os.path.join(self.out, *parts)

    def read(self, *parts):
        with open(self.path(*parts), encoding="utf-8") as file:
            return file.read()

    def read_bytes(self, *parts):
        with open(self.path(*parts), "rb") as file:
            return file.read()

    def rows(self, name):
        return read_rows(self.path(name))
