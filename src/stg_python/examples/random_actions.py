#!/usr/bin/python3
"""One episode of random actions."""

import argparse

import stg

argparse.ArgumentParser(description=__doc__).parse_args()
env = stg.parallel_env("medium", seed=0)
observations, infos = env.reset()
total = 0.0
while env.agents:
    actions = {name: env.action_space(name).sample() for name in env.agents}
    observations, rewards, terminations, truncations, infos = env.step(actions)
    total += sum(rewards.values())
print(f"return {total:.1f}, share of the tail lost {infos['auv_0']['metrics']['lost_rate']:.2f}")
