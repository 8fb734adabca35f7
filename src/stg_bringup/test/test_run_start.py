"""A run starts as asked or not at all, also beside other runs. Ctrl-C ends it at any time."""

import contextlib
import io
import pathlib
import signal
import tempfile
import time
import types
import unittest

import rosgraph
from roslaunch.substitution_args import resolve_args
from run_launcher import LAUNCH, free_port, launch, process_of, processes_with, stop
from stg_common.loading import load_program

HERE = pathlib.Path(__file__).resolve().parent
run_checks = load_program(HERE.parents[2] / "scripts" / "run" / "run_checks.py")
run_arguments = load_program(HERE.parents[2] / "scripts" / "run" / "run_arguments.py")

PACKAGES = HERE.parents[1]
ENDLESS = ("policy:=idle", "table:=false")


class Arguments(unittest.TestCase):
    """The values of arguments are checked before anything starts."""

    def refusal(self, *words, file="medium.launch"):
        """Returns the message with which a command line is refused."""
        with self.assertRaises(run_checks.Refusal) as refused:
            run_arguments.check(["-p", "11311", "stg_bringup", file, *words])
        return str(refused.exception)

    def test_values_of_the_wrong_kind_are_refused_with_what_is_taken(self):
        for word, takes in (("real_time_factor:=abc", "a number, such as 1.0, not 'abc'"),
                            ("real_time_factor:=nan", "a number, such as 1.0, not 'nan'"),
                            ("deadline:=", "a number, such as 2.0, not ''"),
                            ("gui:=maybe", "true or false, not 'maybe'"),
                            ("record:=1", "true or false, not '1'"),
                            ("episodes:=1.5", "a whole number, such as 0, not '1.5'"),
                            ("episodes:=true", "a whole number, such as 0, not 'true'"),
                            ("seed:=-1", "a whole number from 0, not '-1'"),
                            ("policy:=7", "text (./7 is a file of that name), not '7'")):
            self.assertEqual(self.refusal(word), word.replace(":=", "\n").split("\n")[0] +
                             " takes " + takes)
        self.assertIn("or nothing", self.refusal("latitude:=north", file="field.launch"))
        self.assertIn("is blank", self.refusal("terrain:= ", file="field.launch"))
        self.assertIn("true or false", self.refusal("stay:=2", "bag:=a", file="replay.launch"))
        self.assertIn("lr takes a number, such as 0.001, or auto, not 'fast'",
                      self.refusal("lr:=fast", file="train_online.launch"))

    def test_numbers_may_replace_auto(self):
        file = PACKAGES / "stg_bringup" / "launch" / "train_online.launch"
        automatic = {name for name, default in run_arguments.declared(file).items()
                     if default == "auto" and name != "network"}
        self.assertEqual(automatic, set(run_arguments.NUMBERS_OR_AUTO))
        for name in automatic:
            for text in ("3", "0.001", "1e-4", "-0.5", "auto"):
                run_arguments.check(["stg_bringup", file.name, f"{name}:={text}"])

    def test_arguments_without_effect_are_refused(self):
        for file, words, why in (
                ("medium", "bag:=a.bag", "bag:=a.bag has no effect, because record is false; add"
                 " record:=true, or leave out bag"),
                ("medium", "bag:=a.bag record:=false", "because record is false"),
                ("medium", "port:=9999", "because view is overview; add view:=web"),
                ("field", "port:=9999 view:=follow gui:=true", "because view is follow"),
                ("medium", "view:=follow", "because gui is false; add gui:=true"),
                ("medium", "view:=bogus", "view: 'bogus' is none of overview, follow, both, web"),
                ("replay", "bag:=a view:=web", "view: 'web' is none of overview, follow, both"),
                ("replay", "bag:=a view:=both gui:=false", "because gui is false"),
                ("view", "view:=both rviz:=false", "because rviz is false"),
                ("sea", "emulate:=false config:=a.yaml", "because emulate is false"),
                ("sea", "emulate:=false packet_log:=a.csv", "because emulate is false"),
                ("field", "task:=hunt scenario:=field", "task:=hunt and scenario:=field are two"),
                ("medium", "realtime_priority:=5 real_time_factor:=0", "realtime_priority:=5 has no effect, because"
                 " real_time_factor is 0; add a real_time_factor above 0 and at most 1, or leave out"),
                ("field", "realtime_priority:=5", "because real_time_factor is 10.0"),
                ("medium", "view:=web gui:=true", "gui:=true has no effect, because view is web"),
                ("field", "view:=web display_rate:=30", "display_rate:=30 has no effect above 10, because view is"),
                ("medium", "seed:=1 seed:=2", "seed is given 2 times (seed:=1 and seed:=2); leave out all but one")):
            self.assertIn(why, self.refusal(*words.split(), file=f"{file}.launch"), words)

    def test_arguments_with_effect_pass(self):
        for file, words in (("medium", "record:=True bag:=a.bag"), ("medium", "view:=web port:=9999"),
                            ("medium", "view:=web gui:=false"), ("medium", "view:=both gui:=true"),
                            ("medium", "view:=overview port:=8300 gui:=false"),
                            ("replay", "bag:=a.bag view:=both"), ("view", "view:=both"),
                            ("sea", "config:=a.yaml packet_log:=a.csv"),
                            ("field", "task:=hunt scenario:=hunt"), ("field", "scenario:=hunt"),
                            ("medium", "realtime_priority:=5"), ("medium", "realtime_priority:=0 real_time_factor:=0"),
                            ("field", "realtime_priority:=5 real_time_factor:=0.5"),
                            ("medium", "view:=web display_rate:=5"), ("medium", "display_rate:=30 gui:=true")):
            run_arguments.check(["stg_bringup", f"{file}.launch", *words.split()])

    def test_values_of_the_right_kind_pass(self):
        run_arguments.check(["stg_bringup", "medium.launch", "real_time_factor:=2", "deadline:=.5",
                             "gui:=True", "episodes:=3", "record:=true", "bag:=./7", "policy:=pursuit:cap=0.5",
                             "overrides:=[agents=4]", "external:=[2]", "summary_file:="])
        run_arguments.check(["stg_bringup", "field.launch", "latitude:=", "longitude:=-10.5"])
        run_arguments.check(["acoustic_channel", "channel.launch", "seed:=-1", "step:=0.5"])

    def test_every_default_is_of_its_own_kind(self):
        files = [*(PACKAGES / "stg_bringup" / "launch").glob("*.launch"),
                 *(PACKAGES / "acoustic_channel" / "launch").glob("*.launch")]
        self.assertGreater(len(files), 6)
        for file in files:
            for name, default in run_arguments.declared(file).items():
                if default and "$(" not in default:
                    run_arguments.check([file.parents[1].name, file.name, f"{name}:={default}"])

    def test_every_value_that_roslaunch_computes_is_of_the_kind_of_its_argument(self):
        computed = 0
        for file in (PACKAGES / "stg_bringup" / "launch").glob("*.launch"):
            for scenario in ("medium", "field"):
                values = {"scenario": scenario}
                for name, default in run_arguments.declared(file).items():
                    if name not in values:
                        values[name] = resolve_args(default or "", {"arg": values})
                        if default and "$(eval" in default:
                            computed += 1
                            run_arguments.check(["stg_bringup", file.name, f"{name}:={values[name]}"])
        self.assertGreater(computed, 8)

    def test_wrong_values_in_place_of_computed_ones_are_refused(self):
        for word, takes in (("open_water:=yes", "true or false, not 'yes'"),
                            ("target_lost_rate:=none", "a number, such as 0.0, not 'none'")):
            self.assertIn(takes, self.refusal(word, file="train_online.launch"))


