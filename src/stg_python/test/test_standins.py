"""Where Gymnasium and PettingZoo can be imported, environments and spaces are theirs.

Neither is a Debian package, so stand-ins of the same names and shapes take their places here.
"""

import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

from stg import spaces

FILES = {
    # Imported in the middle of itself, the module of spaces falls back to its own classes.
    "gymnasium/spaces.py": """
        import importlib.util
        spec = importlib.util.spec_from_file_location("own_spaces", {spaces!r})
        own = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(own)
        Box, Discrete, MultiDiscrete = own._Box, own._Discrete, own._MultiDiscrete
    """,
    "gymnasium/__init__.py": """
        class Env:
            _np_random = None
            spec = render_mode = None

            @property
            def unwrapped(self):
                return self

            def reset(self, *, seed=None, options=None):
                self._np_random = seed
    """,
    "gymnasium/vector/utils.py": "from gymnasium.spaces import own\nbatch_space = own._batch\n",
    "gymnasium/vector/__init__.py": """
        import enum

        class AutoresetMode(enum.Enum):
            SAME_STEP = "SameStep"

        class VectorEnv:
            metadata = {{}}
            spec = render_mode = None
            closed = False

            @property
            def unwrapped(self):
                return self

            def close(self, **kwargs):
                if not self.closed:
                    self.close_extras(**kwargs)
                    self.closed = True

            def __del__(self):
                if not getattr(self, "closed", True):
                    self.close()
    """,
    "pettingzoo/__init__.py": """
        class ParallelEnv:
            agents: list
            possible_agents: list

            num_agents = property(lambda self: len(self.agents))
            max_num_agents = property(lambda self: len(self.possible_agents))
            unwrapped = property(lambda self: self)

            def state(self):
                raise NotImplementedError

            reset = step = render = observation_space = action_space = state
    """,
}
PROGRAM = """
import gymnasium, pettingzoo, stg
from stg import contract, spaces, wrappers
short = {"time.episode_steps": 25, "time.tail_steps": 5}
one = lambda: stg.parallel_env(overrides=short)
many = lambda: stg.vector_env("medium", 5, overrides=short)
assert spaces.have_gymnasium and spaces.Box is gymnasium.spaces.Box
for env in (one(), wrappers.discrete_actions(one()), wrappers.FrameSkip(one(), 2)):
    assert isinstance(env, pettingzoo.ParallelEnv), env
for env in (many(), wrappers.discrete_actions(many()), wrappers.joint(many())):
    assert isinstance(env, gymnasium.vector.VectorEnv), env
    assert env.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.SAME_STEP
    assert isinstance(env.action_space, (gymnasium.spaces.Box, gymnasium.spaces.MultiDiscrete))
team = wrappers.joint(one())
assert isinstance(team, gymnasium.Env)
team.reset(seed=3)
assert team._np_random == 3
for make in (one, lambda: wrappers.discrete_actions(one(), flat=True), lambda: wrappers.FrameSkip(one(), 4)):
    contract.check_parallel(make)
for make in (many, lambda: wrappers.discrete_actions(many()), lambda: wrappers.joint(many())):
    contract.check_vector(make)
try:
    stg.vector_env("medium", 0)
except stg.UserError:
    print("well")
"""


class Standins(unittest.TestCase):
    def test_everything_derives_from_them_and_keeps_the_contract(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in FILES.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(textwrap.dedent(text).format(spaces=spaces.__file__))
            program = f"import sys; sys.path.insert(0, {folder!r})\n{PROGRAM}"
            done = subprocess.run(
                [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                universal_newlines=True, check=False,
            )  # fmt: skip
        self.assertEqual((done.returncode, done.stdout), (0, "well\n"))


if __name__ == "__main__":
    unittest.main()
