"""The judge of long runs (scripts/bench/soak) reports what grows, and nothing else."""

import pathlib
import unittest

from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOAK = load_program(ROOT / "scripts" / "bench" / "soak")


def rows(memory=lambda t: 50000, files=lambda t: 20, threads=lambda t: 5, until=100):
    """Samples of one process, one per second, in a run of 100 s."""
    return [(float(t), "world", 7, memory(t), files(t), threads(t)) for t in range(until)]


class Judge(unittest.TestCase):
    def test_what_is_taken_at_the_start_is_no_growth(self):
        self.assertEqual(SOAK.grown(rows(memory=lambda t: 10000 * min(t, 5)), 100.0), [])
        jitter = rows(memory=lambda t: 50000 + 500 * (t % 3), files=lambda t: 20 + t % 2)
        self.assertEqual(SOAK.grown(jitter, 100.0), [])

    def test_a_leak_is_told_by_name_and_amount(self):
        # From the middle of the second quarter to the middle of the last one is half of the run.
        (told,) = SOAK.grown(rows(memory=lambda t: 50000 + 60 * t), 100.0)
        self.assertRegex(told, "^world: 3000 KiB more$")
        (told,) = SOAK.grown(rows(files=lambda t: 20 + t // 10), 100.0)
        self.assertRegex(told, "^world: 5 open files more$")
        (told,) = SOAK.grown(rows(threads=lambda t: 5 if t < 60 else 7), 100.0)
        self.assertRegex(told, "^world: 2 threads more$")

    def test_a_process_that_dies_on_the_way_is_told_and_a_helper_of_the_start_is_not(self):
        (told,) = SOAK.grown(rows(until=60), 100.0)
        self.assertIn("did not run all the time", told)
        self.assertEqual(SOAK.grown(rows(until=10), 100.0), [])

    def test_length_of_an_episode_comes_from_the_scenario_or_its_base(self):
        self.assertEqual(SOAK.episode_s("medium.yaml"), 50.0)
        self.assertGreater(SOAK.episode_s("physical.yaml"), 50.0)


if __name__ == "__main__":
    unittest.main()
