"""Compares the statistics of studies with closed forms."""

import os
import unittest

import numpy as np

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))

from stg_study import statistics


class Statistics(unittest.TestCase):
    def test_std_is_that_of_a_sample_and_unknown_for_one_value(self):
        mean, std = statistics.mean_std([1.0, 2.0, 3.0, 6.0])
        self.assertEqual(mean, 3.0)
        self.assertAlmostEqual(std, np.sqrt(14.0 / 3.0))
        self.assertEqual(statistics.mean_std([2.5]), (2.5, None))

    def test_interquartile_mean_leaves_a_quarter_out_at_each_end(self):
        self.assertEqual(statistics.interquartile_mean([100.0, 1.0, 2.0, -50.0]), 1.5)
        # Of five values, one is left out at each end: int(1.25) = 1.
        self.assertEqual(statistics.interquartile_mean([9.0, 0.0, 1.0, 2.0, 3.0]), 2.0)
        self.assertEqual(statistics.interquartile_mean([7.0]), 7.0)

    def test_interval_of_equal_scores_is_a_point(self):
        self.assertEqual(statistics.iqm_interval([np.full((3, 30), 4.0)]), (4.0, 4.0, 4.0))

    def test_interval_over_runs_matches_the_normal_approximation(self):
        scores = np.random.default_rng(1).uniform(0.0, 1.0, (4000, 1))
        point, low, high = statistics.iqm_interval([scores], resamples=1000)
        # The trimmed mean of n values has variance 4 Var(clip(U, 1/4, 3/4)) / n. Here U is uniform.
        std = np.sqrt(4.0 * (0.25**2 * 0.5 + 0.5**3 / 12.0) / 4000.0)
        self.assertAlmostEqual(point, 0.5, delta=4.0 * std)
        self.assertAlmostEqual((high - low) / (2.0 * 1.96 * std), 1.0, delta=0.12)

    def test_interval_knows_that_trainings_differ(self):
        """The three seeds differ a lot, so the interval must include seeds and not only episodes."""
        scores = np.arange(3.0)[:, None] + np.zeros((3, 30))
        _, low, high = statistics.iqm_interval([scores])
        self.assertEqual((low, high), (0.0, 2.0))

    def test_a_run_counts_once_however_its_episodes_spread(self):
        """The four runs have means 0, 1, 2 and 9. The middle half is 1 and 2. One bad episode of the best run
        must not be left out alone."""
        scores = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [-82.0, 100.0]])
        self.assertEqual(statistics.iqm_interval([scores])[0], 1.5)

    def test_seeds_are_drawn_together_in_all_conditions(self):
        """The two conditions mirror each other, so every resample has the same mean."""
        scores = np.array([[0.0] * 4, [1.0] * 4])
        _, low, high = statistics.iqm_interval([scores, 1.0 - scores])
        self.assertEqual((low, high), (0.5, 0.5))

    def test_conditions_with_other_seeds_are_refused(self):
        with self.assertRaises(ValueError):
            statistics.iqm_interval([np.zeros((3, 5)), np.zeros((2, 5))])

    def test_a_hierarchical_interval_knows_that_trainings_and_episodes_differ(self):
        law = [np.arange(50.0)]
        same = np.arange(50.0) + 2.0
        # The episodes are paired and the trainings are equal, so the interval is a point.
        self.assertEqual(statistics.hierarchical_interval([same] * 3, law), (2.0, 2.0, 2.0))
        # The trainings are 1 and 3 above the law. A resample may have only one of them, with any episodes.
        mean, low, high = statistics.hierarchical_interval([law[0] + 1.0, law[0] + 3.0], law)
        self.assertEqual((mean, low, high), (2.0, 1.0, 3.0))
        # With one training it is the bootstrap over episodes, here of a fair coin.
        coin = [np.tile([0.0, 1.0], 200)]
        mean, low, high = statistics.hierarchical_interval(coin, [np.zeros(400)])
        self.assertEqual(mean, 0.5)
        self.assertAlmostEqual((high - low) / (2.0 * 1.96 * 0.5 / 20.0), 1.0, delta=0.1)

    def test_probability_of_improvement_counts_pairs_of_trainings(self):
        # There are four pairs. Three are won and one is equal.
        self.assertEqual(statistics.probability_of_improvement([[1, 2]], [[0, 1]])[0], 0.875)
        self.assertEqual(statistics.probability_of_improvement([[5.0]], [[5.0]]), (0.5, 0.5, 0.5))
        # One condition is won and one is lost. The sides have different numbers of trainings.
        ours, theirs = [[1, 1, 1], [0, 0, 0]], [[0, 0], [1, 1]]
        self.assertEqual(statistics.probability_of_improvement(ours, theirs), (0.5, 0.5, 0.5))
        with self.assertRaises(ValueError):
            statistics.probability_of_improvement([[1.0], [2.0]], [[1.0]])

    def test_interval_of_an_improvement_matches_that_of_a_share(self):
        """The opponent is in the middle, so the wins of n trainings are a binomial share."""
        ours = np.repeat([[0.0, 2.0]], 50, axis=0).T.reshape(1, 100)
        point, low, high = statistics.probability_of_improvement(ours, [[1.0]])
        self.assertEqual(point, 0.5)
        self.assertAlmostEqual((high - low) / (2.0 * 1.96 * 0.05), 1.0, delta=0.15)

    def test_profiles_are_shares_above(self):
        scores = [[1.0, 2.0], [3.0, 4.0]]
        shares = statistics.performance_profile(scores, [0.0, 1.0, 2.5, 4.0])
        self.assertEqual(list(shares), [1.0, 0.75, 0.5, 0.0])

    def test_final_stage_is_the_last_fifth_and_never_empty(self):
        self.assertEqual(statistics.final_stage(list(range(10))), [8, 9])
        self.assertEqual(statistics.final_stage([5]), [5])
        with self.assertRaises(ValueError):
            statistics.final_stage([])


if __name__ == "__main__":
    unittest.main()
