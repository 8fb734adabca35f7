"""The same seed and actions give the same bits as C++, for any number of environments and workers."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import stg
from stg import _core

SETTINGS = {"time.episode_steps": 30, "time.tail_steps": 5}
STEPS = 70  # two autoresets


def program():
    """Returns the path of the C++ program: test/reference.cpp."""
    built = pathlib.Path(_core.__file__).resolve().parents[3] / "stg_python" / "stg_python_reference"
    return os.environ.get("STG_PYTHON_REFERENCE", str(built))


def by_cpp(scenario, conditions, actions, seed, changed):
    """Returns the bytes that C++ writes for actions [STEPS, envs, agents, action_size]."""
    with tempfile.TemporaryDirectory() as folder:
        given, out = pathlib.Path(folder, "actions"), pathlib.Path(folder, "out")
        actions.tofile(given)
        subprocess.run(
            [program(), scenario, ",".join(conditions), str(actions.shape[1]), str(seed), given, out]
            + [f"{key}={value}" for key, value in changed.items()],
            check=True,
            env={**os.environ, "STG_SCENARIOS": stg.scenario_folder()},
        )
        return out.read_bytes()


def by_python(env, actions, seed):
    """Returns the same bytes from an environment of this module."""
    result = bytearray()

    def write():
        for name in ("observations", "states", "rewards", "team_rewards", "truncated",
                     "final_observations", "final_states"):  # fmt: skip
            result.extend(env.arrays[name].tobytes())

    env.reset(seed=seed)
    write()
    for row in actions:
        env.step(row)
        write()
    return bytes(result)


class SameBits(unittest.TestCase):
    def compare(self, scenario, conditions, envs, workers, **changed):
        """Flies both and compares everything that they write."""
        changed = {**SETTINGS, **changed}
        s = stg.load_scenario(scenario, overrides=changed)
        shape = (STEPS, envs, s.agents, s.action_size)
        actions = np.random.default_rng(envs).uniform(-1.2, 1.2, shape).astype(np.float32)
        wanted = by_cpp(scenario, conditions, actions, 7, changed)
        for count in workers:
            env = stg.vector_env(
                scenario, envs, condition=list(conditions), overrides=changed, workers=count
            )
            self.assertEqual(by_python(env, actions, 7), wanted, f"{count} workers")

    def test_acoustic_mode(self):
        self.compare("medium", ["nominal"], 13, (1, 2, 3, 16))

    def test_truth_mode(self):
        self.compare("medium", ["nominal"], 8, (1, 2), mode="truth")

    def test_a_mix_of_conditions(self):
        self.compare("hard", ["nominal", "combined_stress", "limited_sensing"], 22, (1, 2, 4))

    def test_forces_as_actions(self):
        self.compare("medium_release", ["nominal"], 5, (1, 2), **{"control.interface": "tau6"})

    def test_one_environment_by_name_is_the_vector_environment(self):
        envs = stg.vector_env("medium", 6, overrides=SETTINGS)
        observations, _ = envs.reset(seed=50)
        alone = stg.parallel_env("medium", overrides=SETTINGS)
        first, _ = alone.reset(seed=53)  # the world of environment 3
        self.assertTrue(np.array_equal(np.stack(list(first.values())), observations[3]))
        for _ in range(30):
            actions = envs.action_space.sample()
            observations, _, _, ended, infos = envs.step(actions)
            o, r, _, _, _ = alone.step(dict(zip(alone.agents, actions[3])))
            if ended[3]:
                observations = infos["final_obs"]
            self.assertTrue(np.array_equal(np.stack(list(o.values())), observations[3]))
            self.assertTrue(np.array_equal(list(r.values()), infos["agent_rewards"][3].astype(float)))
        self.assertEqual(alone.agents, [])

    def test_evaluation_is_that_of_flying_it(self):
        """stg.evaluate's mean return is that of the same episodes flown step by step."""
        env = stg.vector_env("medium", 4, overrides=SETTINGS)
        env.reset(seed=3000)
        for _ in range(30):
            _, _, _, ended, infos = env.step(env.controller_actions("pursuit").astype(np.float64))
        self.assertTrue(ended.all())
        flown = infos["final_info"]["return"].mean()
        wanted = stg.evaluate("pursuit", overrides=SETTINGS, episodes=4)["return"]
        self.assertAlmostEqual(flown, wanted, delta=1e-5 * abs(wanted))


if __name__ == "__main__":
    unittest.main()