class Bags(unittest.TestCase):
    """Recordings of earlier runs."""

    def test_one_that_is_replaced_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            bag = pathlib.Path(folder) / "run.bag"
            recorder = types.SimpleNamespace(package="rosbag", type="record",
                                             args=f"--output-name='{bag}' /tf")
            said = []
            for _ in range(2):
                with contextlib.redirect_stdout(io.StringIO()) as output:
                    run_checks.Outputs([recorder], {}).check_before()
                said.append(output.getvalue())
                bag.touch()
        self.assertEqual(said, ["", f"stg: bag '{bag}' exists already; the recording replaces "
                                    "it\n"])


class WithFolder(unittest.TestCase):
    """A test with its own folder, from which runs are started."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def start(self, *arguments, **options):
        """Starts a launch; returns (process, address of its master)."""
        process, environment = launch(self.folder, *arguments, **options)
        self.addCleanup(stop, process)
        return process, environment["ROS_MASTER_URI"]

    def script(self, name, *lines):
        """Returns a program that runs these lines of shell and then the launcher."""
        path = self.folder / name
        path.write_text("\n".join(["#!/bin/sh", *lines, f'exec "{LAUNCH}" "$@"\n']))
        path.chmod(0o755)
        return path


class Interrupted(WithFolder):
    """Ctrl-C comes before all nodes are started."""

    def check_end(self, process, master):
        """Expects the exit status that a shell uses for Ctrl-C, and that nothing is left behind."""
        output = process.communicate(timeout=60)[0]
        self.assertEqual(process.returncode, 130, output)
        self.assertNotIn("Traceback", output)
        self.assertEqual(processes_with(master), {}, output)

    def test_while_python_itself_loads(self):
        # The signal waits until the program is ready for it.
        pending = self.script("pending", 'kill -INT "$$"').rename(self.folder / "inner")
        blocked = self.folder / "blocked"
        blocked.write_text(f'#!/bin/sh\nexec env --block-signal=INT "{pending}" "$@"\n')
        blocked.chmod(0o755)
        self.check_end(*self.start("medium.launch", *ENDLESS, program=blocked))

    def test_while_the_master_and_the_nodes_start(self):
        for mark in ("auto-starting new master", "setting /run_id", "process[world"):
            with self.subTest(mark):
                process, master = self.start("medium.launch", *ENDLESS)
                for line in process.stdout:
                    if mark in line:
                        break
                process.send_signal(signal.SIGINT)
                self.check_end(process, master)


class Together(WithFolder):
    """Runs that start at the same moment."""

    def test_of_two_on_one_master_one_is_refused_and_the_other_flies(self):
        port = free_port()
        runs = [self.start("medium.launch", *ENDLESS, port=port)[0] for _ in range(2)]
        end = time.monotonic() + 60.0
        while all(run.poll() is None for run in runs) and time.monotonic() < end:
            time.sleep(0.1)
        (refused,) = (run for run in runs if run.poll() is not None)
        output = refused.communicate()[0]
        self.assertEqual(refused.returncode, 1, output)
        self.assertRegex(output, "stg: the run failed: a node /.* runs already on the master")
        self.assertNotIn("RLException", output)
        process_of("/metrics", {"ROS_MASTER_URI": f"http://127.0.0.1:{port}"})

    def test_a_port_has_a_run_of_its_own_whatever_the_environment_says(self):
        first, one = self.start("view.launch", "rviz:=false")
        process_of("/markers", {"ROS_MASTER_URI": one})
        elsewhere = self.script("elsewhere", f"export ROS_MASTER_URI={one}")
        second, two = self.start("view.launch", "rviz:=false", program=elsewhere)
        process_of("/markers", {"ROS_MASTER_URI": two})
        ids = {rosgraph.Master("/test", master_uri=uri).getParam("/run_id") for uri in (one, two)}
        self.assertEqual(len(ids), 2)
        self.assertEqual((first.poll(), second.poll()), (None, None))


if __name__ == "__main__":
    unittest.main()
