"""Checks every launch file: it loads with its defaults, its nodes exist, its arguments have a text."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import roslaunch.config
import roslib.packages
import rospkg
from roslaunch.substitution_args import resolve_args
from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
LAUNCH = pathlib.Path(rospkg.RosPack().get_path("stg_bringup")) / "launch"


def launch_files():
    """Returns all launch files for users, as roslaunch sees them."""
    found = sorted(LAUNCH.glob("*.launch"))
    assert {"field.launch", "medium.launch"} <= {path.name for path in found}, found
    alone = pathlib.Path(rospkg.RosPack().get_path("acoustic_channel")) / "launch"
    return [*found, *sorted(alone.glob("*.launch"))]


def required_arguments(root):
    """Returns assignments for the arguments without a default, such as the bag of a replay."""
    return [
        f"{arg.get('name')}:=/nonexistent"
        for arg in root.findall("arg")
        if arg.get("default") is None and arg.get("value") is None
    ]


def load(path, arguments):
    """Returns what roslaunch would start."""
    return roslaunch.config.load_config_default([(str(path), arguments)], port=None, verbose=False)


class LaunchFiles(unittest.TestCase):
    """The launch files work, as far as this shows without running them."""

    def test_each_file_loads_and_its_nodes_exist(self):
        for path in launch_files():
            with self.subTest(path.name):
                root = ElementTree.parse(path).getroot()
                config = load(path, required_arguments(root))
                self.assertEqual(config.config_errors, [])
                self.assertTrue(config.nodes)
                for node in config.nodes:
                    self.assertTrue(
                        roslib.packages.find_node(node.package, node.type),
                        f"no node {node.package}/{node.type}",
                    )

    def test_the_trainer_gets_the_options_of_its_exploration(self):
        def given(*words):
            parameters = load(LAUNCH / "train_online.launch", ["out:=/nonexistent", *words]).params
            return {name: parameters[f"/trainer/{name}"].value
                    for name in ("noise_time", "last_command", "log_std") if f"/trainer/{name}" in parameters}

        # The node chooses what is not given, because `layers` refuses all of them.
        self.assertEqual(given("scenario:=field"), {})
        self.assertEqual(given("noise_time:=20", "last_command:=true", "log_std:=-2"),
                         {"noise_time": 20.0, "last_command": True, "log_std": -2.0})

    def test_a_run_from_a_clone_builds_all_that_it_starts(self):
        # `./stg run` builds the target stg_graph, or everything if the launch file starts a trainer.
        built = set()
        for file in (ROOT / "src").glob("*/CMakeLists.txt"):
            built |= set(re.findall(r"stg_graph_node\(\S+ (\w+)", file.read_text(encoding="utf-8")))
        for path in sorted(LAUNCH.glob("*.launch")):
            nodes = load(path, required_arguments(ElementTree.parse(path).getroot())).nodes
            programs = {node.type for node in nodes if node.package != "rosbag" and not node.type.endswith(".py")}
            if "trainer_node" not in programs:
                self.assertEqual(set(), programs - built, path.name)

    def test_each_node_is_free_of_what_earlier_launches_told_it(self):
        for path in [*launch_files(), *sorted((LAUNCH / "include").glob("*.launch"))]:
            for node in ElementTree.parse(path).getroot().iter("node"):
                with self.subTest(f"{path.name}: {node.get('name')}"):
                    self.assertEqual(node.get("clear_params"), "true")

    def test_each_argument_is_documented(self):
        for path in launch_files():
            with self.subTest(path.name):
                arguments = ElementTree.parse(path).getroot().findall("arg")
                self.assertTrue(arguments)
                for arg in arguments:
                    if arg.get("value") is None:
                        self.assertTrue(arg.get("doc"), f"no doc for argument {arg.get('name')}")

    def test_every_node_stays_on_the_loopback_unless_told_otherwise(self):
        told = os.environ.get("ROS_IP", "127.0.0.1")
        for path in launch_files():
            with self.subTest(path.name):
                config = load(path, required_arguments(ElementTree.parse(path).getroot()))
                self.assertTrue(config.nodes)
                for node in config.nodes:
                    self.assertIn(("ROS_IP", told), node.env_args, node.name)


class Graph(unittest.TestCase):
    """The launch file of a run gives its nodes what the user meant."""

    def parameters(self, *arguments):
        """Returns the parameters of a run, by name."""
        config = load(LAUNCH / "medium.launch", list(arguments))
        return {name: param.value for name, param in config.params.items()}

    def test_relative_paths_start_at_the_folder_of_the_user(self):
        here = os.environ["PWD"]
        given = self.parameters("scenario:=mine.yaml", "condition:=sub/rough.yaml",
                                "policy:=sub/mine.onnx", "summary_file:=out.csv")
        self.assertEqual(given["/scenario"], f"{here}/mine.yaml")
        self.assertEqual(given["/condition"], f"{here}/sub/rough.yaml")
        self.assertEqual(given["/auv_3/agent/policy"], f"{here}/sub/mine.onnx")
        self.assertEqual(given["/metrics/summary_file"], f"{here}/out.csv")

    def test_names_and_absolute_paths_stay_as_they_are(self):
        given = self.parameters("condition:=fast_target", "policy:=pursuit:cap=0.5",
                                "scenario:=/a/mine.yaml")
        self.assertEqual(given["/scenario"], "/a/mine.yaml")
        self.assertEqual(given["/condition"], "fast_target")
        self.assertEqual(given["/auv_0/agent/policy"], "pursuit:cap=0.5")
        self.assertEqual(given["/metrics/summary_file"], "")

    def test_real_time_priority_is_for_runs_at_the_pace_of_the_wall_clock(self):
        for factor, priority in (("1.0", 10), ("0.5", 10), ("0", 0), ("20", 0)):
            given = self.parameters(f"real_time_factor:={factor}")
            self.assertEqual(given["/realtime_priority"], priority, factor)
        self.assertEqual(self.parameters("realtime_priority:=0")["/realtime_priority"], 0)

    def test_in_lockstep_each_waits_less_long_than_those_who_wait_for_it(self):
        # If a node gives up on a stall, a lockstep run becomes another one.
        given = self.parameters("real_time_factor:=0", "deadline:=5")
        waits = [given["/acoustic_channel/timeout"], given["/auv_0/agent/patience"],
                 given["/world/deadline"]]
        self.assertEqual(waits, [2.0, 4.0, 5.0])

    def test_recording_holds_every_target_a_scenario_may_have(self):
        config = load(LAUNCH / "medium.launch", ["record:=true"])
        (recorder,) = (node for node in config.nodes if node.name == "recorder")
        self.assertLessEqual({f"/target_{k}/odom" for k in range(16)}, set(recorder.args.split()))


    def test_arguments_without_effect_reach_the_world_as_a_reason(self):
        def refusal(file, *arguments):
            return load(LAUNCH / f"{file}.launch", list(arguments)).params["/world/refusal"].value

        for file, argument, why in (
                ("medium", "bag:=a.bag", "bag: has no effect without record:=true"),
                ("medium", "port:=9999", "port: has no effect without view:=web"),
                ("medium", "view:=bogus", "view: must be web, overview, follow or both"),
                ("field", "realtime_priority:=5", "no effect unless real_time_factor is above 0 and at most 1"),
                ("web", "gui:=true", "gui: has no effect with view:=web"),
                ("web", "display_rate:=30", "display_rate: has no effect above 10 with view:=web"),
                ("sea", "config:=a.yaml", "no effect with emulate:=false"),
                ("sea", "packet_log:=a.csv", "no effect with emulate:=false"),
                ("field", "scenario:=field", "name two scenarios, so leave out one")):
            others = {"sea": ["emulate:=false"], "field": ["task:=hunt"], "web": ["view:=web"]}.get(file, [])
            file = {"web": "medium"}.get(file, file)
            self.assertIn(why, refusal(file, argument, *others))
            self.assertEqual(refusal(file, *others), "", file)
        for arguments in (["record:=true", "bag:=a.bag"], ["view:=web", "port:=9999"], ["view:=both"],
                          ["realtime_priority:=5", "real_time_factor:=0.5"], ["view:=web", "display_rate:=5"]):
            self.assertEqual(refusal("medium", *arguments), "", arguments)
        self.assertEqual(refusal("sea", "config:=/a.yaml", "packet_log:=a.csv"), "")
        self.assertEqual(refusal("field", "task:=hunt", "scenario:=hunt"), "")

    def test_a_recording_without_a_name_has_one_of_its_own(self):
        config = load(LAUNCH / "medium.launch", ["record:=true"])
        (recorder,) = (node for node in config.nodes if node.name == "recorder")
        self.assertRegex(recorder.args, f"--output-name='{os.environ['PWD']}/stg_run_[^/]+[.]bag'")


class Documentation(unittest.TestCase):
    """What the texts of arguments list is what there is."""

    def listed(self, file, name):
        """Returns the words of the text of an argument."""
        root = ElementTree.parse(LAUNCH / file).getroot()
        (text,) = (arg.get("doc") for arg in root.findall("arg") if arg.get("name") == name)
        return set(re.findall(r"\w+", text))

    def test_policies_are_the_registered_controllers(self):
        registry = (ROOT / "src/stg_agent/src/controllers/registry.cpp").read_text()
        names = set(re.findall(r'\{"(\w+)", Make', registry))
        self.assertGreater(len(names), 10)
        for file in ("medium.launch", "field.launch", "include/graph.launch"):
            self.assertEqual(names - self.listed(file, "policy"), set(), file)

    def test_conditions_of_the_field_are_the_files(self):
        folder = ROOT / "src/stg_bringup/scenarios/conditions"
        names = {file.stem for part in ("field", "many8", "deep") for file in (folder / part).glob("*.yaml")}
        self.assertGreater(len(names), 15)
        self.assertEqual(names - self.listed("field.launch", "condition"), set())


SCENARIO_KEY = ROOT / "scripts" / "run" / "scenario_key.py"
scenario_key = load_program(SCENARIO_KEY)
run_arguments = load_program(SCENARIO_KEY.parent / "run_arguments.py")


class ScenarioKeys(unittest.TestCase):
    """The number of AUVs of a scenario, and its water, are known before anything is launched."""

    def key(self, scenario, key="agents"):
        """Returns what the script prints."""
        return subprocess.run([SCENARIO_KEY, scenario, key], stdout=subprocess.PIPE,
                              universal_newlines=True, check=True).stdout.strip()

    def test_own_number_counts_else_that_of_the_base(self):
        self.assertEqual(self.key("swarm20"), "20")
        shipped = ROOT / "src" / "stg_bringup" / "scenarios"
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "seven.yaml").write_text(f"base: {shipped}/medium.yaml\nagents: 7\n")
            (folder / "heir.yaml").write_text("base: seven.yaml\nname: heir\n")
            (folder / "circle.yaml").write_text("base: circle.yaml\n")
            self.assertEqual(self.key(folder / "seven.yaml"), "7")
            self.assertEqual(self.key(folder / "heir.yaml"), "7")
            for wrong in ("circle", "missing"):
                self.assertEqual(self.key(folder / f"{wrong}.yaml"), "", wrong)

    def test_a_scenario_of_a_user_may_be_in_open_water(self):
        with tempfile.TemporaryDirectory() as name:
            mine = pathlib.Path(name) / "mine.yaml"
            mine.write_text("base: field8.yaml\nname: mine\nsea: {bottom_m: 300}\n")
            self.assertEqual(self.key(mine, "sea.open"), "true")
        self.assertEqual(self.key("hard", "sea.open"), "")

    def test_shipped_names_tell_the_water(self):
        default = run_arguments.declared(LAUNCH / "train_online.launch")["open_water"]
        for file in (ROOT / "src/stg_bringup/scenarios").glob("*.yaml"):
            given = resolve_args(default, {"arg": {"scenario": file.stem}})
            self.assertEqual(given, str(bool(scenario_key.value_of(file.stem, "sea.open"))), file.stem)

    def test_what_is_no_yaml_is_refused_in_one_line(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for text in ("agents: 4\nname: [a\n", "\n[" + 5000 * "[", "\nagents: 2026-99-99"):
                (folder / "file.yaml").write_text(text)
                self.refused(folder / "file.yaml", "file.yaml:")
            (folder / "heir.yaml").write_text("base: fifo.yaml\n")
            os.mkfifo(folder / "fifo.yaml")
            self.refused(folder / "heir.yaml", "fifo.yaml: is not a regular file")

    def refused(self, scenario, what):
        """Expects that the script ends in one line that says `what`."""
        run = subprocess.run([SCENARIO_KEY, scenario, "agents"], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, universal_newlines=True, timeout=60,
                             check=False)  # fmt: skip
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertRegex(run.stderr, rf"^scenario_key: [^\n]*{what}[^\n]*\n$")


if __name__ == "__main__":
    unittest.main()
