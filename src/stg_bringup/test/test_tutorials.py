"""The tutorials are true: their blocks run word for word, in the order of the page."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from run_launcher import free_port

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGES = ROOT / "docs" / "tutorials"
WORKSPACE = pathlib.Path(os.environ["CMAKE_PREFIX_PATH"].split(":")[0])  # where ./stg has built it
LIMIT_S = 150


def blocks(page):
    """Yields (language, text) of the blocks that a reader must run: sh and python."""
    for language, text in re.findall(r"^```(sh|python)\n(.*?)^```$", page.read_text(), re.M | re.S):
        yield language, text


def script(page):
    """Returns the page's blocks as one shell script. A block of Python is a program of its own."""
    parts = ["set -eo pipefail"]
    for language, text in blocks(page):
        parts.append(text if language == "sh" else f"/usr/bin/python3 - <<'END_OF_BLOCK'\n{text}END_OF_BLOCK")
    return "\n".join(parts) + "\n"


class Tutorials(unittest.TestCase):
    """Each page runs in a folder that looks like a clone. The folder keeps what the page writes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for one in ROOT.iterdir():
            if one.name not in ("runs", "results", "devel", ".git"):
                (self.folder / one.name).symlink_to(one)
        (self.folder / "devel").symlink_to(WORKSPACE)

    def run_page(self, name):
        """Runs a page; returns its output."""
        port = free_port()
        environment = dict(os.environ, STG_BUILD_ROOT=str(WORKSPACE.parent), ROS_MASTER_URI=f"http://127.0.0.1:{port}",
                           ROS_HOME=str(self.folder / "ros_home"), PWD=str(self.folder))
        environment.pop("DISPLAY", None)
        done = subprocess.run(["bash", "-c", script(PAGES / f"{name}.md")], cwd=self.folder, env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                              errors="replace", check=False, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stdout[-4000:])
        self.assertNotIn("Traceback", done.stdout)
        return done.stdout

    def assert_pages(self, *names):
        """The reports are where the page says."""
        for name in names:
            self.assertIn("Content-Security-Policy", (self.folder / name).read_text(), name)

    @staticmethod
    def results(output):
        """Returns the JSON objects among the lines."""
        return [json.loads(line) for line in output.splitlines() if line.startswith("{") and line.endswith("}")]

    def test_first_hour(self):
        found = self.results(self.run_page("first_hour"))
        self.assert_pages("first.html", "runs/stress.html")
        pursuit, separated, _, *same = [one for one in found if "colliding_pairs" in one][-5:]
        self.assertTrue(4.0 < pursuit["colliding_pairs"] < 6.0, pursuit)
        self.assertLess(separated["colliding_pairs"], 0.5)
        # Both ways to change a number have the same effect.
        self.assertEqual(*(one["return"] for one in same))
        self.assertNotEqual(same[0]["return"], separated["return"])

    def test_first_policy(self):
        output = self.run_page("first_policy")
        self.assert_pages("runs/curves.html", "runs/flight.html", "runs/python.html")
        learned, controller = [one for one in self.results(output) if "return" in one][-2:]
        self.assertLess(learned["return"], controller["return"])
        self.assertGreater(learned["return"], 500.0)
        self.assertIn("(64, 4, 74) (64,)", output)

    def test_first_network(self):
        output = self.run_page("first_network")
        self.assert_pages("runs/aloha.html", "runs/csma.html")
        aloha, csma = (json.loads((self.folder / "runs" / name / "summary.json").read_text()) for name in ("aloha", "csma"))
        for reason in ("collision", "half_duplex"):
            self.assertLess(csma["drops"][reason], aloha["drops"][reason])
        self.assertGreater(csma["delivery_ratio"], aloha["delivery_ratio"])
        self.assertRegex(output, r"aloha +delivered \d+%")

    def test_own_vehicle(self):
        output = self.run_page("own_vehicle")
        self.assert_pages("runs/mine.html")
        self.assertIn("this is another vehicle than the one that was recorded", output)
        flown = [one for one in self.results(output) if "band_rate" in one]
        self.assertEqual(["nominal", "strong_current"], [one["condition"] for one in flown])

    def test_lost_target(self):
        self.run_page("lost_target")
        self.assert_pages("runs/stress.html")

    def test_every_page_has_a_test(self):
        pages = {page.stem for page in PAGES.glob("*.md")} - {"README"}
        self.assertEqual(pages, {name[len("test_"):] for name in dir(self) if name.startswith("test_")} -
                         {"every_page_has_a_test"})


if __name__ == "__main__":
    unittest.main()
