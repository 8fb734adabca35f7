"""Swarms of AUVs that track targets, for learning in Python; the engine is C++.

    env = stg.parallel_env("medium", condition="nominal", seed=0)    # PettingZoo's Parallel API
    envs = stg.vector_env("medium", num_envs=256, workers=2)         # Gymnasium's vector API

docs/python.md is the tutorial, docs/environment.md describes every number.
"""

from stg import _engine

_engine.choose()

from stg._core import (  # noqa: E402
    INSTRUCTION_SET,
    Agent,
    NeighbourState,
    PacketCodec,
    Policy,
    Scenario,
    TargetTrack,
    UserError,
    __version__,
    controllers,
    load_plugin,
)
from stg.page import Page, report
from stg.parallel import ParallelEnv, parallel_env
from stg.policies import evaluate, export_policy, load_policy
from stg.registration import register as _register
from stg.scenarios import load_scenario, policy_file, scenario_folder, scenario_names
from stg.vector import VectorEnv, vector_env

__all__ = [
    "INSTRUCTION_SET",
    "Agent",
    "NeighbourState",
    "PacketCodec",
    "Page",
    "ParallelEnv",
    "Policy",
    "Scenario",
    "TargetTrack",
    "UserError",
    "VectorEnv",
    "__version__",
    "controllers",
    "evaluate",
    "export_policy",
    "load_plugin",
    "load_policy",
    "load_scenario",
    "parallel_env",
    "policy_file",
    "report",
    "scenario_folder",
    "scenario_names",
    "vector_env",
]

_register()
