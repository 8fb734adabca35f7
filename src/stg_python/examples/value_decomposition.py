#!/usr/bin/python3
"""Value decomposition on discrete actions (VDN): a template for learners of action values.

Q of the team is the sum of the AUVs' own Q(o_i, a_i), with one network for all AUVs. The network
learns from the team's reward. To turn it into another algorithm, change `Learner`: QMIX mixes the
sum by the truth in infos["state"], independent Q-learning takes infos["agent_rewards"] in place of
the sum.
"""

import argparse
import json
import sys

import numpy as np
import torch
from torch import nn

import stg
from stg import wrappers

GAMMA, BINS, BATCH, CAPACITY = 0.95, 3, 256, 60000


class Replay:
    """The newest transitions of the team."""

    def __init__(self, agents, size, random):
        self.random, self.count = random, 0
        self.seen, self.after = (np.zeros((CAPACITY, agents, size), np.float32) for _ in range(2))
        self.actions = np.zeros((CAPACITY, agents), np.int64)
        self.rewards = np.zeros(CAPACITY, np.float32)

    def add(self, seen, actions, rewards, after):
        """Adds one transition of every environment."""
        rows = (self.count + np.arange(len(rewards))) % CAPACITY
        self.seen[rows], self.actions[rows] = seen, actions
        self.rewards[rows], self.after[rows] = rewards, after
        self.count += len(rewards)

    def sample(self):
        """BATCH random transitions as tensors."""
        rows = self.random.integers(min(self.count, CAPACITY), size=BATCH)
        return map(torch.from_numpy, (x[rows] for x in (self.seen, self.actions, self.rewards, self.after)))


class Learner:
    """Double Q-learning of the sum over the team."""

    def __init__(self, size, choices, seed):
        torch.manual_seed(seed)
        make = lambda: nn.Sequential(
            nn.Linear(size, 128), nn.ReLU(), nn.Linear(128, 128), nn.ReLU(), nn.Linear(128, choices)
        )
        self.q, self.target = make(), make()
        self.target.load_state_dict(self.q.state_dict())
        self.optimiser = torch.optim.Adam(self.q.parameters(), lr=5e-4)

    def act(self, seen, epsilon, random):
        """Best choices [envs, N] for observations [envs, N, K]; a share epsilon of them is random."""
        with torch.no_grad():
            values = self.q(torch.from_numpy(seen))
        best = values.argmax(-1).numpy()
        explore = random.random(best.shape) < epsilon
        return np.where(explore, random.integers(values.shape[-1], size=best.shape), best)

    def update(self, seen, actions, rewards, after):
        """One gradient step. Episodes end by truncation only, so the bootstrap is never masked."""
        with torch.no_grad():
            best = self.q(after).argmax(-1, keepdim=True)
            future = self.target(after).gather(-1, best).squeeze(-1).sum(-1)
        team = self.q(seen).gather(-1, actions[..., None]).squeeze(-1).sum(-1)
        loss = nn.functional.smooth_l1_loss(team, rewards + GAMMA * future)
        self.optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.q.parameters(), 10.0)
        self.optimiser.step()
        with torch.no_grad():
            for slow, fast in zip(self.target.parameters(), self.q.parameters()):
                slow.lerp_(fast, 0.01)


def evaluate(learner, scenario, seed=3000):
    """Returns the mean lost rate and return of 16 episodes flown greedily."""
    envs = wrappers.discrete_actions(stg.vector_env(scenario, 16), BINS, flat=True)
    seen, infos = envs.reset(seed=seed)
    while "final_info" not in infos:
        seen, _, _, _, infos = envs.step(learner.act(seen, 0.0, np.random.default_rng(0)))
    return {k: float(infos["final_info"][k].mean()) for k in ("return", "tail_distance", "lost_rate")}


def main():
    """Learns, and prints how the greedy policy flies episodes that it has not seen."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", default="medium_release")
    parser.add_argument("--steps", type=int, default=200000, help="environment steps")
    parser.add_argument("--envs", type=int, default=16)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    torch.set_num_threads(1)
    random = np.random.default_rng(options.seed)
    envs = stg.vector_env(options.scenario, options.envs, stagger=True)
    envs = wrappers.discrete_actions(envs, BINS, flat=True)
    agents, size = envs.single_observation_space.shape
    learner = Learner(size, int(envs.single_action_space.nvec[0]), options.seed)
    replay = Replay(agents, size, random)
    seen, infos = envs.reset(seed=10**6 * (1 + options.seed))
    rounds, rewards = options.steps // options.envs, []
    for k in range(rounds):
        actions = learner.act(seen, max(0.05, 1.0 - 3.0 * k / rounds), random)
        following, reward, _, ended, infos = envs.step(actions)
        after = following
        if ended.any():  # the last observation of an ended episode, not the first of the next
            after = np.where(ended[:, None, None], infos["final_obs"], following)
        replay.add(seen, actions, agents * reward, after)
        seen = following
        rewards.append(float(reward.mean()))
        if replay.count >= 4 * BATCH:
            learner.update(*replay.sample())
        if (k + 1) % max(1, rounds // 20) == 0:
            mean = np.mean(rewards[-rounds // 20 :])
            print(f"{(k + 1) * options.envs:8d} steps, mean reward {mean:.4f}", flush=True)
    share = max(1, rounds // 10)
    found = {"first_reward": np.mean(rewards[:share]), "last_reward": np.mean(rewards[-share:])}
    print(json.dumps({**found, **evaluate(learner, options.scenario)}))


if __name__ == "__main__":
    try:
        main()
    except stg.UserError as error:
        sys.exit(f"value_decomposition: {error}")
