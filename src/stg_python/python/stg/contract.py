"""Checks the contract of environments and wrappers, as the testers of Gymnasium and PettingZoo do. An
AssertionError names what is wrong."""

import warnings

import numpy as np

__all__ = ["check_parallel", "check_vector"]


def _same(a, b):
    """Raises AssertionError unless two results, nested or not, are equal bit for bit."""
    assert type(a) is type(b), (type(a), type(b))
    if isinstance(a, dict):
        assert a.keys() == b.keys(), (a.keys(), b.keys())
        for key in a:
            _same(a[key], b[key])
    elif isinstance(a, (tuple, list)):
        assert len(a) == len(b)
        for x, y in zip(a, b):
            _same(x, y)
    elif isinstance(a, np.ndarray):
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    else:
        assert a == b, (a, b)


def _sampled(env, generator_seed):
    """Returns a function that draws the same actions for the same seed."""
    for i, name in enumerate(env.possible_agents):
        env.action_space(name).seed(generator_seed + i)
    return lambda: {name: env.action_space(name).sample() for name in env.agents}


def check_parallel(make, cycles=30):
    """Checks PettingZoo's parallel contract on environments that `make()` returns."""
    env = make()
    assert len(set(env.possible_agents)) == len(env.possible_agents) > 0
    assert "name" in env.metadata and "render_modes" in env.metadata
    assert env.max_num_agents == len(env.possible_agents)
    for name in env.possible_agents:
        assert env.observation_space(name) is env.observation_space(name)
        assert env.action_space(name) is env.action_space(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        env.reset(seed=0, options={"options": 1})  # any option is accepted
    for _ in range(2):
        _check_parallel_episode(env, cycles)
    _check_parallel_seed(make)
    env.close()
    env.close()


def _check_parallel_episode(env, cycles):
    observations, infos = env.reset(seed=3)
    assert set(env.agents) <= set(env.possible_agents) and env.num_agents == len(env.agents)
    assert observations.keys() == infos.keys() == set(env.agents)
    gone = set()
    for _ in range(cycles):
        if not env.agents:
            break
        flying = list(env.agents)
        actions = {name: env.action_space(name).sample() for name in flying}
        results = env.step(actions)
        assert len(results) == 5
        joined = [name for name in env.agents if name not in flying]
        for result in results:
            assert isinstance(result, dict) and list(result) == flying + joined
        observations, rewards, terminations, truncations, infos = results
        for name in flying:
            assert env.observation_space(name).contains(observations[name])
            assert np.isscalar(rewards[name]) and np.isfinite(rewards[name])
            assert type(terminations[name]) is bool and type(truncations[name]) is bool
            assert isinstance(infos[name], dict)
        ended = {name for name in flying if terminations[name] or truncations[name]}
        gone |= ended
        assert set(env.agents) == set(flying + joined) - ended
        assert not gone & set(env.agents), "an agent came back after its end"
        if hasattr(env, "state_space"):
            assert env.state_space.contains(env.state())


def _check_parallel_seed(make):
    """The same seed gives the same results, in another object and after other episodes."""

    def fly(env):
        draw = _sampled(env, 7)
        result = [env.reset(seed=11)]
        result += [env.step(draw()) for _ in range(5)]
        result.append(env.reset())  # the next episode is determined, too
        return result + [env.step(draw())]

    a, b = make(), make()
    first = fly(a)
    _same(first, fly(b))
    _same(first, fly(a))
    _same(first[0], a.reset(seed=11))
    other = a.reset(seed=12)[0]
    assert any(np.any(other[name] != first[0][0][name]) for name in other)


def check_vector(make, steps=40):
    """Checks Gymnasium's vector contract, with SAME_STEP autoreset, on what `make()` returns."""
    env = make()
    n = env.num_envs
    assert getattr(env.metadata["autoreset_mode"], "value", "SameStep") == "SameStep"
    for batched, single in (
        (env.observation_space, env.single_observation_space),
        (env.action_space, env.single_action_space),
    ):
        assert batched.shape == (n, *single.shape)
        assert batched.dtype == single.dtype
    observations, infos = env.reset(seed=5)
    _check_infos(infos, n)
    ends = 0
    for _ in range(steps):
        assert observations.shape == env.observation_space.shape
        assert env.observation_space.contains(observations)
        results = env.step(env.action_space.sample())
        observations, rewards, terminations, truncations, infos = results
        assert rewards.shape[0] == n and np.all(np.isfinite(rewards))
        for flags in (terminations, truncations):
            assert flags.shape == (n,) and flags.dtype == bool
        _check_infos(infos, n)
        ended = terminations | truncations
        assert ("final_obs" in infos) == ("final_info" in infos) == bool(ended.any())
        if ended.any():
            ends += 1
            assert np.array_equal(infos["_final_obs"], ended)
            assert np.array_equal(infos["_final_info"], ended)
            for e in np.flatnonzero(ended):
                assert env.single_observation_space.contains(infos["final_obs"][e])
                assert np.any(infos["final_obs"][e] != observations[e])
    assert ends > 0, "no episode ended: the check saw no autoreset"
    _check_vector_seed(env, make())
    env.close()
    env.close()


def _check_infos(infos, n):
    for key, value in infos.items():
        if isinstance(value, dict):
            _check_infos(value, n)
        elif key.startswith("_"):
            assert value.shape == (n,) and value.dtype == bool, key
        else:
            assert len(value) == n and "_" + key in infos, key


def _check_vector_seed(a, b):
    results = []
    for env in (a, b):
        env.action_space.seed(1)
        result = [env.reset(seed=21)]
        results.append(result + [env.step(env.action_space.sample()) for _ in range(30)])
    _same(results[0], results[1])
    # Environment e is seeded with S + e, so a list of those seeds starts the same worlds.
    _same(a.reset(seed=[21 + e for e in range(a.num_envs)])[0], results[0][0][0])
