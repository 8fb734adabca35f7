"""Other forms of the environments: discrete actions, one joint agent, fewer decisions.

discrete_actions and joint take what parallel_env or vector_env returned, or a wrapper of it;
FrameSkip takes what parallel_env returned.
"""

import itertools

import numpy as np

from stg import parallel, spaces, vector

__all__ = ["FrameSkip", "ParallelWrapper", "VectorWrapper", "discrete_actions", "joint"]

try:
    from gymnasium import Env as _Env
except ImportError:

    class _Env:
        """Stands in for gymnasium.Env."""

        spec = None
        render_mode = None

        def reset(self, *, seed=None, options=None):
            """Gymnasium's reset seeds a generator here; its tester requires this."""


def _from_env(name):
    """A method that calls the same method of the wrapped environment."""

    def call(self, *args, **kwargs):
        return getattr(self.env, name)(*args, **kwargs)

    call.__name__ = name
    call.__doc__ = f"See the wrapped environment: its {name}."
    return call


class _Wrapper:
    """Has all other attributes of the wrapped environment."""

    env = None

    def __getattr__(self, name):
        if name.startswith("_") or self.env is None:
            raise AttributeError(name)
        return getattr(self.env, name)

    reset = _from_env("reset")
    step = _from_env("step")
    render = _from_env("render")
    state = _from_env("state")
    close = _from_env("close")

    @property
    def unwrapped(self):
        """The environment without wrappers."""
        return self.env.unwrapped

    def __repr__(self):
        return f"<{type(self).__name__} of {self.env!r}>"


class ParallelWrapper(_Wrapper, parallel._Base):
    """A ParallelEnv around another one, for deriving from."""

    observation_space = _from_env("observation_space")
    action_space = _from_env("action_space")

    def __init__(self, env):
        self.env = env
        self.metadata, self.render_mode = env.metadata, env.render_mode


class VectorWrapper(_Wrapper, vector._Base):
    """A VectorEnv around another one, for deriving from."""

    def __init__(self, env):
        self.env = env
        self.metadata, self.render_mode = env.metadata, env.render_mode
        self.num_envs = env.num_envs
        self.single_observation_space = env.single_observation_space
        self.single_action_space = env.single_action_space
        self.observation_space, self.action_space = env.observation_space, env.action_space

    @property
    def closed(self):
        """Whether the wrapped environment is closed."""
        return self.env.closed


def _is_vector(env):
    if isinstance(env, (vector.VectorEnv, VectorWrapper)):
        return True
    if isinstance(env, (parallel.ParallelEnv, ParallelWrapper)):
        return False
    raise TypeError(f"expected an environment of parallel_env or vector_env, not {env!r}")


class _Bins:
    """Actions of `size` numbers, of `bins` values each, evenly spread over [-1, 1]."""

    def __init__(self, size, bins, flat):
        if bins < 2:
            raise ValueError(f"bins: must be at least 2, not {bins}")
        levels = np.linspace(-1.0, 1.0, bins, dtype=np.float32)
        self.table, self.shape = levels, (size,)
        if flat:
            self.table, self.shape = np.array(list(itertools.product(levels, repeat=size))), ()
        count = len(self.table)
        self.space = spaces.Discrete(count) if flat else spaces.MultiDiscrete([bins] * size)

    def actions(self, chosen, name, shape=()):
        """Returns actions of integers; `shape` are the extents before those of one action."""
        chosen = np.asarray(chosen)
        if chosen.dtype.kind not in "iu":
            raise TypeError(f"{name}: expected integers, not {chosen.dtype}")
        if chosen.shape != (*shape, *self.shape):
            raise ValueError(f"{name}: expected shape {(*shape, *self.shape)}, not {chosen.shape}")
        if chosen.size and not 0 <= chosen.min() <= chosen.max() < len(self.table):
            raise ValueError(f"{name}: not in 0 to {len(self.table) - 1}")
        return self.table[chosen]


class _DiscreteParallel(ParallelWrapper):
    """See discrete_actions."""

    def __init__(self, env, bins, flat):
        super().__init__(env)
        self._bins = _Bins(env.action_space(env.possible_agents[0]).shape[0], bins, flat)
        make = type(self._bins.space)
        given = self._bins.space.n if flat else self._bins.space.nvec
        self.action_spaces = {name: make(given) for name in env.possible_agents}

    def action_space(self, agent):
        """The space of one AUV's actions, the same object at every call."""
        return self.action_spaces[agent]

    def step(self, actions):
        """See ParallelEnv.step; {agent: integers}."""
        if not isinstance(actions, dict):
            raise TypeError(f"actions: expected a dictionary, not {type(actions).__name__}")
        return self.env.step({k: self._bins.actions(a, f"action of {k}") for k, a in actions.items()})


class _DiscreteVector(VectorWrapper):
    """See discrete_actions."""

    def __init__(self, env, bins, flat):
        super().__init__(env)
        self._agents, size = env.single_action_space.shape
        self._bins = _Bins(size, bins, flat)
        each = len(self._bins.table) if flat else bins
        shape = (self._agents,) if flat else (self._agents, size)
        self.single_action_space = spaces.MultiDiscrete(np.full(shape, each))
        self.action_space = spaces.batch_space(self.single_action_space, self.num_envs)

    def step(self, actions):
        """See VectorEnv.step; integers [num_envs, N] or [num_envs, N, A]."""
        return self.env.step(self._bins.actions(actions, "actions", (self.num_envs, self._agents)))


