"""Many environments at once, in the forms of Gymnasium's vector environments."""

import numpy as np

from stg import _core, spaces
from stg.scenarios import load_scenario

__all__ = ["VectorEnv", "vector_env"]

try:
    from gymnasium.vector import VectorEnv as _Base
except ImportError:

    class _Base:
        """Stands in for gymnasium.vector.VectorEnv."""

        spec = None
        render_mode = None
        closed = False

        @property
        def unwrapped(self):
            """The environment without wrappers: itself."""
            return self


try:
    from gymnasium.vector import AutoresetMode

    SAME_STEP = AutoresetMode.SAME_STEP
except ImportError:
    SAME_STEP = "SameStep"  # the value of Gymnasium's constant


def _mix(scenario, condition, overrides):
    """Returns the list of scenarios of a mix. Each of the three may be a list."""
    if isinstance(overrides, (list, tuple)) and all(isinstance(x, str) for x in overrides):
        overrides = [overrides]  # overrides of one scenario, as texts
    given = [x if isinstance(x, (list, tuple)) else [x] for x in (scenario, condition, overrides)]
    count = max(map(len, given))
    if any(len(x) not in (1, count) for x in given):
        raise ValueError("scenario, condition and overrides: lists of a mix must agree in length")
    return [load_scenario(*(x[k % len(x)] for x in given)) for k in range(count)]


def seed_of(seed, name="seed"):
    """Returns a seed as an int; raises TypeError or ValueError for what is none."""
    if isinstance(seed, (bool, np.bool_)) or not isinstance(seed, (int, np.integer)):
        raise TypeError(f"{name}: expected an integer, not {type(seed).__name__}")
    if not 0 <= int(seed) < 2**63:
        raise ValueError(f"{name}: {seed} is not in [0, 2^63)")
    return int(seed)


