"""Names for `gymnasium.make` and `pettingzoo.make`, registered by `import stg`.

Gymnasium knows stg/Team-v1, the swarm as one agent, and many swarms for `make_vec`; by the name
stg:stg/Team-v1 it imports stg itself. PettingZoo, from 1.27 on, knows stg/Swarm-v1.
"""

__all__ = ["make_team", "make_vector", "register"]

TEAM = "stg/Team-v1"
SWARM = "stg/Swarm-v1"


def make_team(scenario="medium", **options):
    """Returns one swarm as a gymnasium.Env, see stg.parallel_env and stg.wrappers.joint."""
    from stg.parallel import parallel_env  # pylint: disable=import-outside-toplevel
    from stg.wrappers import joint  # pylint: disable=import-outside-toplevel

    return joint(parallel_env(scenario, **options))


def make_vector(scenario="medium", num_envs=4, **options):
    """Returns many swarms, each as one agent, see stg.vector_env and stg.wrappers.joint."""
    from stg.vector import vector_env  # pylint: disable=import-outside-toplevel
    from stg.wrappers import joint  # pylint: disable=import-outside-toplevel

    return joint(vector_env(scenario, num_envs, **options))


def register():
    """Registers the names in both packages, once; skips a package that is not installed."""
    _tell_gymnasium()
    _tell_pettingzoo()


def _tell_gymnasium():
    try:
        from gymnasium.envs import registration  # pylint: disable=import-outside-toplevel
    except ImportError:
        return
    if TEAM in registration.registry:
        return
    namespace, registration.current_namespace = registration.current_namespace, None
    try:
        registration.register(
            TEAM,
            entry_point="stg.registration:make_team",
            vector_entry_point="stg.registration:make_vector",
        )
    finally:
        registration.current_namespace = namespace


def _tell_pettingzoo():
    try:
        from pettingzoo.env_registry import registration  # pylint: disable=import-outside-toplevel
    except ImportError:  # not installed, or older than its registry
        return
    if SWARM in registration.parallel_registry:
        return
    registration.register("parallel", SWARM, entry_point="stg.swarm_v1:parallel_env")
    registration.register("aec", SWARM, entry_point="stg.swarm_v1:env")
