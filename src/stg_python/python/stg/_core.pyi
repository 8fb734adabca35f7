"""Types of the C++ engine. Times of agents are integers [ns], everything else is SI."""

from typing import Any, Sequence

import numpy as np

INSTRUCTION_SET: str
MIX_BLOCK: int
__version__: str

class UserError(ValueError):
    """Bad input: the message names file, line and key where they are known."""

class Scenario:
    """Everything an episode depends on besides its seed."""

    name: str
    agents: int
    targets: int
    action_size: int
    observation_size: int
    state_size: int
    episode_steps: int
    decision_dt_s: float
    hash: str
    observation_layout: str
    action_interface: str
    observation_blocks: list[tuple[str, int, int, str]]

    @staticmethod
    def load(
        scenario: str, condition: str = "nominal", overrides: Sequence[str] = ..., folder: str = ""
    ) -> Scenario: ...
    @staticmethod
    def from_yaml(text: str) -> Scenario: ...
    def to_yaml(self) -> str: ...
    def values(self) -> dict[str, Any]: ...
    def bottom(self, points: int = 65) -> np.ndarray: ...
    def __getitem__(self, key: str) -> Any: ...

class VectorEnv:
    """Environments on arrays of the caller's; stg.VectorEnv and stg.ParallelEnv stand on it."""

    workers: int

    def __init__(
        self, mix: Sequence[Scenario], num_envs: int, workers: int = 1, seed: int = 0,
        curriculum: bool | None = None, stagger: bool = False,
    ) -> None: ...  # fmt: skip
    def bind(self, arrays: dict[str, np.ndarray | None]) -> None: ...
    def restart_at(self, k: int) -> None: ...
    def reseed(self, seed: int) -> None: ...
    def reset_env(self, env: int, seed: int) -> None: ...
    def step(self, actions: np.ndarray) -> int: ...
    def step_agents(self, actions: dict[str, np.ndarray]) -> int: ...
    def decide(self, name: str, privileged: bool = False) -> np.ndarray: ...
    def close(self) -> None: ...
    def metrics(self, env: int) -> dict[str, float]: ...
    def snapshot(self, env: int) -> dict[str, Any]: ...
    def entities(self, env: int, agent: int) -> dict[str, np.ndarray]: ...
    def follow(self, env: int, agent: int, target: int) -> None: ...
    def followed(self, env: int, agent: int) -> int: ...
    def scenario(self, env: int) -> Scenario: ...
    def seed(self, env: int) -> int: ...
    def round(self, env: int) -> int: ...
    def episode_step(self, env: int) -> int: ...

class Policy:
    """A deterministic policy that agents fly."""

    metadata: dict[str, Any]
    parameters: dict[str, Any]
    observation_size: int
    action_size: int

    def __init__(
        self, layers: Sequence[tuple[np.ndarray, np.ndarray]], *, input_mean: np.ndarray,
        input_std: np.ndarray, observation_layout: str, action_interface: str,
        activation: str = "tanh", input_clip: float = 10.0, log_std: np.ndarray | None = None,
        action_scale: float = 1.0, id: str = "policy", scenario_hash: str = "",
        training_step: int = 0, seed: int = 0, metrics: dict[str, str] = ...,
    ) -> None: ...  # fmt: skip
    @staticmethod
    def load(path: str) -> Policy: ...
    def save(self, path: str) -> None: ...
    def mean(self, observations: np.ndarray) -> np.ndarray: ...
    def require_fits(self, scenario: Scenario) -> None: ...

class NeighbourState:
    """What one AUV tells its neighbours. World axes (ENU)."""

    source: int
    generation: int
    p_W: Sequence[float]
    v_W: Sequence[float]
    confidence: float
    tracking_error: float
    phase: int
    link_quality: float
    has_target: bool
    target: int
    target_stamp: int
    p_WT: Sequence[float]
    v_WT: Sequence[float]
    target_std: float
    saturated: bool

    def __init__(self) -> None: ...

class PacketCodec:
    """The 32-byte packet of the agents."""

    def __init__(self, scenario: Scenario) -> None: ...
    def encode(self, state: NeighbourState) -> bytes: ...
    def decode(self, data: bytes, now: int) -> NeighbourState: ...

class TargetTrack:
    """Constant-velocity Kalman filter of one target. World axes."""

    started: bool
    estimate: dict[str, Any]

    def __init__(self, scenario: Scenario) -> None: ...
    def clear(self) -> None: ...
    def start(self, p_WT: Sequence[float], std_m: float, stamp: int) -> None: ...
    def predict(self, time: int) -> None: ...
    def detect(self, stamp: int, p_WT: Sequence[float], std_m: float) -> None: ...
    def fuse(
        self, stamp: int, p_WT: Sequence[float], v_WT: Sequence[float], std_m: float
    ) -> None: ...

class Agent:
    """The mind of one AUV, as the C++ node runs it."""

    id: int
    target: int
    lost: bool
    present: bool
    neighbours: list[int]
    track: dict[str, Any]

    def __init__(self, scenario: Scenario, id: int) -> None: ...
    def reset(
        self, seed: int = 0, episode: int = 0, cue: Sequence[float] | None = None,
        cue_std_m: float = 0.0,
    ) -> None: ...  # fmt: skip
    def detect(self, stamp: int, p_WT: Sequence[float], std_m: float, target: int = 0) -> None: ...
    def follow(self, target: int) -> None: ...
    def add_cue(self, target: int, p_WT: Sequence[float], std_m: float) -> None: ...
    def receive(self, data: bytes, arrival: int) -> None: ...
    def observe(
        self, stamp: int, p_WB: Sequence[float], q_WB: Sequence[float], v_WB_B: Sequence[float],
        w_WB_B: Sequence[float],
    ) -> np.ndarray: ...  # fmt: skip
    def act(self, action: np.ndarray) -> dict[str, Sequence[float]]: ...
    def task(self) -> dict[str, Any]: ...
    def make_packet(self) -> bytes: ...
    def packet_due(self, stamp: int) -> bool: ...

def scenario_folder() -> str: ...
def load_plugin(library: str) -> None: ...
def evaluate(
    policy: str, scenario: Scenario, episodes: int = 30, seed: int = 3000, workers: int = 1,
    privileged: bool = False, overrides: list[str] = ...,
) -> dict[str, float]: ...  # fmt: skip
def controllers() -> list[str]: ...
