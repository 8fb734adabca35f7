"""Policies that were made elsewhere fly: files are written, read, refused and flown."""

import pathlib
import tempfile
import unittest

import numpy as np
import torch
from torch import nn

import stg

SHORT = {"time.episode_steps": 60, "time.tail_steps": 20}
POLICIES = pathlib.Path(stg.scenario_folder()).parent / "policies"


def network(seed=0, hidden=nn.Tanh, inputs=74, actions=3):
    """Returns a small network with random weights."""
    torch.manual_seed(seed)
    return nn.Sequential(
        nn.Linear(inputs, 32), hidden(), nn.Linear(32, 16), hidden(), nn.Linear(16, actions), nn.Tanh()
    )


class Export(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name, "policy.onnx")

    def test_the_file_acts_as_the_module_with_its_normaliser(self):
        for hidden in (nn.Tanh, nn.ReLU):
            module = network(1, hidden)
            mean = np.linspace(-1.0, 1.0, 74, dtype=np.float32)
            std = np.linspace(0.5, 2.0, 74, dtype=np.float32)
            stg.export_policy(
                module, self.path, "medium", observation_mean=mean, observation_std=std,
                observation_clip=1.5, action_scale=0.5,
            )  # fmt: skip
            policy = stg.load_policy(self.path)
            seen = np.random.default_rng(0).normal(0.0, 3.0, (7, 5, 74)).astype(np.float32)
            normal = np.clip((seen - mean) / std, -1.5, 1.5)
            with torch.no_grad():
                wanted = 0.5 * module(torch.from_numpy(normal)).numpy()
            got = policy.mean(seen)
            self.assertEqual(got.shape, (7, 5, 3))
            np.testing.assert_allclose(got, wanted, atol=1e-5)
            np.testing.assert_array_equal(policy.mean(seen[2, 3]), got[2, 3])

    def test_metadata_comes_back(self):
        stg.export_policy(
            network(), self.path, "hard", id="mine", training_step=12345, seed=7,
            log_std=[-1.0, -0.5, 0.0], metrics={"lost_rate": 0.25, "note": "text"},
        )  # fmt: skip
        policy = stg.load_policy(self.path)
        scenario = stg.load_scenario("hard")
        self.assertEqual(
            policy.metadata,
            {
                "id": "mine",
                "observation_layout": scenario.observation_layout,
                "action_interface": "velocity3",
                "action_scale": 1.0,
                "scenario_hash": scenario.hash,
                "training_step": 12345,
                "seed": 7,
                "metrics": {"lost_rate": "0.25", "note": "text"},
            },
        )
        np.testing.assert_array_equal(policy.parameters["log_std"], [-1.0, -0.5, 0.0])

    def test_the_file_flies_as_the_module_does(self):
        """evaluate, which reads the file, and the network in Python see the same episodes."""
        module = network(3)
        stg.export_policy(module, self.path, "medium")
        env = stg.vector_env("medium", 4, overrides=SHORT)
        observations, _ = env.reset(seed=3000)
        for _ in range(60):
            with torch.no_grad():
                actions = module(torch.from_numpy(observations.clip(-10.0, 10.0))).numpy()
            observations, _, _, _, infos = env.step(actions)
        flown = infos["final_info"]["return"].mean()
        wanted = stg.evaluate(self.path, overrides=SHORT, episodes=4)["return"]
        self.assertAlmostEqual(flown, wanted, delta=1e-3 * abs(wanted) + 1e-3)
        # The engine's own decisions are the file's, bit for bit.
        policy = stg.load_policy(self.path)
        self.assertTrue(
            np.array_equal(env.controller_actions(self.path), policy.mean(observations))
        )

    def test_modules_that_are_no_policy_are_refused(self):
        for module, words in (
            (nn.Sequential(nn.Linear(74, 3)), "Linear"),
            (nn.Sequential(nn.Linear(74, 8), nn.Sigmoid(), nn.Linear(8, 3), nn.Tanh()), "Sigmoid"),
            (nn.Sequential(nn.Linear(74, 8), nn.Tanh(), nn.Linear(8, 3)), "Tanh at the"),
            (nn.Sequential(nn.Linear(74, 8), nn.Tanh(), nn.Linear(8, 8), nn.ReLU(),
                           nn.Linear(8, 3), nn.Tanh()), "ReLU"),
        ):  # fmt: skip
            with self.assertRaisesRegex(ValueError, words):
                stg.export_policy(module, self.path, "medium")
        with self.assertRaisesRegex(stg.UserError, "70 observations"):
            stg.export_policy(network(inputs=70), self.path, "medium")
        with self.assertRaisesRegex(stg.UserError, "2 actions"):
            stg.export_policy(network(actions=2), self.path, "medium")
        with self.assertRaisesRegex(stg.UserError, "not positive"):
            stg.export_policy(network(), self.path, "medium", observation_std=np.zeros(74))
        with self.assertRaisesRegex(stg.UserError, "action_scale"):
            stg.export_policy(network(), self.path, "medium", action_scale=2.0)
        self.assertFalse(self.path.exists())

    def test_a_module_that_acts_otherwise_than_its_layers_is_refused(self):
        class Odd(nn.Sequential):
            """Does more than its parts."""

            def forward(self, x):
                return 0.5 * super().forward(x)

        with self.assertRaisesRegex(ValueError, "would differ"):
            stg.export_policy(Odd(*network()), self.path, "medium")

    def test_a_policy_without_torch(self):
        scenario = stg.load_scenario("medium")
        weight, bias = np.full((3, 74), 0.01, np.float32), np.array([0.1, 0.2, 0.3], np.float32)
        policy = stg.Policy(
            [(weight, bias)], input_mean=np.zeros(74), input_std=np.ones(74),
            observation_layout=scenario.observation_layout, action_interface="velocity3",
        )  # fmt: skip
        np.testing.assert_allclose(policy.mean(np.zeros(74, np.float32)), np.tanh(bias), rtol=1e-6)
        policy.save(str(self.path))
        np.testing.assert_array_equal(stg.load_policy(self.path).parameters["layers"][0][0], weight)


