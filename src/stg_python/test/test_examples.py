"""The examples run, and the learners learn: short runs of each of them, as a user starts them."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import stg

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
PAGE = EXAMPLES.parents[2] / "docs" / "python.md"


def run(name, *arguments, folder="."):
    """Runs an example; returns the last line of its output."""
    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py", *map(str, arguments)],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-3000:]
    return done.stdout.splitlines()[-1]


class Learner:
    """Stands in for the reader's learner. It does nothing."""

    @staticmethod
    def act(observations, _):
        return np.zeros((*observations.shape[:2], 3), np.float32)

    @staticmethod
    def bootstrap(observations, states):
        assert len(observations) == len(states) > 0


class Page(unittest.TestCase):
    """The code of docs/python.md runs as it is written there. Each block gets a fresh Python."""

    def test_environments_and_their_other_forms(self):
        blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
        self.assertGreater(len(blocks), 3)
        before = ("", "from test_examples import Learner, stg; learner = Learner()",
                  "import stg; env = stg.parallel_env()")  # fmt: skip
        for names, code in zip(before, blocks):
            with self.subTest(code):
                subprocess.run([sys.executable, "-c", names + "\n" + code], check=True,
                               cwd=pathlib.Path(__file__).parent)  # fmt: skip


class Examples(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_random_actions(self):
        self.assertIn("share of the tail lost", run("random_actions"))

    def test_ppo_learns_and_its_policy_flies(self):
        out = self.folder / "ppo.onnx"
        found = json.loads(run("ppo", "--steps", 51200, "--episodes", 4, "--out", out))
        self.assertGreater(found["last_reward"], found["first_reward"] + 0.05)
        again = stg.evaluate(out, "medium_release", episodes=4)
        self.assertEqual(again["lost_rate"], found["lost_rate"])
        self.assertEqual(stg.load_policy(out).metadata["training_step"], 51200)

    def test_value_decomposition_learns(self):
        found = json.loads(run("value_decomposition", "--steps", 16000))
        self.assertGreater(found["last_reward"], found["first_reward"] + 0.02)

    def test_an_episode_is_plotted(self):
        run("plot_episode", "--scenario", "two_targets", "--out", "a.png", folder=self.folder)
        self.assertEqual((self.folder / "a.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_bad_input_ends_them_in_one_line(self):
        for name in ("plot_episode", "ppo", "value_decomposition"):
            done = subprocess.run(
                [sys.executable, EXAMPLES / f"{name}.py", "--scenario", "nowhere.yaml"],
                stderr=subprocess.PIPE, universal_newlines=True, check=False,
            )  # fmt: skip
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, rf"^{name}: nowhere.yaml[^\n]*\n$")


if __name__ == "__main__":
    unittest.main()
