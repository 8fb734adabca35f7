"""One swarm by the names that PettingZoo's own environments have: parallel_env, env, raw_env.

    from stg import swarm_v1
    env = swarm_v1.env(scenario="hard")      # agents act one after the other; needs PettingZoo
"""

from stg.parallel import parallel_env

__all__ = ["env", "parallel_env", "raw_env"]


def raw_env(**options):
    """Returns the swarm as an AECEnv without wrappers; options are those of stg.parallel_env."""
    from pettingzoo.utils.conversions import (  # pylint: disable=import-outside-toplevel
        parallel_to_aec,
    )

    return parallel_to_aec(parallel_env(**options))


def env(**options):
    """Returns the swarm as an AECEnv that reports misuse; options are those of stg.parallel_env."""
    from pettingzoo.utils import wrappers  # pylint: disable=import-outside-toplevel

    return wrappers.OrderEnforcingWrapper(raw_env(**options))