class Load(unittest.TestCase):
    def test_shipped_policies_load_and_lose_no_target(self):
        path = POLICIES / "medium.onnx"
        policy = stg.load_policy(path)
        policy.require_fits(stg.load_scenario("medium"))
        self.assertEqual((policy.observation_size, policy.action_size), (74, 3))
        self.assertEqual(stg.evaluate(path, episodes=4)["lost_rate"], 0.0)

    def test_evaluate_refuses_keys_that_only_a_training_reads(self):
        for overrides in ({"critic.far_scale_m": 2.0}, {"reset": {"curriculum": True}}):
            with self.assertRaisesRegex(stg.UserError, "evaluate does not train"):
                stg.evaluate("pursuit", overrides=overrides, episodes=1)
        with self.assertRaisesRegex(stg.UserError, "but 'pursuit' decides"):
            stg.evaluate("pursuit", overrides={"observation.graph": False}, episodes=1)

    def test_what_is_no_policy_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.onnx")
            path.write_bytes((POLICIES / "medium.onnx").read_bytes()[:-100])
            with self.assertRaisesRegex(stg.UserError, "a.onnx"):
                stg.load_policy(path)
        with self.assertRaisesRegex(stg.UserError, "nowhere"):
            stg.load_policy("/nowhere.onnx")

    def test_observations_of_another_shape_or_type_are_refused(self):
        policy = stg.load_policy(POLICIES / "medium.onnx")
        good = np.zeros((2, 74), np.float32)
        for wrong, error in ((good[:, :73], ValueError), (good.astype(int), TypeError),
                             (good.tolist(), TypeError), (good * np.nan, ValueError)):  # fmt: skip
            with self.assertRaisesRegex(error, "observations"):
                policy.mean(wrong)
        with self.assertRaisesRegex(stg.UserError, "layout"):
            policy.require_fits(stg.load_scenario("medium", overrides={"observation.graph": False}))


if __name__ == "__main__":
    unittest.main()
