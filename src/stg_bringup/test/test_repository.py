"""Checks of the repository itself: what the core may include, and the state of the packages."""

import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PURITY = ROOT / "scripts" / "check_core_purity.py"


def check_purity(source):
    """Runs the purity check on `source`; returns (exit status, output)."""
    done = subprocess.run(
        ["/usr/bin/python3", str(PURITY), str(source)],
        stdout=subprocess.PIPE,
        universal_newlines=True,
        check=False,
    )
    return done.returncode, done.stdout


class CorePurity(unittest.TestCase):
    """The core of every package builds without ROS."""

    def test_core_includes_no_ros_header_and_no_message(self):
        status, output = check_purity(ROOT / "src")
        self.assertEqual(status, 0, "\n" + output)

    def test_check_finds_forbidden_includes_and_allows_nodes(self):
        with tempfile.TemporaryDirectory() as folder:
            package = pathlib.Path(folder) / "sample"
            (package / "src" / "nodes").mkdir(parents=True)
            (package / "include" / "sample").mkdir(parents=True)
            (package / "package.xml").write_text("<package/>")
            (package / "src" / "nodes" / "main.cpp").write_text("#include <ros/ros.h>\n")
            (package / "src" / "core.cpp").write_text("#include <rosy/ros.h>\n#include <cmath>\n")
            self.assertEqual(check_purity(folder), (0, ""))
            (package / "src" / "core.cpp").write_text('\n# include "auv_msgs/SensorFrame.h"\n')
            (package / "include" / "sample" / "a.hpp").write_text("#include <ros/time.h>\n")
            status, output = check_purity(folder)
            self.assertEqual(status, 1)
            self.assertIn("sample/src/core.cpp:2:", output)
            self.assertIn("sample/include/sample/a.hpp:1:", output)


class CatkinLint(unittest.TestCase):
    """The packages follow catkin's rules."""

    def test_packages_are_clean(self):
        done = subprocess.run(
            ["/usr/bin/catkin_lint", "-W2", "--strict", "--offline", str(ROOT / "src")],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, "\n" + done.stdout)


if __name__ == "__main__":
    unittest.main()
