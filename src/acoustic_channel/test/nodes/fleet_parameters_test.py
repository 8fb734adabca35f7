#!/usr/bin/python3
"""A wrong parameter ends the channel at its start, with a message that says why."""

import pathlib
import subprocess
import tempfile
import unittest

import roslib.packages
import rospy
import rostest

REFUSED = 2


class FleetParameters(unittest.TestCase):
    """Starts the channel with one wrong parameter at a time."""

    def refusal(self, **wrong):
        """Returns what the node says before it ends with the status for bad input."""
        config = pathlib.Path(roslib.packages.get_pkg_dir("acoustic_channel")) / "config"
        right = {"vehicles": ["alpha", "beta"], "config": str(config / "channel.yaml")}
        rospy.set_param("/refused", {**right, **wrong})
        (node,) = roslib.packages.find_node("acoustic_channel", "fleet")
        run = subprocess.run([node, "__name:=refused"], stdout=subprocess.PIPE, timeout=60.0,
                             stderr=subprocess.STDOUT, universal_newlines=True, check=False)
        rospy.delete_param("/refused")
        self.assertEqual(run.returncode, REFUSED, run.stdout)
        return run.stdout

    def test_lists_of_vehicles_that_do_not_fit(self):
        for vehicles, why in (
                ([], "must name at least one vehicle"),
                (7, "must be a list"),
                (["alpha", "alpha"], "another vehicle has the name 'alpha'"),
                (["alpha", {"name": "beta", "id": 0}], "another vehicle has the id 0"),
                (["alpha", "beta=/alpha/odom"], "another vehicle has the odometry topic /alpha/odom"),
                (["alpha", {"name": "beta", "colour": "red"}], "unknown key 'colour'"),
                (["alpha", {"name": "beta", "id": 300}], "id must be from 0 to 254"),
                (["alpha", {"name": "beta", "id": "one"}], "id must be a whole number"),
                (["alpha", {"id": 3}], "is not a valid name of a vehicle"),
                (["alpha", "be ta"], "is not a valid name of a vehicle"),
                (["alpha", 3], "entry 1")):
            with self.subTest(why):
                self.assertIn(why, self.refusal(vehicles=vehicles))

    def test_files_that_cannot_work_with_file_line_and_key(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "mine.yaml"
            path.write_text("seed: 1\nchannel:\n  model: physical\n  acess: tdma\n")
            self.assertIn("mine.yaml:4: channel.acess: unknown key", self.refusal(config=str(path)))
            path.write_text("channel:\n  model: physical\n  access: tdma\n"
                            "  slots: {length_s: 0.1, guard_s: 0.05}\n")
            self.assertIn("mine.yaml:4: channel.slots", self.refusal(config=str(path)))
        self.assertIn("/nonexistent.yaml", self.refusal(config="/nonexistent.yaml"))
        self.assertIn("config", self.refusal(config=""))

    def test_a_clock_that_nobody_publishes(self):
        # Another run leaves the parameter like this on a master that lives longer.
        rospy.set_param("/use_sim_time", True)
        try:
            self.assertIn("/use_sim_time is true, but no node has published /clock",
                          self.refusal(clock_timeout=1.0))
        finally:
            rospy.delete_param("/use_sim_time")

    def test_parameters_out_of_range(self):
        for wrong in ({"silent_after": -1.0}, {"twist": "sideways"}, {"lag": "long"},
                      {"packet_log": "/dev/null/packets.csv"}, {"bag": "/nonexistent.bag"}):
            (name,) = wrong
            with self.subTest(name):
                self.assertIn(f"parameter {name}", self.refusal(**wrong))


if __name__ == "__main__":
    rospy.init_node("fleet_parameters_test")
    rostest.rosrun("acoustic_channel", "fleet_parameters", FleetParameters)