class VectorEnv(_Base):
    """`num_envs` swarms, each in its own episode; see docs/environment.md for every number.

    One of Gymnasium's environments is a whole swarm: N AUVs, observations of K numbers each, A
    actions each. Episodes end by truncation alone and restart in the same step.

    observations  [num_envs, N, K] float32, for the next decision
    actions       [num_envs, N, A] float32 or float64, clipped to [-1, 1]
    rewards       [num_envs] float32, mean over the AUVs; or [num_envs, N] with rewards="agent"
    terminations  [num_envs] bool, never true
    truncations   [num_envs] bool, true where the decision ended the episode
    infos         "state" [num_envs, S], the true state for a critic, at the next decision;
                  "agent_rewards" [num_envs, N]; and where episodes ended "final_obs"
                  [num_envs, N, K] and "final_info" with "state" [num_envs, S] and every
                  metric [num_envs]. "_name" is the mask of the valid rows of "name".

    A step that raises an exception has no effect. Only one thread at a time may use an environment,
    and only in the process that made it. It releases the GIL, so other Python threads can run.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10, "autoreset_mode": SAME_STEP}

    def __init__(
        self, scenario="medium", num_envs=4, *, condition="nominal", overrides=None, workers=1,
        seed=0, rewards="team", copy=True, arrays=None, curriculum=None, stagger=False,
        render_mode=None,
    ):  # fmt: skip
        """See vector_env."""
        if rewards not in ("team", "agent"):
            raise ValueError(f"rewards: must be 'team' or 'agent', not {rewards!r}")
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: must be None or 'rgb_array', not {render_mode!r}")
        for name, number in (("num_envs", num_envs), ("workers", workers)):
            if isinstance(number, bool) or not isinstance(number, (int, np.integer)):
                raise TypeError(f"{name}: expected an integer, not {type(number).__name__}")
            if number >= 2**31:
                raise ValueError(f"{name}: {number} is too many")
        self.scenarios = _mix(scenario, condition, overrides)
        self._seed = seed_of(seed)
        self._core = _core.VectorEnv(
            self.scenarios, int(num_envs), int(workers), self._seed, curriculum, stagger
        )
        first = self.scenarios[0]
        self.num_envs, self.agents = int(num_envs), first.agents
        self.render_mode = render_mode
        self._copy, self._per_agent = bool(copy) and arrays is None, rewards == "agent"
        seen = (first.agents, first.observation_size)
        self._arrays = self._make_arrays(seen, first.state_size, arrays)
        self._core.bind(self._arrays)
        self._terminations = np.zeros(self.num_envs, bool)
        self._everywhere = np.ones(self.num_envs, bool)
        self._started = False
        self.single_observation_space = spaces.Box(-np.inf, np.inf, seen, np.float32)
        self.single_action_space = spaces.Box(-1.0, 1.0, (first.agents, first.action_size), np.float32)
        self.observation_space = spaces.batch_space(self.single_observation_space, self.num_envs)
        self.action_space = spaces.batch_space(self.single_action_space, self.num_envs)

    def _make_arrays(self, seen, state_size, given):
        """Returns all arrays by name: given ones, or new ones."""
        n = self.num_envs
        arrays = {
            "observations": np.zeros((n, *seen), np.float32),
            "states": np.zeros((n, state_size), np.float32),
            "rewards": np.zeros((n, seen[0]), np.float32),
            "team_rewards": np.zeros(n, np.float32),
            "truncated": np.zeros(n, bool),
            "final_observations": np.zeros((n, *seen), np.float32),
            "final_states": np.zeros((n, state_size), np.float32),
        }
        unknown = set(given or ()) - set(arrays)
        if unknown:
            raise ValueError(f"arrays: {sorted(unknown)} are not among {sorted(arrays)}")
        return {**arrays, **(given or {})}

    @property
    def arrays(self):
        """{name: array} that every call writes to: the caller's, or those made here."""
        return dict(self._arrays)

    def _given(self, name):
        """Returns an array in the form that the caller gets."""
        array = self._arrays[name]
        return array.copy() if self._copy else array

    def _infos(self):
        return {"state": self._given("states"), "_state": self._everywhere}

    def reset(self, *, seed=None, options=None):
        """Starts an episode of every environment; returns (observations, infos).

        seed: an integer S: environment e starts with the seed S + e, and its k-th episode after that
        has the seed S + e + k num_envs. A list: a seed for each environment; None: its next
        episode. None: the next episode of every environment. options: {"reset_mask": [num_envs]
        bool}: only these environments start an episode; each of them needs a seed.
        """
        mask = self._mask(options)
        seeds = self._seeds(seed)
        if mask is not None:
            if any(seeds[e] is None for e in np.flatnonzero(mask)) or not self._started:
                raise ValueError("reset_mask: needs a reset before, and a seed for each environment")
            for e in np.flatnonzero(mask):
                self._core.reset_env(int(e), seeds[e])
            return self._given("observations"), self._infos()
        if isinstance(seed, (int, np.integer)):
            self._seed, k = seeds[0], 0
            self._core.reseed(self._seed)
        else:
            k = 1 + max(map(self._core.round, range(self.num_envs))) if self._started else 0
        self._core.restart_at(k)
        if isinstance(seed, (list, tuple, np.ndarray)):
            for e, s in enumerate(seeds):
                if s is not None:
                    self._core.reset_env(e, s)
        self._started = True
        return self._given("observations"), self._infos()

    def _mask(self, options):
        unknown = set(options or ()) - {"reset_mask"}
        if unknown:
            raise ValueError(f"options: {sorted(unknown)} are not known")
        if not options:
            return None
        mask = np.asarray(options["reset_mask"])
        if mask.dtype != bool or mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask: expected {self.num_envs} bools")
        return mask

    def _seeds(self, seed):
        """Returns the world seeds of all environments."""
        if isinstance(seed, (list, tuple, np.ndarray)):
            if len(seed) != self.num_envs:
                raise ValueError(f"seed: {len(seed)} for {self.num_envs} environments")
            return [None if s is None else seed_of(s) for s in seed]
        if seed is None:
            return [None] * self.num_envs
        return [seed_of(seed) + e for e in range(self.num_envs)]

    def step(self, actions):
        """One decision of every AUV.

        actions: [num_envs, N, A] float32 or float64. Returns (observations, rewards, terminations,
        truncations, infos). Raises TypeError or ValueError for another kind of array, or for a number
        that is not finite.
        """
        if not self._started:
            raise RuntimeError("reset must come before the first step")
        ended = self._core.step(actions)
        infos = self._infos()
        infos["agent_rewards"], infos["_agent_rewards"] = self._given("rewards"), self._everywhere
        if ended:
            self._add_final(infos)
        rewards = infos["agent_rewards"] if self._per_agent else self._given("team_rewards")
        return (
            self._given("observations"), rewards, self._terminations.copy(),
            self._given("truncated"), infos,
        )  # fmt: skip

    def _add_final(self, infos):
        """Adds observations, states and metrics of the episodes that ended."""
        ended = self._arrays["truncated"].copy()
        final = {"state": self._given("final_states"), "_state": ended}
        for e in np.flatnonzero(ended):
            for name, value in self.metrics(int(e)).items():
                if name not in final:
                    kind = np.int64 if isinstance(value, int) else np.float64
                    final[name], final["_" + name] = np.zeros(self.num_envs, kind), ended
                final[name][e] = value
        infos["final_obs"], infos["_final_obs"] = self._given("final_observations"), ended
        infos["final_info"], infos["_final_info"] = final, ended

    def metrics(self, env):
        """{metric: value} of the episode of environment `env` that ended last."""
        return self._core.metrics(env)

    def state(self):
        """The true state of every swarm [num_envs, S], a copy; for critics only, not for policies."""
        return self._arrays["states"].copy()

    def snapshot(self, env=0):
        """The true states of one swarm in SI units and world axes, for drawing; see render.Snapshot."""
        return self._core.snapshot(env)

    def entities(self, env=0, agent=0):
        """The knowledge of one AUV as rows, in acoustic mode: the layout `stg-2:entities`.

        Returns {"self": [1, 26], "search": [1, 28], "targets": [T, 40], "neighbours": [n, 22],
        "obstacles": [O, 10], "edges": [T, n, 8]}, float32. With task.assignment free
        also "target_of_row", the index of the target of each row. A policy file over entities has
        inputs of the same names.
        """
        if not self._started:
            raise RuntimeError("reset must come before entities")
        return self._core.entities(env, agent)

    def follow(self, env, agent, target):
        """AUV `agent` follows `target` from the next decision on, where task.assignment is free."""
        if not self._started:
            raise RuntimeError("reset must come before follow")
        self._core.follow(env, agent, target)

    def followed(self, env=0, agent=0):
        """The target that an AUV follows."""
        return self._core.followed(env, agent)

    def controller_actions(self, controller, privileged=False):
        """Returns the present actions of a controller [num_envs, N, A].

        controller: "pursuit", "pursuit_separated", "idle" or a policy's file. privileged: a built-in
        controller sees the truth in acoustic mode, too.
        """
        if not self._started:
            raise RuntimeError("reset must come before a decision")
        return self._core.decide(str(controller), privileged)

    def scenario(self, env=0):
        """The Scenario of environment `env`; in a mix of n scenarios, number (env // 4) mod n."""
        return self._core.scenario(env)

    def episode_seed(self, env=0):
        """World seed of the present episode of environment `env`."""
        return self._core.seed(env)

    def render(self):
        """A picture [height, width, 3] uint8 of every environment, as a tuple; see stg.render."""
        if self.render_mode is None:
            return None
        from stg.render import draw  # pylint: disable=import-outside-toplevel

        shots = [([self.snapshot(e)], self.scenario(e)) for e in range(self.num_envs)]
        return tuple(draw(history, scenario) for history, scenario in shots)

    def close_extras(self, **kwargs):
        """Frees the engine; a step after it raises RuntimeError."""
        del kwargs
        core = getattr(self, "_core", None)  # there is none if __init__ raised an exception
        if core is not None:
            core.close()

    def close(self, **kwargs):
        """Frees the engine; may be called again."""
        if not self.closed:
            self.close_extras(**kwargs)
            self.closed = True

    def __repr__(self):
        names = ", ".join(sorted({s.name for s in self.scenarios}))
        return f"<stg.VectorEnv {names}, {self.num_envs} environments of {self.agents} AUVs>"


def vector_env(scenario="medium", num_envs=4, **options):
    """Returns a VectorEnv.

    scenario      a shipped scenario's name, a YAML file, or a Scenario; a list: a mix
    num_envs      number of swarms
    condition     a stress condition's name; a list: a mix, see VectorEnv.scenario
    overrides     {"key.path": value} of docs/scenarios.md; a list: a mix
    workers       number of threads; only speed depends on it
    seed          seed of the first reset without a seed
    rewards       "team": [num_envs]; "agent": [num_envs, N]
    copy          True: returned arrays are copies. False: they are views, which the next call
                  overwrites
    arrays        {name: array} of the caller for the results (names of VectorEnv.arrays,
                  C-contiguous float32, truncated bool); the returned arrays are then views
    curriculum    needed if the scenario has one (reset.curriculum). True: easier starts first;
                  False: all episodes start at reset.stage
    stagger       first episodes of different lengths, so that not all end together
    render_mode   None or "rgb_array"
    """
    return VectorEnv(scenario, num_envs, **options)
