"""A user who tries something in the first hour gets a line that helps."""

import os
import pathlib
import re
import signal
import subprocess
import tempfile
import unittest

import roslib.packages
import stg

ROOT = pathlib.Path(__file__).resolve().parents[3]
WORKSPACE = os.environ["CMAKE_PREFIX_PATH"].split(":")[0]  # where ./stg has built it


def run(*command, folder=None):
    """Returns (exit status, output) of a command that must end soon."""
    environment = dict(os.environ, STG_BUILD_ROOT=str(pathlib.Path(WORKSPACE).parent))
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, check=False,
                          cwd=folder, env=environment, timeout=60)
    return done.returncode, done.stdout


def program(name):
    """Returns the path of a program of the trainer."""
    (path,) = roslib.packages.find_node("marl_trainer", name)
    return path


class Help(unittest.TestCase):
    """`./stg COMMAND --help` tells about the command, and builds and starts nothing."""

    def test_every_command_that_is_listed_has_help(self):
        status, listed = run(ROOT / "stg", "help")
        self.assertEqual(status, 0, listed)
        commands = set(re.findall(r"^  ([a-z]+) ", listed.split("\n\n")[1], re.MULTILINE))
        self.assertLessEqual({"run", "test", "lint", "train", "bench", "reproduce", "setup",
                              "build"}, commands)
        for command in sorted(commands - {"help"}):
            for word in ("--help", "-h"):
                with self.subTest(command, word=word):
                    status, output = run(ROOT / "stg", command, word)
                    self.assertEqual(status, 0, output)
                    self.assertRegex(output, "(?i)usage:")
                    self.assertIn(command, output)
                    for noise in ("ninja:", "setup:", "unknown"):
                        self.assertNotIn(noise, output)

    def test_help_of_a_scenario_lists_its_arguments(self):
        status, output = run(ROOT / "stg", "run", "replay", "--help")
        self.assertEqual(status, 0, output)
        self.assertRegex(output, r"(?m)^  bag$\n +bag file to replay")
        self.assertRegex(output, r"(?m)^  rate:=1.0$")
        for arguments, option in ((["train"], "--algorithm"), (["train", "field"], "--noise-time")):
            status, output = run(ROOT / "stg", *arguments, "--help")
            self.assertEqual(status, 0, output)
            self.assertIn(option, output)
        status, output = run(ROOT / "stg", "run", "nowhere", "--help")
        self.assertEqual(status, 2, output)
        self.assertIn("no scenario 'nowhere'", output)

    def test_each_shipped_scenario_runs_by_its_name(self):
        for name, launch in (("hard", "medium"), ("physical", "medium"), ("hunt", "field"), ("many8_deaths", "field"),
                             ("fig6_4", "field")):
            with self.subTest(name):
                status, output = run(ROOT / "stg", "run", name, "--help")
                self.assertEqual(status, 0, output)
                self.assertIn(f"are those of {launch} with scenario:={name}:", output)
        listed = re.search("(?m)^Scenarios: (.*)$", output)[1].split()
        shipped = [file.stem for file in (ROOT / "src/stg_bringup/scenarios").glob("*.yaml")]
        self.assertGreater(len(shipped), 20)
        self.assertEqual(set(shipped) - set(listed), set())

    def test_a_slip_of_the_pen_is_answered_in_two_lines(self):
        for words, hint in ((("run", "meduim"), "did you mean 'medium'?"),
                            (("tset",), "did you mean 'test'?"),
                            (("lnit",), "did you mean 'lint'?")):
            with self.subTest(words):
                status, output = run(ROOT / "stg", *words)
                self.assertEqual(status, 2, output)
                self.assertIn(hint, output.splitlines()[0])
                self.assertEqual(len(output.splitlines()), 2, output)

    def test_two_scenarios_are_refused(self):
        for name, other in (("hunt", "field"), ("hard", "medium"), ("swarm20", "mine.yaml")):
            status, output = run(ROOT / "stg", "run", name, f"scenario:={other}")
            self.assertEqual(status, 2, output)
            self.assertIn(f"run: {name} and scenario:={other} are two scenarios", output)
        for words, reason in ((("run", "hunt", "task:=search"), "run: hunt and task:=search are two scenarios"),
                              (("train", "hard", "--scenario", "medium"), "train: hard and --scenario name the"),
                              (("train", "hard", "--scenario=medium"), "train: hard and --scenario name the")):
            status, output = run(ROOT / "stg", *words)
            self.assertEqual(status, 2, output)
            self.assertIn(reason, output)

    def test_a_report_that_cannot_be_made_is_refused_before_the_run(self):
        for words, reason in ((("report:=a.html", "report:=b.html"), "report is given twice"),
                              (("report:=",), "report:= takes the name of a file"),
                              (("record:=False", "report:=a.html"), "needs a recording, so leave out record:=false")):
            status, output = run(ROOT / "stg", "run", "medium", *words)
            self.assertEqual(status, 2, output)
            self.assertIn(reason, output)

    def test_help_of_a_run_names_the_controllers(self):
        for scenario in ("medium", "hard", "swarm20", "field"):
            output = run(ROOT / "stg", "run", scenario, "--help")[1]
            for controller in ("pursuit,", "pursuit_separated", "encircle", "idle"):
                self.assertIn(controller, output, scenario)

    def test_a_node_that_is_not_built_is_named(self):
        program = "/nowhere/trainer_node"
        status, output = run("/usr/bin/python3", ROOT / "src/auv_common/scripts/ends_launch", program)
        self.assertEqual(status, 1, output)
        self.assertIn(f"{program}: there is no such program; ./stg build", output)

    def test_scripts_tell_their_usage_without_a_master(self):
        for script in ("auv_common/scripts/ends_launch", "acoustic_channel/scripts/chat.py",
                       "stg_bringup/scripts/make_meshes.py", "stg_monitor/scripts/view.py",
                       "stg_monitor/scripts/bag_report.py", "stg_python/examples/agent.py",
                       "stg_python/examples/random_actions.py", "stg_python/examples/ppo.py"):
            with self.subTest(script):
                status, output = run("/usr/bin/python3", ROOT / "src" / script, "--help")
                self.assertEqual(status, 0, output)
                self.assertRegex(output, "(?i)usage: *" + pathlib.Path(script).name)


