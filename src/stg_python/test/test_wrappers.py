"""Wrappers keep the contracts, and do what they say."""

import unittest

import numpy as np

import stg
from stg import contract, spaces, wrappers

SHORT = {"time.episode_steps": 25, "time.tail_steps": 5}


class DiscreteActions(unittest.TestCase):
    def test_contracts(self):
        for flat in (False, True):
            contract.check_parallel(
                lambda flat=flat: wrappers.discrete_actions(
                    stg.parallel_env(overrides=SHORT), 3, flat
                )
            )
            contract.check_vector(
                lambda flat=flat: wrappers.discrete_actions(
                    stg.vector_env("medium", 5, overrides=SHORT), 5, flat
                )
            )

    def test_integers_stand_for_evenly_spread_numbers(self):
        for make, flat, chosen in (
            (lambda: stg.parallel_env(), False, [0, 2, 3]),
            (lambda: stg.parallel_env(), True, 0 * 25 + 2 * 5 + 3),
        ):
            plain, wrapped = make(), wrappers.discrete_actions(make(), 5, flat)
            plain.reset(seed=1)
            wrapped.reset(seed=1)
            wanted = np.array([-1.0, 0.0, 0.5], np.float32)
            a = plain.step({name: wanted for name in plain.agents})
            b = wrapped.step({name: np.asarray(chosen) for name in wrapped.agents})
            np.testing.assert_equal(a, b)
        plain, wrapped = (stg.vector_env("medium", 3) for _ in range(2))
        wrapped = wrappers.discrete_actions(wrapped, 3, flat=True)
        self.assertEqual(wrapped.single_action_space, spaces.MultiDiscrete([27] * 4))
        plain.reset(seed=1)
        wrapped.reset(seed=1)
        chosen = np.full((3, 4), 26)
        self.assertTrue(
            np.array_equal(
                plain.step(np.ones((3, 4, 3), np.float32))[0], wrapped.step(chosen)[0]
            )
        )

    def test_wrong_integers_are_refused(self):
        env = wrappers.discrete_actions(stg.parallel_env(), 3)
        env.reset(seed=1)
        good = {name: np.array([0, 1, 2]) for name in env.agents}
        for wrong, error in ((np.array([0, 1, 3]), ValueError), (np.array([-1, 0, 0]), ValueError),
                             (np.array([0, 1]), ValueError), (np.zeros(3), TypeError)):  # fmt: skip
            with self.assertRaisesRegex(error, "auv_2"):
                env.step({**good, "auv_2": wrong})
        env.step(good)
        self.assertRaises(ValueError, wrappers.discrete_actions, stg.parallel_env(), 1)
        self.assertRaises(TypeError, wrappers.discrete_actions, object(), 3)


class Joint(unittest.TestCase):
    def test_the_team_is_one_agent(self):
        plain, team = stg.parallel_env(overrides=SHORT), stg.parallel_env(overrides=SHORT)
        team = wrappers.joint(team)
        first, _ = plain.reset(seed=1)
        observation, info = team.reset(seed=1)
        self.assertIn(observation, team.observation_space)
        self.assertTrue(np.array_equal(observation, np.concatenate(list(first.values()))))
        self.assertTrue(np.array_equal(info["state"], plain.state()))
        for _ in range(25):
            action = team.action_space.sample()
            split = dict(zip(plain.agents, action.reshape(4, 3)))
            observations, rewards, _, _, _ = plain.step(split)
            observation, reward, terminated, truncated, info = team.step(action)
            self.assertTrue(np.array_equal(observation, np.concatenate(list(observations.values()))))
            self.assertAlmostEqual(reward, np.mean(list(rewards.values())))
            self.assertFalse(terminated)
        self.assertTrue(truncated)
        self.assertIn("metrics", info)
        self.assertRaises(RuntimeError, team.step, action)
        team.reset()
        self.assertRaises(ValueError, team.step, action[:5])

    def test_vector_contract(self):
        def make():
            return wrappers.joint(stg.vector_env("medium", 5, overrides=SHORT))

        contract.check_vector(make)
        self.assertEqual(make().observation_space.shape, (5, 4 * 74))
        self.assertEqual(make().action_space.shape, (5, 12))


class FrameSkip(unittest.TestCase):
    def test_contract_and_sums(self):
        contract.check_parallel(
            lambda: wrappers.FrameSkip(stg.parallel_env(overrides=SHORT), 4), cycles=10
        )
        plain = stg.parallel_env(overrides=SHORT)
        skipping = wrappers.FrameSkip(stg.parallel_env(overrides=SHORT), 4)
        plain.reset(seed=1)
        skipping.reset(seed=1)
        for count in [4] * 6 + [1]:  # 25 decisions
            actions = {name: plain.action_space(name).sample() for name in plain.agents}
            total = 0.0
            for _ in range(count):
                observations, rewards, *rest = plain.step(actions)
                total += rewards["auv_1"]
            got = skipping.step(actions)
            np.testing.assert_equal(got[0], observations)
            self.assertAlmostEqual(got[1]["auv_1"], total)
            np.testing.assert_equal(list(got[2:]), rest)
        self.assertEqual(skipping.agents, [])

    def test_wrappers_stack(self):
        env = wrappers.FrameSkip(wrappers.discrete_actions(stg.parallel_env(), 3, flat=True), 2)
        env.reset(seed=1)
        env.step({name: env.action_space(name).sample() for name in env.agents})
        self.assertIs(type(env.unwrapped), stg.ParallelEnv)
        with self.assertRaisesRegex(TypeError, "decision_steps"):
            wrappers.FrameSkip(stg.vector_env("medium", 2), 2)


if __name__ == "__main__":
    unittest.main()