def discrete_actions(env, bins=3, flat=False):
    """Returns the environment with integers for actions.

    bins: values of each number, evenly spread over [-1, 1], so that 3 are -1, 0 and 1.
    flat: False: MultiDiscrete, one integer per number. True: Discrete, one integer for all numbers
    of an AUV, the last number counting fastest.
    """
    return (_DiscreteVector if _is_vector(env) else _DiscreteParallel)(env, bins, flat)


class _JointEnv(_Wrapper, _Env):
    """See joint: a gymnasium.Env."""

    def __init__(self, env):
        self.env = env
        self.metadata, self.render_mode = env.metadata, env.render_mode
        self._names = list(env.possible_agents)
        seen = env.observation_space(self._names[0])
        done = env.action_space(self._names[0])
        n = len(self._names)
        self.observation_space = spaces.Box(-np.inf, np.inf, (n * seen.shape[0],), np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (n * done.shape[0],), np.float32)

    @property
    def unwrapped(self):
        """The environment itself: only this one is a Gymnasium environment."""
        return self

    def reset(self, *, seed=None, options=None):
        """Returns (observation, info)."""
        _Env.reset(self, seed=seed)
        observations, _ = self.env.reset(seed=seed, options=options)
        return np.concatenate(list(observations.values())), {"state": self.env.state()}

    def step(self, action):
        """Returns (observation, mean reward, False, truncated, info)."""
        action = np.asarray(action)
        if action.shape != self.action_space.shape:
            raise ValueError(f"action: expected shape {self.action_space.shape}, not {action.shape}")
        actions = dict(zip(self._names, action.reshape(len(self._names), -1)))
        observations, rewards, _, truncations, infos = self.env.step(actions)
        info = {"state": self.env.state(), "agent_rewards": rewards, **infos[self._names[0]]}
        reward = sum(rewards.values()) / len(rewards)
        return (
            np.concatenate(list(observations.values())), reward, False, truncations[self._names[0]],
            info,
        )  # fmt: skip


class _JointVector(VectorWrapper):
    """See joint: a vector environment."""

    def __init__(self, env):
        super().__init__(env)
        size, wanted = (int(np.prod(s.shape)) for s in (env.single_observation_space,
                                                        env.single_action_space))  # fmt: skip
        self.single_observation_space = spaces.Box(-np.inf, np.inf, (size,), np.float32)
        self.single_action_space = spaces.Box(-1.0, 1.0, (wanted,), np.float32)
        self.observation_space = spaces.batch_space(self.single_observation_space, self.num_envs)
        self.action_space = spaces.batch_space(self.single_action_space, self.num_envs)

    def reset(self, *, seed=None, options=None):
        """See VectorEnv.reset."""
        observations, infos = self.env.reset(seed=seed, options=options)
        return observations.reshape(self.num_envs, -1), infos

    def step(self, actions):
        """See VectorEnv.step; actions [num_envs, N A]."""
        actions = np.asarray(actions)
        if actions.shape != self.action_space.shape:
            raise ValueError(f"actions: expected shape {self.action_space.shape}, not {actions.shape}")
        split = actions.reshape(self.num_envs, *self.env.single_action_space.shape)
        observations, *rest, infos = self.env.step(split)
        if "final_obs" in infos:
            infos["final_obs"] = infos["final_obs"].reshape(self.num_envs, -1)
        return observations.reshape(self.num_envs, -1), *rest, infos


def joint(env):
    """Returns the team as one agent: observations [N K] and actions [N A] after each other.

    Of parallel_env: a gymnasium.Env with the mean of the rewards. Of vector_env: a vector one.
    """
    one = env.single_action_space if _is_vector(env) else env.action_space(env.possible_agents[0])
    if not hasattr(one, "low"):
        raise TypeError(f"joint needs actions of numbers, not {one}")
    return (_JointVector if _is_vector(env) else _JointEnv)(env)


class FrameSkip(ParallelWrapper):
    """Repeats each action for `count` decisions; returns summed rewards and the last observation.

    The end of an episode also ends the repetition. Vector environments, whose swarms may end at
    different times, repeat actions in the engine: overrides={"time.decision_steps": count}.
    """

    def __init__(self, env, count):
        super().__init__(env)
        if count < 1:
            raise ValueError(f"count: must be at least 1, not {count}")
        if _is_vector(env):
            raise TypeError("for vector environments: overrides={'time.decision_steps': count}")
        self.count = count

    def step(self, actions):
        """See ParallelEnv.step."""
        sums = dict.fromkeys(self.env.agents, 0.0)
        for _ in range(self.count):
            observations, rewards, *rest = self.env.step(actions)
            sums = {name: sums[name] + rewards[name] for name in rewards}
            if not self.env.agents:
                break
        return observations, sums, *rest
