"""A node that refuses its configuration ends the launch, and says what would be right."""

import pathlib
import re
import shutil
import tempfile
import unittest

import rospkg

from run_launcher import launch, stop

BRINGUP = pathlib.Path(rospkg.RosPack().get_path("stg_bringup"))


def output_of(process):
    """Returns what a launch prints until its end. On a busy machine the end may take more than a minute."""
    return process.communicate(timeout=180)[0]


class Refusals(unittest.TestCase):
    """Plain roslaunch and `./stg run`."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def test_plain_roslaunch_ends_when_an_agent_refuses_its_policy(self):
        (self.folder / "mine.yaml").write_text("base: medium.yaml\nname: mine\nobservation:\n"
                                               "  semantic: false\n")
        process, _ = launch(self.folder, "medium.launch", "table:=false",
                            f"policy:={BRINGUP}/policies/medium.onnx", "scenario:=mine.yaml",
                            program=shutil.which("roslaunch"))
        self.addCleanup(stop, process)
        output = output_of(process)
        self.assertIn("this node refuses its configuration, so the launch ends", output)
        self.assertIn("of the shipped scenarios it fits scenario:= ", output)
        self.assertRegex(output, "it fits scenario:= .*medium")
        self.assertLess(output.count("observation layout"), 9, "each agent at most twice")

    def test_a_scenario_of_another_name_says_who_flies(self):
        (self.folder / "mine.yaml").write_text("base: medium.yaml\nname: mine\n")
        process, _ = launch(self.folder, "medium.launch", "table:=false", "scenario:=mine.yaml",
                            "episodes:=1", "real_time_factor:=0", "deadline:=20", "agents:=1",
                            "overrides:=[time.episode_steps=40, time.tail_steps=10]")
        self.addCleanup(stop, process)
        output = output_of(process)
        self.assertEqual(process.returncode, 0, output)
        self.assertEqual(output.count("no policy is shipped for a scenario named 'mine', so the controller 'pursuit_separated' decides"), 1, output)

    def test_what_would_have_no_effect_ends_the_launch(self):
        for arguments, reason in (
                (["bag:=a.bag"], "argument bag: has no effect without record:=true"),
                (["explore:=true", "policy:=pursuit"], "'pursuit' draws no actions at random"),
                (["overrides:=[critic.far_scale_m=5]"], "only a training reads critic"),
                (["overrides:=[mode=truth]"], "so a run of nodes always has mode=acoustic")):
            with self.subTest(arguments):
                process, _ = launch(self.folder, "medium.launch", "table:=false", *arguments,
                                    program=shutil.which("roslaunch"))
                self.addCleanup(stop, process)
                output = output_of(process)
                self.assertIn(reason, output)
                self.assertIn("this node refuses its configuration, so the launch ends", output)

    def test_a_scenario_with_true_states_says_that_the_run_has_none(self):
        process, _ = launch(self.folder, "medium.launch", "table:=false", "episodes:=1",
                            "scenario:=medium_release", "real_time_factor:=0", "deadline:=20",
                            "policy:=pursuit", "overrides:=[time.episode_steps=40, time.tail_steps=10]")
        self.addCleanup(stop, process)
        output = output_of(process)
        self.assertEqual(process.returncode, 0, output)
        self.assertEqual(output.count("scenario 'medium_release' has mode: truth"), 1, output)

    def test_a_private_parameter_that_a_node_does_not_read_is_refused(self):
        for parameters, node, wrong, meant in (
                ({"markers/overview/trail_s": 5, "markers/rate_hs": 5},
                 '<node name="markers" pkg="stg_monitor" type="marker_node" output="screen"/>',
                 "markers/rate_hs", "rate_hz"),
                ({"view/rate_hz": 5, "view/prot": 8399},
                 '<node name="view" pkg="stg_monitor" type="view_server.py" output="screen" required="true"/>',
                 "view/prot", "port")):
            with self.subTest(wrong):
                stated = "".join(f'<param name="/{name}" value="{value}"/>'
                                 for name, value in parameters.items())
                (self.folder / "own.launch").write_text(
                    f'<launch><env name="STG_REFUSAL_ENDS_LAUNCH" value="1"/>{stated}{node}</launch>')
                program = self.folder / "own"
                program.write_text(f'#!/bin/sh\nexec roslaunch -p "$2" "{self.folder}/own.launch"\n')
                program.chmod(0o755)
                process, _ = launch(self.folder, program=program)
                self.addCleanup(stop, process)
                output = output_of(process)
                self.assertIn(f"parameter {wrong.split('/')[1]}: this node does not read it, did you "
                              f"mean {meant}? ('rosparam delete /{wrong}' removes it", output)

    def test_an_agent_that_nobody_starts_is_named_while_it_is_waited_for(self):
        process, _ = launch(self.folder, "medium.launch", "table:=false", "external:=[2]",
                            "policy:=idle", "episodes:=1")
        self.addCleanup(stop, process)
        for line in process.stdout:
            if re.search(r"world: waiting for AUV 2, at most \d+ s longer", line):
                return
        self.fail("the run has ended")


if __name__ == "__main__":
    unittest.main()
