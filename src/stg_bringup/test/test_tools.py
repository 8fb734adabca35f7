"""Programs of scripts/ refuse bad input in one line, before they run or write anything."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import stg_common

# In place of roslaunch: it prints what the world says at the end. In the first run in real time it also
# becomes the process of an agent. The stand-in for sleep waits for this process.
ROSLAUNCH = """#!/bin/bash
echo "world: 9 steps in 1.5 s, 2.5 x real time, 1.0 to wrench 1.25 ms (median), 3.75 ms (99 %), \
in time, 0 with a deadline miss"
if [[ "$*" == *real_time_factor:=1* && ! -e "$TMPDIR/agent" ]]; then
  touch "$TMPDIR/agent"
  exec -a "/stg_agent/agent $ROS_HOME" /bin/sleep 4
fi
"""
SLEEP = """#!/bin/bash
until [[ -e "$TMPDIR/agent" ]]; do /bin/sleep 0.1; done
exec /bin/sleep 0.5
"""
SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "scripts"
PYTHON = str(pathlib.Path(stg_common.__file__).resolve().parents[1])


def run(folder, name, *arguments):
    """Runs a program of scripts/ in a folder; returns the finished process. fig6 and joins get the workspace."""
    environment = {"PATH": "/usr/bin:/bin", "HOME": folder, "LC_ALL": "C", "PYTHONPATH": PYTHON}
    if name in ("results/fig6", "results/joins"):
        environment = dict(os.environ)
    program = [str(SCRIPTS / name)] if os.access(SCRIPTS / name, os.X_OK) else [
        sys.executable, str(SCRIPTS / name)]  # fmt: skip
    return subprocess.run([*program, *map(str, arguments)], cwd=folder, env=environment,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True, check=False)  # fmt: skip


class Tools(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name

    def check_refused(self, what, name, *arguments):
        """The last line must say what is wrong. There is a status, no traceback, and no file is left."""
        done = run(self.folder, name, *arguments)
        with self.subTest(program=name, arguments=arguments):
            self.assertIn(done.returncode, (1, 2), done.stderr)
            self.assertNotIn("Traceback", done.stderr)
            self.assertRegex((done.stderr.splitlines() or [""])[-1], what)
            self.assertEqual(os.listdir(self.folder), [])

    def test_arguments_that_cannot_work_are_refused_before_anything_is_run(self):
        self.check_refused("no 'foo' is shipped.*medium", "bench/soak", "--scenario", "foo")
        for hours in ("nan", "-1", "0"):
            self.check_refused("--hours.*positive", "bench/soak", "--hours", hours)
        self.check_refused("--every.*positive", "bench/soak", "--every", "-1")
        self.check_refused("none/x.csv: No such", "bench/soak", "--out", "none/x.csv")
        self.check_refused("--steps.*1 or more", "bench/bench.py", "--steps", "0")
        self.check_refused("nothing to do", "bench/bench.py", "--only", "ros", "--no-ros")
        self.check_refused("--out: /proc cannot be written", "bench/bench.py", "--out", "/proc")
        self.check_refused("--fix has no effect on words", "lint/__main__.py", "--build", ".", "words", "--fix")
        self.check_refused("required.*--build", "test/fuzz.py", "packet", "1")
        self.check_refused("no packages", "lint/draw_architecture.py", "--source", ".")
        self.check_refused("none.svg: No such", "lint/draw_architecture.py", "--check", "--out", "none")
        self.check_refused("--at: 'x' is not a number", "docs/screenshot.sh", "--at", "x", "o.png")
        self.check_refused("no folder for none/o.png", "docs/screenshot.sh", "none/o.png")

    def test_figure_of_the_field_refuses_what_it_cannot_draw(self):
        self.check_refused("^fig6: scenario 'medium' has no open water", "results/fig6", "--cases", "medium")
        self.check_refused("--seed must not be negative", "results/fig6", "--seed", "-1")
        self.check_refused("no folder none", "results/fig6", "--out", "none/fig6")
        self.check_refused("at most 8", "results/fig6", "--cases", *["fig6_4"] * 9)

    def test_judge_of_joins_refuses_what_it_cannot_fly(self):
        self.check_refused("--agents must be at least 5", "results/joins", "encircle", "--agents", "4")
        self.check_refused("--episodes must be positive", "results/joins", "encircle", "--episodes", "0")
        self.check_refused("^joins: .*'unknown'", "results/joins", "unknown", "--episodes", "1")
        self.check_refused("only in open water", "results/joins", "pursuit", "--scenario", "medium",
                           "--agents", "5")  # fmt: skip

    @unittest.skipUnless(os.path.exists("/usr/share/i18n/locales/de_DE"), "no sources of locales")
    def test_benchmark_of_the_graph_prints_json_where_numbers_have_commas(self):
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", f"{self.folder}/de_DE.UTF-8"],
                       check=True)  # fmt: skip
        for name, text in (("roslaunch", ROSLAUNCH), ("sleep", SLEEP)):
            program = pathlib.Path(self.folder, name)
            program.write_text(text)
            program.chmod(0o755)
        environment = dict(os.environ, PATH=f"{self.folder}:/usr/bin:/bin", LOCPATH=self.folder,
                           LC_ALL="de_DE.UTF-8", TMPDIR=self.folder)  # fmt: skip
        done = subprocess.run([str(SCRIPTS / "bench/bench_ros.sh")], env=environment, check=False,
                              stdout=subprocess.PIPE, universal_newlines=True)  # fmt: skip
        self.assertEqual(done.returncode, 0)
        figures = json.loads(done.stdout)
        self.assertEqual(figures["lockstep_4_auvs_x_real_time"], 2.5)
        self.assertEqual(figures["detection_to_wrench_p99_ms_each"], [3.75] * 3)
        self.assertGreater(figures["largest_agent_memory_mib"], 0.0)

    def test_help_is_no_argument(self):
        for name in ("results/train_shipped.sh", "results/train_walls.sh", "bench/soak"):
            done = run(self.folder, name, "--help")
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            self.assertRegex(done.stdout, "(?i)usage: ")
            self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    unittest.main()
