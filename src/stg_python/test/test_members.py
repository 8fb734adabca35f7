"""Members leave a swarm and join it: `agents` shrinks and grows."""

import unittest

import numpy as np

import stg
from stg import contract

CHANGES = {
    "time.episode_steps": 30,
    "time.tail_steps": 5,
    "fleet.leave": [[5, 1], [8, 3], [20, 1]],
    "fleet.join": [[12, 1]],
}


def zeros(env):
    return {name: np.zeros(3, np.float32) for name in env.agents}


class Members(unittest.TestCase):
    def test_contract(self):
        contract.check_parallel(lambda: stg.parallel_env("field", overrides=CHANGES))

    def test_agents_shrink_and_grow_and_never_come_back(self):
        env = stg.parallel_env("field", overrides=CHANGES)
        env.reset(seed=1)
        flew, ended = [], {}
        while env.agents:
            flew.append(list(env.agents))
            _, _, terminations, truncations, _ = env.step(zeros(env))
            ended.update({n: len(flew) for n, gone in terminations.items() if gone})
        self.assertEqual(len(flew), 30)
        self.assertEqual(ended, {"auv_1": 5, "auv_3": 8, "auv_1_2": 20})
        self.assertEqual(flew[4], ["auv_0", "auv_1", "auv_2", "auv_3"])
        self.assertEqual(flew[5], ["auv_0", "auv_2", "auv_3"])
        self.assertEqual(flew[8], ["auv_0", "auv_2"])
        self.assertEqual(flew[12], ["auv_0", "auv_1_2", "auv_2"])
        self.assertEqual(flew[20], ["auv_0", "auv_2"])
        self.assertTrue(all(truncations.values()))

    def test_who_has_left_is_neither_heard_nor_paid(self):
        env = stg.parallel_env("field", overrides={**CHANGES, "fleet.join": []})
        env.reset(seed=1)
        for _ in range(10):
            _, rewards, *_ = env.step(env.controller_actions("encircle"))
        self.assertEqual(set(rewards), {"auv_0", "auv_2"})
        with self.assertRaisesRegex(ValueError, "not of auv_1"):
            env.step({**zeros(env), "auv_1": np.zeros(3, np.float32)})

    def test_an_agent_that_never_left_does_not_join(self):
        with self.assertRaisesRegex(stg.UserError, "can only join after it has left"):
            stg.load_scenario("field", "nominal", {"fleet.join": [[3, 1]]})
        with self.assertRaisesRegex(stg.UserError, "mode acoustic"):
            stg.load_scenario("field", "nominal", {"mode": "truth", "fleet.leave": [[3, 1]]})


if __name__ == "__main__":
    unittest.main()
