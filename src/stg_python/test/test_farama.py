"""Gymnasium's and PettingZoo's own testers, where those packages are.

Neither is a Debian package. STG_FARAMA names a folder with `gymnasium` and `pettingzoo` in it, for
example of their repositories; without it they are looked for as installed packages.
"""

import os
import subprocess
import sys
import unittest

PROGRAM = """
import os, sys, warnings
sys.path[:0] = [f for f in os.environ.get("STG_FARAMA", "").split(":") if f]
try:
    import gymnasium, pettingzoo
except ImportError as error:
    print("absent:", error)
    sys.exit()
gymnasium.make("stg:stg/Team-v1").reset(seed=4)  # imports stg
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers.vector import RecordEpisodeStatistics
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test
from pettingzoo.utils.conversions import parallel_to_aec
import numpy, stg
from stg import wrappers
short = {"time.episode_steps": 60, "time.tail_steps": 10}
forms = (
    lambda: stg.parallel_env(overrides=short),
    lambda: stg.parallel_env("hard", "combined_stress", render_mode="rgb_array"),
    lambda: wrappers.discrete_actions(stg.parallel_env(overrides=short), flat=True),
    lambda: wrappers.FrameSkip(stg.parallel_env(overrides=short), 4),
)
for make in forms:
    parallel_api_test(make(), num_cycles=200)
    parallel_seed_test(make, num_cycles=50)
    api_test(parallel_to_aec(make()), num_cycles=50)
# Observations have no finite bounds, which the checker calls uncommon.
warnings.filterwarnings("ignore", module="gymnasium")
warnings.filterwarnings("ignore", ".*(minimum|maximum) value.*")
check_env(wrappers.joint(stg.parallel_env(overrides=short)), skip_render_check=True)
envs = RecordEpisodeStatistics(stg.vector_env("medium", 5, overrides=short))
envs.reset(seed=1)
total = numpy.zeros(5)
for _ in range(60):
    _, rewards, _, truncated, infos = envs.step(envs.action_space.sample())
    total += rewards
assert truncated.all() and (infos["episode"]["l"] == 60).all(), infos
assert numpy.allclose(infos["episode"]["r"], total, atol=1e-3)
team = gymnasium.make("stg/Team-v1", scenario="hard", overrides=short)
assert team.reset(seed=4)[0].shape == (4 * 74,) and team.step(team.action_space.sample())[3] is False
many = gymnasium.make_vec("stg/Team-v1", num_envs=6, condition="combined_stress")
assert isinstance(many.unwrapped, gymnasium.vector.VectorEnv)
assert many.reset(seed=4)[0].shape == (6, 4 * 74)
from stg import swarm_v1
api_test(swarm_v1.env(overrides=short), num_cycles=50)
if hasattr(pettingzoo, "make"):  # 1.27
    parallel_api_test(pettingzoo.make("parallel", "stg/Swarm-v1", scenario="hard", overrides=short), num_cycles=50)
    api_test(pettingzoo.make("aec", "stg/Swarm-v1", overrides=short), num_cycles=50)
print("all passed")
"""


class Farama(unittest.TestCase):
    def test_their_own_testers_pass(self):
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            universal_newlines=True, check=False, env=os.environ,
        )  # fmt: skip
        last = (done.stdout.splitlines() or [""])[-1]
        if last.startswith("absent:"):
            self.skipTest(last)
        self.assertEqual((done.returncode, last), (0, "all passed"), done.stdout)


if __name__ == "__main__":
    unittest.main()
