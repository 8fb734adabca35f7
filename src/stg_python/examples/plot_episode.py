#!/usr/bin/python3
"""Flies one episode and plots it: tracks from above and from the side, distances and rewards."""

import argparse
import sys

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import stg
from stg import render


def fly(env, controller):
    """Returns (Snapshots, rewards [T, N]) of one episode."""
    env.reset()
    history, rewards = [env.snapshot()], []
    while env.agents:
        rewards.append(list(env.step(env.controller_actions(controller))[1].values()))
        if env.agents:
            history.append(env.snapshot())
    return history, np.array(rewards)


def plot(history, rewards, scenario, path):
    """Writes the picture."""
    figure = Figure(figsize=(10, 9), dpi=100)
    FigureCanvasAgg(figure)
    views, curves = figure.subfigures(2, 1, height_ratios=(5.4, 3.6))
    render.draw_views(views, history, scenario)
    times = np.array([shot["time"] for shot in history])
    distances = np.array([shot["tracking"][:, 0] for shot in history])
    left, right = curves.subplots(1, 2)
    for i in range(distances.shape[1]):
        colour = render.COLOURS[i % len(render.COLOURS)]
        left.semilogy(times, distances[:, i], color=colour, lw=1.0)
        right.plot(times, rewards[:, i], color=colour, lw=1.0)
    band = scenario["reward.band_m"]
    left.axhspan(*band, color="#cfe8cf", zorder=0)
    left.set(xlabel="time [s]", ylabel="distance to the target [m]", title="the band is green")
    right.set(xlabel="time [s]", ylabel="reward", title="of each AUV")
    curves.subplots_adjust(left=0.08, right=0.98, top=0.88, bottom=0.16, wspace=0.28)
    figure.savefig(path)


def main():
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", default="medium")
    parser.add_argument("--condition", default="nominal")
    parser.add_argument("--policy", default="pursuit_separated", help="ONNX file or controller")
    parser.add_argument("--seed", type=int, default=3000)
    parser.add_argument("--out", default="episode.png")
    options = parser.parse_args()
    env = stg.parallel_env(options.scenario, options.condition, seed=options.seed)
    plot(*fly(env, options.policy), env.scenario, options.out)
    print(f"wrote {options.out}")


if __name__ == "__main__":
    try:
        main()
    except stg.UserError as error:
        sys.exit(f"plot_episode: {error}")
