"""One swarm in the form of PettingZoo's parallel environments."""

import warnings

import numpy as np

from stg import _core, spaces
from stg.members import Members
from stg.scenarios import load_scenario
from stg.vector import seed_of

__all__ = ["ParallelEnv", "parallel_env"]

try:
    from pettingzoo import ParallelEnv as _Base
except ImportError:

    class _Base:
        """Stands in for pettingzoo.ParallelEnv."""

        render_mode = None

        @property
        def num_agents(self):
            """Number of the AUVs that fly now."""
            return len(self.agents)

        @property
        def max_num_agents(self):
            """Number of all AUVs."""
            return len(self.possible_agents)

        @property
        def unwrapped(self):
            """The environment without wrappers: itself."""
            return self


class ParallelEnv(_Base):
    """One swarm: AUV i is the agent "auv_<i>". With the keys fleet.leave and fleet.join, agents leave
    and join during an episode, and `agents` changes. The episode ends by termination for an agent
    that leaves. An AUV that joins again is another agent, "auv_<i>_2"; see Members.

    observations  [K] float32 each, for the next decision
    actions       [A] float32 or float64 each, clipped to [-1, 1]
    rewards       a float each
    terminations  true for an agent that leaves with this decision
    truncations   true for all at the last decision of an episode; `agents` is then empty
    infos         empty except at the last decision: "metrics" of the episode, one dictionary for all

    All returned arrays are copies. A step that raises an exception has no effect.
    """

    def __init__(
        self, scenario="medium", condition="nominal", overrides=None, seed=0, render_mode=None
    ):
        """See parallel_env."""
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: must be None or 'rgb_array', not {render_mode!r}")
        self.scenario = load_scenario(scenario, condition, overrides)
        self.render_mode = render_mode
        self.metadata = {
            "name": f"stg_{self.scenario.name}_v0",
            "render_modes": ["rgb_array"],
            "is_parallelizable": True,
            "render_fps": round(1.0 / self.scenario.decision_dt_s) or 1,
        }
        self._next_seed = seed_of(seed)
        self._core = _core.VectorEnv([self.scenario], 1, 1, self._next_seed)
        s = self.scenario
        self._observations = np.zeros((1, s.agents, s.observation_size), np.float32)
        self._final = np.zeros_like(self._observations)
        self._states = np.zeros((2, 1, s.state_size), np.float32)  # present and final
        self._rewards = np.zeros((1, s.agents), np.float32)
        arrays = {"observations": self._observations, "final_observations": self._final}
        arrays.update(states=self._states[0], final_states=self._states[1], rewards=self._rewards)
        self._core.bind({**arrays, "truncated": np.zeros(1, bool)})
        self._members = Members(s)
        self._auvs = [f"auv_{i}" for i in range(s.agents)]
        self._decision = 0
        self.possible_agents = self._members.names
        self.agents = []
        self._history = []
        self._ended = False
        seen = (s.observation_size,)
        self.observation_spaces = {
            name: spaces.Box(-np.inf, np.inf, seen, np.float32) for name in self.possible_agents
        }
        self.action_spaces = {
            name: spaces.Box(-1.0, 1.0, (s.action_size,), np.float32)
            for name in self.possible_agents
        }
        self.state_space = spaces.Box(-np.inf, np.inf, (s.state_size,), np.float32)

    def observation_space(self, agent):
        """The space of one AUV's observations, the same object at every call."""
        return self.observation_spaces[agent]

    def action_space(self, agent):
        """The space of one AUV's actions, the same object at every call."""
        return self.action_spaces[agent]

    def reset(self, seed=None, options=None):
        """Starts an episode; returns ({agent: observation}, {agent: info}).

        seed: of the world; None: the last seed plus one, or at first the seed of parallel_env.
        options: a dictionary. There are no options, so each key gives a warning and has no effect;
        PettingZoo's contract requires that any key is accepted.
        """
        if options is not None and not isinstance(options, dict):
            raise TypeError(f"options: expected a dictionary, not {type(options).__name__}")
        if options:
            names = ", ".join(map(str, options))
            warnings.warn(f"reset: there are no options; {names} had no effect", stacklevel=2)
        seed = self._next_seed if seed is None else seed_of(seed)
        self._core.reset_env(0, seed)
        self._next_seed = seed + 1
        self._ended = False
        self._decision = 0
        self.agents = self._members.at(0)
        self._history = []
        self._remember()
        return self._by_name(self._observations, self.agents), {name: {} for name in self.agents}

    def _by_name(self, rows, names):
        """Returns {agent: row} of a fresh copy of [1, N, ...]."""
        rows = rows[0].copy()
        return {name: rows[self._members.auv[name]] for name in names}

    def _of_auvs(self, actions):
        """The actions of all AUVs by name; absent AUVs get zeros."""
        if not self._members.changes:
            return actions
        missing = [name for name in self.agents if name not in actions]
        foreign = [name for name in actions if name not in self.agents]
        if missing or foreign:
            raise ValueError(
                f"actions: expected those of {', '.join(self.agents)}"
                + (f"; {missing[0]} is missing" if missing else f", not of {foreign[0]}")
            )
        still = np.zeros(self.scenario.action_size, np.float32)
        flying = {self._members.auv[name]: actions[name] for name in self.agents}
        return {name: flying.get(i, still) for i, name in enumerate(self._auvs)}

    def _remember(self):
        if self.render_mode is not None:
            self._history.append(self._core.snapshot(0))

    def step(self, actions):
        """One decision: {agent: [A] array} of all that fly.

        Returns five dictionaries by agent: observations, rewards, terminations, truncations, infos;
        of those that flew and of those that join now.
        Raises RuntimeError after the end of an episode or before the first reset, ValueError or
        TypeError for actions that are missing, of another shape or type, or not finite.
        """
        if not self.agents:
            raise RuntimeError("no AUV flies: the episode has ended or not begun; call reset")
        if not isinstance(actions, dict):
            raise TypeError(f"actions: expected a dictionary, not {type(actions).__name__}")
        flew = self.agents
        ended = self._core.step_agents(self._of_auvs(actions)) == 1
        self._decision += 1
        stay = flew if not self._members.changes else self._members.at(self._decision)
        if ended:
            self._ended = True
            self.agents = []
            names = flew
            metrics = self._core.metrics(0)
            infos = {name: {"metrics": metrics} for name in names}
        else:
            self._remember()
            self.agents = stay
            names = flew + [name for name in stay if name not in flew]
            infos = {name: {} for name in names}
        rewards = self._rewards[0].tolist()
        return (
            self._by_name(self._final if ended else self._observations, names),
            {name: rewards[self._members.auv[name]] if name in flew else 0.0 for name in names},
            {name: name not in stay for name in names},
            dict.fromkeys(names, ended),
            infos,
        )

    def state(self):
        """The true state of the swarm [S] float32, for critics; after the end, of the last decision."""
        return self._states[int(self._ended), 0].copy()

    def snapshot(self):
        """The true states in SI units and world axes, for drawing; see render.Snapshot.

        At the end of an episode, these are already the states of the next one.
        """
        return self._core.snapshot(0)

    def controller_actions(self, controller, privileged=False):
        """Returns {agent: action} of a controller: "pursuit", ..., or a policy's file.

        privileged: a built-in controller reads true states, also in acoustic mode.
        """
        if not self.agents:
            raise RuntimeError("no AUV flies: the episode has ended or not begun; call reset")
        return self._by_name(self._core.decide(str(controller), privileged), self.agents)

    def render(self):
        """A picture [height, width, 3] uint8 of the episode up to now: see stg.render."""
        if self.render_mode is None:
            return None
        if not self._history:
            raise RuntimeError("nothing to draw: call reset")
        from stg.render import draw  # pylint: disable=import-outside-toplevel

        return draw(self._history, self.scenario)

    def close(self):
        """Frees the engine; may be called again. A step after it raises RuntimeError."""
        self._core.close()
        self.agents = []

    def __repr__(self):
        return f"<stg.ParallelEnv {self.scenario.name}, {self.scenario.agents} AUVs>"


def parallel_env(scenario="medium", condition="nominal", overrides=None, seed=0, render_mode=None):
    """Returns a ParallelEnv.

    scenario      a shipped scenario's name, a YAML file, or a Scenario
    condition     a stress condition's name
    overrides     {"key.path": value} of docs/scenarios.md, nested or not
    seed          seed of the first reset without a seed
    render_mode   None or "rgb_array"
    """
    return ParallelEnv(scenario, condition, overrides, seed, render_mode)