class Setup(unittest.TestCase):
    """The set-up knows the system for which it is written."""

    def setup_on(self, release, **environment):
        """Returns (exit status, output) of the set-up on a system with this os-release."""
        with tempfile.NamedTemporaryFile("w", suffix="os-release") as file:
            file.write(release)
            file.flush()
            done = subprocess.run([str(ROOT / "scripts" / "run" / "setup.sh")], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, universal_newlines=True, check=False,
                                  env=dict(os.environ, STG_OS_RELEASE=file.name, **environment))
        return done.returncode, done.stdout

    def test_another_release_is_refused_by_name(self):
        for release, name in (('ID=ubuntu\nVERSION_ID="20.04"\n', "ubuntu 20.04"),
                              ('ID=debian\nVERSION_ID="11"\n', "debian 11"),
                              ("", "unknown system")):
            status, output = self.setup_on(release)
            self.assertEqual(status, 1, output)
            self.assertIn("setup: this needs Debian 12", output)
            self.assertIn(name, output)

    def test_the_right_one_and_who_insists_go_on(self):
        # No package is missing where this test runs.
        for release, insists in (('ID=debian\nVERSION_ID="12"\n', ""),
                                 ('ID=ubuntu\nVERSION_ID="20.04"\n', "1")):
            status, output = self.setup_on(release, STG_ANY_RELEASE=insists)
            self.assertEqual((status, output), (0, ""))


class Evaluate(unittest.TestCase):
    """Names that are almost right are understood or corrected."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def evaluate(self, *arguments):
        """Returns (exit status, output) of one short episode."""
        return run(program("evaluate"), "--episodes", "1", "--set", "time.episode_steps=20", "--set",
                   "time.tail_steps=5", *arguments, folder=self.folder)

    def test_own_scenarios_stand_on_shipped_ones(self):
        (self.folder / "mine.yaml").write_text("base: medium.yaml\nname: mine\n")
        status, output = self.evaluate("--scenario", "mine.yaml", "--policy", "idle")
        self.assertEqual(status, 0, output)

    def test_negative_seeds_are_refused(self):
        for command in ((program("evaluate"), "--policy", "idle"), (program("train"), "--out", "o")):
            for option in (("--seed", "-1"), ("--seed=-1",)):
                status, output = run(*command, *option, folder=self.folder)
                self.assertEqual(status, 2, output)
                self.assertRegex(output, r"--seed: .*whole number from 0\b")
        with self.assertRaisesRegex(ValueError, "seed: -1 is not in"):
            stg.evaluate("idle", episodes=1, seed=-1)
        with self.assertRaisesRegex(ValueError, "seed: -1 is not in"):
            stg.parallel_env().reset(seed=-1)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_start_from_nothing_leaves_nothing_behind(self):
        for start in ("nowhere", "none.onnx"):
            status, output = run(program("train"), "--out", "o", "--start-from", start,
                                 folder=self.folder)
            self.assertEqual((status, output), (2, f"train: --start-from: no checkpoint in {start}\n"))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_training_stopped_before_its_first_validation_says_what_there_is(self):
        with subprocess.Popen([program("train"), "--out", "o", "--steps", "1000000000",
                               "--validation-interval", "1000000000"], cwd=self.folder,
                              stdout=subprocess.PIPE, universal_newlines=True) as training:
            training.stdout.readline()
            training.send_signal(signal.SIGINT)
            output = training.stdout.read()
        self.assertEqual(training.returncode, 130, output)
        self.assertIn("no policy_best yet, because the first validation is at 1000000000 steps; policy_last is the newest policy", output)
        self.assertTrue((self.folder / "o" / "policy_last.onnx").exists())

    def test_a_blank_terrain_is_told(self):
        status, output = self.evaluate("--scenario", "field", "--policy", "idle", "--set",
                                       "sea.terrain=' '")
        self.assertEqual(status, 2, output)
        self.assertIn("' ' is blank, neither a name nor a path to a .nc file", output)

    def test_what_is_mistyped_is_refused_with_what_was_meant(self):
        (self.folder / "mine.yaml").write_text("base: mediun.yaml\nname: mine\n")
        for arguments, reason in (
                (("--scenario", "mine.yaml", "--policy", "idle"),
                 "mine.yaml:1: base: mediun.yaml is not a file; did you mean medium.yaml?"),
                (("--set", "sensing.rnge=3", "--policy", "idle"),
                 "sensing.rnge: unknown key, did you mean sensing.range_m?"),
                (("--policy", "pursuit:capp=3"), "no such constant: capp; did you mean cap?"),
                (("--policy", "pursiut"), "did you mean pursuit?"),
                (("--policy", "none.onnx"), "none.onnx: no such policy file")):
            status, output = self.evaluate(*arguments)
            self.assertEqual(status, 2, output)
            self.assertIn(reason, output)


if __name__ == "__main__":
    unittest.main()
