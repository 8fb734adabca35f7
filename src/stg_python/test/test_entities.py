"""What an AUV knows, as rows for swarms of any size, and the policy that flies them."""

import pathlib
import unittest

import numpy as np
import stg

POLICY = pathlib.Path(__file__).resolve().parents[2] / "stg_bringup" / "policies" / "field.onnx"


def field(agents, steps=40):
    return stg.vector_env("field", 4, overrides={"agents": agents, "time.episode_steps": steps,
                                                 "time.tail_steps": steps})


class Entities(unittest.TestCase):
    def test_rows_are_as_many_as_the_auv_knows_of(self):
        for agents in (1, 3, 6):
            env = field(agents)
            env.reset(seed=7)
            rows = env.entities(2, 0)
            self.assertEqual(rows["self"].shape, (1, 26))
            self.assertEqual(rows["search"].shape, (1, 28))
            self.assertEqual(rows["targets"].shape, (1, 40))
            self.assertEqual(rows["neighbours"].shape, (0, 22))  # the AUV has heard no other yet
            for _ in range(30):
                env.step(env.controller_actions("encircle"))
            rows = env.entities(2, 0)
            self.assertEqual(rows["neighbours"].shape, (agents - 1, 22))
            self.assertEqual(rows["edges"].shape, (1, agents - 1, 8))
            for name, array in rows.items():
                self.assertEqual(array.dtype, np.float32, name)
                self.assertTrue((np.abs(array) <= 3.0).all(), name)
            env.close()

    def test_one_file_flies_swarms_of_any_size(self):
        for agents in (1, 2, 5, 9):
            env = field(agents)
            env.reset(seed=3)
            law = env.controller_actions("encircle")
            actions = env.controller_actions(POLICY)
            self.assertEqual(actions.shape, law.shape)
            self.assertTrue(np.isfinite(actions).all())
            env.step(actions)
            env.close()

    def test_they_are_refused_where_truth_is_known_or_nobody_is(self):
        env = stg.vector_env("medium", 4, overrides={"mode": "truth"})
        with self.assertRaises(RuntimeError):
            env.entities()
        env.reset(seed=1)
        with self.assertRaises(ValueError):
            env.entities()
        env.close()
        env = field(3)
        env.reset(seed=1)
        with self.assertRaises(IndexError):
            env.entities(0, 3)
        env.close()


if __name__ == "__main__":
    unittest.main()
