"""Environments keep the contracts of PettingZoo and Gymnasium, in every scenario and mode."""

import unittest

import numpy as np

import stg
from stg import contract

SHORT = {"time.episode_steps": 25, "time.tail_steps": 5}
SPEED = "reset.stages.medium.target_speed_mps"


class Parallel(unittest.TestCase):
    def test_contract_in_every_scenario(self):
        for name in stg.scenario_names():
            with self.subTest(name):
                contract.check_parallel(lambda name=name: stg.parallel_env(name, overrides=SHORT))

    def test_contract_in_both_modes_and_both_action_interfaces(self):
        for changed in ({"mode": "truth"}, {"mode": "acoustic"}, {"control.interface": "tau6"}):
            with self.subTest(changed):
                contract.check_parallel(
                    lambda changed=changed: stg.parallel_env(overrides={**SHORT, **changed})
                )

    def test_an_episode_has_its_length_and_ends_by_truncation_with_metrics(self):
        env = stg.parallel_env(overrides=SHORT)
        env.reset(seed=1)
        total = 0.0
        for _ in range(25):
            self.assertEqual(len(env.agents), 4)
            actions = {name: np.zeros(3, np.float32) for name in env.agents}
            _, rewards, terminations, truncations, infos = env.step(actions)
            total += sum(rewards.values())
        self.assertEqual(env.agents, [])
        self.assertTrue(all(truncations.values()) and not any(terminations.values()))
        metrics = infos["auv_0"]["metrics"]
        self.assertEqual(metrics["steps"] if "steps" in metrics else 25, 25)
        self.assertAlmostEqual(metrics["return"], total, places=3)

    def test_last_observation_and_state_are_those_of_the_old_episode(self):
        """An episode cut at 25 equals the first 25 steps of a longer one."""
        shorter, longer = stg.parallel_env(overrides=SHORT), stg.parallel_env()
        shorter.reset(seed=4)
        longer.reset(seed=4)
        for _ in range(25):
            actions = {n: longer.action_space(n).sample() for n in longer.agents}
            a, b = shorter.step(actions), longer.step(actions)
            np.testing.assert_equal(a[:3], b[:3])
            self.assertTrue(np.array_equal(shorter.state(), longer.state()))

    def test_results_are_the_callers_to_keep(self):
        env = stg.parallel_env()
        observations, _ = env.reset(seed=1)
        kept, state = {k: v.copy() for k, v in observations.items()}, env.state()
        held = state.copy()
        env.step({name: np.ones(3, np.float32) for name in env.agents})
        np.testing.assert_equal(observations, kept)
        self.assertTrue(np.array_equal(state, held))

    def test_overrides_and_conditions_reach_the_scenario(self):
        env = stg.parallel_env("hard", "fast_target", {"agents": 5, "time": {"episode_steps": 120}})
        self.assertEqual(len(env.possible_agents), 5)
        self.assertEqual(env.scenario["time.episode_steps"], 120)
        self.assertEqual(env.scenario["reset.stage"], "hard")
        self.assertNotEqual(env.scenario[SPEED], stg.load_scenario("hard")[SPEED])
        with self.assertRaisesRegex(stg.UserError, "time.episode_step"):
            stg.parallel_env(overrides={"time.episode_step": 3})
        with self.assertRaisesRegex(stg.UserError, "there are"):
            stg.parallel_env("mediun")


