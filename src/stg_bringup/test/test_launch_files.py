"""Checks every launch file: it loads with its defaults, its nodes exist, its arguments are told."""

import pathlib
import unittest
import xml.etree.ElementTree as ElementTree

import roslaunch.config
import roslib.packages
import rospkg

LAUNCH = pathlib.Path(rospkg.RosPack().get_path("stg_bringup")) / "launch"


def launch_files():
    """Returns all launch files of the package, as roslaunch sees them."""
    return sorted(LAUNCH.glob("*.launch"))


def required_arguments(root):
    """Returns assignments for the arguments without a default, such as the bag of a replay."""
    return [
        f"{arg.get('name')}:=/nonexistent"
        for arg in root.findall("arg")
        if arg.get("default") is None and arg.get("value") is None
    ]


class LaunchFiles(unittest.TestCase):
    """The launch files work as far as one can see without running them."""

    def test_each_file_loads_and_its_nodes_exist(self):
        for path in launch_files():
            with self.subTest(path.name):
                root = ElementTree.parse(path).getroot()
                config = roslaunch.config.load_config_default(
                    [(str(path), required_arguments(root))], port=None, verbose=False
                )
                self.assertEqual(config.config_errors, [])
                for node in config.nodes:
                    self.assertTrue(
                        roslib.packages.find_node(node.package, node.type),
                        f"no node {node.package}/{node.type}",
                    )

    def test_each_argument_is_documented(self):
        for path in launch_files():
            with self.subTest(path.name):
                for arg in ElementTree.parse(path).getroot().findall("arg"):
                    if arg.get("value") is None:
                        self.assertTrue(arg.get("doc"), f"no doc for argument {arg.get('name')}")


if __name__ == "__main__":
    unittest.main()
