#!/usr/bin/python3
"""MAPPO in one file: one actor for all AUVs, one critic on the truth. Loses no target of
medium_release after 249,600 steps, and writes a policy that agents fly.
"""

import argparse
import json
import sys

import numpy as np
import torch
from torch import nn

import stg

GAMMA, LAMBDA, CLIP = 0.95, 0.95, 0.2
EPOCHS, MINIBATCHES, LENGTH = 5, 4, 100


class Normaliser:
    """Running mean and standard deviation of arrays [..., size]."""

    def __init__(self, size):
        self.count, self.mean, self.squares = 1e-4, np.zeros(size), np.ones(size) * 1e-4

    def add(self, x):
        """Adds the rows of x to the statistics."""
        x = x.reshape(-1, x.shape[-1]).astype(float)
        total = self.count + len(x)
        offset = x.mean(axis=0) - self.mean
        self.squares += len(x) * x.var(axis=0) + offset**2 * self.count * len(x) / total
        self.mean += offset * len(x) / total
        self.count = total

    @property
    def std(self):
        """Standard deviation, no smaller than 0.01."""
        return np.sqrt(self.squares / self.count).clip(1e-2)

    def __call__(self, x):
        """x in units of the standard deviation, as a tensor."""
        scaled = ((x - self.mean) / self.std).clip(-10.0, 10.0)
        return torch.as_tensor(scaled, dtype=torch.float32)


def network(inputs, outputs, last=None):
    """Two hidden layers of 64; small outputs at the start."""
    layers = [nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs)]
    for layer in layers[::2]:
        nn.init.orthogonal_(layer.weight, 0.01 if layer is layers[-1] else 1.0)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(*layers, *([last] if last else []))


class Learner:
    """Actor, critic and the statistics of their inputs."""

    def __init__(self, envs, seed):
        torch.manual_seed(seed)
        _, _, size = envs.observation_space.shape
        states = envs.state().shape[1]
        self.actor = network(size, envs.single_action_space.shape[1], nn.Tanh())
        self.critic = network(states, 1)
        self.log_std = nn.Parameter(torch.full(envs.single_action_space.shape[1:], -1.5))
        self.seen, self.truth = Normaliser(size), Normaliser(states)
        parameters = [*self.actor.parameters(), *self.critic.parameters(), self.log_std]
        self.optimiser = torch.optim.Adam(parameters, lr=1e-3, eps=1e-5)

    def policy(self, observations):
        """Distribution of the actions for normalised observations."""
        return torch.distributions.Normal(self.actor(observations), self.log_std.exp())

    def values(self, states):
        """V of states [..., S] as numpy."""
        with torch.no_grad():
            return self.critic(self.truth(states)).squeeze(-1).numpy()

    def collect(self, envs, observations, states):
        """Makes LENGTH decisions in all environments; returns a batch, the next observations and states."""
        batch = {k: [] for k in ("observations", "states", "actions", "log", "rewards", "values", "next")}
        for _ in range(LENGTH):
            seen = self.seen(observations)
            with torch.no_grad():
                policy = self.policy(seen)
                actions = policy.sample()
            truth, values = self.truth(states), self.values(states)
            self.seen.add(observations)
            self.truth.add(states)
            observations, rewards, _, ended, infos = envs.step(actions.numpy())
            states, after = infos["state"], infos["state"]
            if ended.any():  # V of the last state of an ended episode, not of the next one's first state
                after = np.where(ended[:, None], infos["final_info"]["state"], states)
            log = policy.log_prob(actions).sum(-1)
            for k, x in zip(batch, (seen, truth, actions, log, rewards, values, self.values(after))):
                batch[k].append(torch.as_tensor(x))
            batch.setdefault("ended", []).append(torch.as_tensor(ended))
        return {k: torch.stack(v) for k, v in batch.items()}, observations, states

    def update(self, batch):
        """Goes over the batch several times."""
        residuals = batch["rewards"] + GAMMA * batch["next"] - batch["values"]
        advantages, running = torch.zeros_like(residuals), torch.zeros_like(residuals[0])
        for t in reversed(range(LENGTH)):
            running = residuals[t] + GAMMA * LAMBDA * running * ~batch["ended"][t]
            advantages[t] = running
        returns = (advantages + batch["values"]).flatten()
        advantages = ((advantages - advantages.mean()) / (advantages.std() + 1e-8)).flatten()
        flat = {k: batch[k].flatten(0, 1) for k in ("observations", "states", "actions", "log")}
        for _ in range(EPOCHS):
            for rows in torch.randperm(len(returns)).chunk(MINIBATCHES):
                log = self.policy(flat["observations"][rows]).log_prob(flat["actions"][rows]).sum(-1)
                ratio, advantage = (log - flat["log"][rows]).exp(), advantages[rows, None]
                gain = torch.min(ratio * advantage, ratio.clamp(1 - CLIP, 1 + CLIP) * advantage)
                values = self.critic(flat["states"][rows]).squeeze(-1)
                loss = -gain.mean() + 0.5 * nn.functional.smooth_l1_loss(values, returns[rows])
                self.optimiser.zero_grad()
                loss.backward()
                for group in (self.actor, self.critic):
                    nn.utils.clip_grad_norm_(group.parameters(), 0.5)
                self.optimiser.step()
                self.log_std.data.clamp_(-4.0, 0.0)


def main():
    """Learns, writes the policy, and prints how it flies episodes that it has not seen."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", default="medium_release")
    parser.add_argument("--steps", type=int, default=250000, help="environment steps; whole collections of 100 ENVS are made")
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--episodes", type=int, default=30, help="episodes of the evaluation")
    parser.add_argument("--out", default="ppo.onnx")
    options = parser.parse_args()
    torch.set_num_threads(1)
    envs = stg.vector_env(
        options.scenario, options.envs, workers=options.workers, stagger=True, copy=False
    )
    observations, infos = envs.reset(seed=10**6 * (1 + options.seed))
    learner, states, rewards = Learner(envs, options.seed), infos["state"], []
    rounds = max(1, options.steps // (LENGTH * options.envs))
    for k in range(rounds):
        learner.optimiser.param_groups[0]["lr"] = 1e-3 * (1.0 - 0.9 * k / rounds)
        batch, observations, states = learner.collect(envs, observations, states)
        learner.update(batch)
        rewards.append(batch["rewards"].mean().item())
        print(f"{(k + 1) * LENGTH * options.envs:8d} steps, mean reward {rewards[-1]:.4f}", flush=True)
    stg.export_policy(
        learner.actor, options.out, envs.scenario(), observation_mean=learner.seen.mean,
        observation_std=learner.seen.std, log_std=learner.log_std.detach().numpy(), id="ppo",
        training_step=len(rewards) * LENGTH * options.envs, seed=options.seed,
    )  # fmt: skip
    flown = stg.evaluate(options.out, options.scenario, episodes=options.episodes)
    found = {k: flown[k] for k in ("return", "tail_distance", "lost_rate")}
    print(json.dumps({"first_reward": rewards[0], "last_reward": rewards[-1], **found}))


if __name__ == "__main__":
    try:
        main()
    except stg.UserError as error:
        sys.exit(f"ppo: {error}")