class Vector(unittest.TestCase):
    def test_contract_in_every_scenario(self):
        for name in stg.scenario_names():
            with self.subTest(name):
                contract.check_vector(lambda name=name: stg.vector_env(name, 6, overrides=SHORT))

    def test_contract_in_both_modes_and_for_every_option(self):
        for options in (
            {"overrides": {**SHORT, "mode": "truth"}},
            {"overrides": {**SHORT, "mode": "acoustic"}, "workers": 2},
            {"overrides": SHORT, "condition": ["nominal", "fast_target"]},
            {"overrides": SHORT, "rewards": "agent"},
            {"overrides": SHORT, "copy": False},
            {"overrides": {**SHORT, "reset.curriculum": True}, "curriculum": False},
        ):
            with self.subTest(options):
                contract.check_vector(lambda options=options: stg.vector_env("medium", 9, **options))

    def test_a_curriculum_is_followed_only_where_there_is_one_and_it_is_asked_for(self):
        on = {**SHORT, "reset.curriculum": True}
        with self.assertRaisesRegex(stg.UserError, "curriculum: the scenario has none"):
            stg.vector_env("medium", 4, overrides=SHORT, curriculum=True)
        with self.assertRaisesRegex(stg.UserError, "True follows it in training, False starts all"):
            stg.vector_env("medium", 4, overrides=on)
        with self.assertRaisesRegex(stg.UserError, "parallel_env has no training to follow"):
            stg.parallel_env("medium", overrides=on)
        starts = [
            stg.vector_env("medium", 4, overrides=on, curriculum=asked, seed=1).reset()[0]
            for asked in (True, False)
        ]
        self.assertFalse(np.array_equal(*starts))

    def test_true_states_are_refused_where_they_have_no_effect(self):
        env = stg.vector_env("medium", 4, overrides={**SHORT, "mode": "truth"})
        env.reset(seed=0)
        with self.assertRaisesRegex(stg.UserError, "privileged: .* has the mode truth"):
            env.controller_actions("pursuit", privileged=True)
        with self.assertRaisesRegex(stg.UserError, "privileged: .* has the mode truth"):
            stg.evaluate("pursuit", "medium", overrides={"mode": "truth"}, episodes=1, privileged=True)

    def test_a_key_that_two_overrides_set_is_refused(self):
        with self.assertRaisesRegex(stg.UserError, "agents: is also set by"):
            stg.load_scenario("medium", overrides=["agents=3", "agents=4"])

    def test_rewards_of_the_team_are_the_mean_of_the_agents(self):
        env = stg.vector_env("medium", 5)
        env.reset(seed=0)
        _, rewards, _, _, infos = env.step(env.action_space.sample())
        self.assertEqual(infos["agent_rewards"].shape, (5, 4))
        np.testing.assert_allclose(rewards, infos["agent_rewards"].mean(axis=1), rtol=1e-6)
        env = stg.vector_env("medium", 5, rewards="agent")
        env.reset(seed=0)
        self.assertEqual(env.step(env.action_space.sample())[1].shape, (5, 4))

    def test_conditions_of_a_mix_take_turns_in_blocks_of_four(self):
        env = stg.vector_env("medium", 12, condition=["nominal", "fast_target"])
        speeds = [env.scenario(e)[SPEED] for e in range(12)]
        self.assertEqual(speeds[:4] + speeds[8:], [speeds[0]] * 8)
        self.assertEqual(speeds[4:8], [speeds[4]] * 4)
        self.assertNotEqual(speeds[0], speeds[4])
        with self.assertRaisesRegex(stg.UserError, "2 scenarios need more environments"):
            stg.vector_env("medium", 4, condition=["nominal", "fast_target"])

    def test_seeding_one_environment_leaves_the_others_alone(self):
        a, b = stg.vector_env("medium", 6), stg.vector_env("medium", 6)
        for env in (a, b):
            env.reset(seed=1)
        actions = a.action_space.sample()
        for env in (a, b):
            env.step(actions)
        mask = np.arange(6) == 4
        observations, _ = a.reset(seed=[None] * 4 + [77, None], options={"reset_mask": mask})
        alone, _ = stg.parallel_env("medium").reset(seed=77)
        self.assertTrue(np.array_equal(observations[4], np.stack(list(alone.values()))))
        after_a, after_b = a.step(actions)[0], b.step(actions)[0]
        self.assertTrue(np.array_equal(after_a[~mask], after_b[~mask]))
        self.assertFalse(np.array_equal(after_a[mask], after_b[mask]))

    def test_next_episodes_follow_the_rule_of_seeds(self):
        env = stg.vector_env("medium", 3, overrides=SHORT)
        env.reset(seed=100)
        self.assertEqual([env.episode_seed(e) for e in range(3)], [100, 101, 102])
        for _ in range(25):
            env.step(np.zeros((3, 4, 3), np.float32))
        self.assertEqual([env.episode_seed(e) for e in range(3)], [103, 104, 105])
        env.reset()
        self.assertEqual([env.episode_seed(e) for e in range(3)], [106, 107, 108])

    def test_results_can_be_kept_unless_the_caller_asks_for_none(self):
        for copy in (True, False):
            env = stg.vector_env("medium", 4, copy=copy)
            first, _ = env.reset(seed=1)
            before = first.copy()
            env.step(np.ones((4, 4, 3), np.float32))
            self.assertEqual(np.array_equal(first, before), copy)

    def test_arrays_of_the_caller_are_written_to(self):
        own = {"observations": np.zeros((4, 4, 74), np.float32), "truncated": np.zeros(4, bool)}
        env = stg.vector_env("medium", 4, arrays=own)
        observations, _ = env.reset(seed=1)
        self.assertIs(observations, own["observations"])
        self.assertTrue(np.any(own["observations"]))
        for wrong in (
            np.zeros((4, 4, 73), np.float32),
            np.zeros((4, 4, 74)),
            np.zeros((4, 4, 148), np.float32)[:, :, ::2],
        ):
            with self.assertRaisesRegex((TypeError, ValueError), "observations"):
                stg.vector_env("medium", 4, arrays={"observations": wrong})
        frozen = np.zeros((4, 4, 74), np.float32)
        frozen.setflags(write=False)
        with self.assertRaisesRegex(ValueError, "read-only"):
            stg.vector_env("medium", 4, arrays={"observations": frozen})

    def test_final_info_holds_the_metrics_of_what_ended(self):
        env = stg.vector_env("medium", 4, overrides=SHORT, stagger=True)
        env.reset(seed=1)
        returns = np.zeros(4)
        for _ in range(25):
            _, _, _, ended, infos = env.step(env.action_space.sample())
            returns += infos["agent_rewards"].sum(axis=1)
        self.assertTrue(ended.all())
        np.testing.assert_allclose(infos["final_info"]["return"], returns, rtol=1e-5)

    def test_float64_actions_act_as_float32_ones_of_the_same_value(self):
        a, b = stg.vector_env("medium", 4), stg.vector_env("medium", 4)
        actions = a.action_space.sample()
        for env in (a, b):
            env.reset(seed=1)
        strided = np.repeat(actions, 2, axis=2)[:, :, ::2]
        self.assertTrue(np.array_equal(a.step(actions.astype(np.float64))[0], b.step(strided)[0]))


if __name__ == "__main__":
    unittest.main()
