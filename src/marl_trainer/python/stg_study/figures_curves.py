"""Figures over the training: convergence, seeds one by one, reward components."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from stg_study.figure_style import colours, legend_below, logarithmic, plt, save, title
from stg_study.tables import RETURNS, final_value, paper_value, training_metric

# Title, axis label, metric, logarithmic.
PANELS = [
    ("Return by the scenario's reward", "per episode, mean over AUVs", "scenario_return", False),
    ("Tracking error", "|d − d*|, whole episode", "mean_error", True),
    ("Tail distance", "d, last 100 decisions", "tail_distance", True),
    ("Target lost", "share of decisions", "whole_lost_rate", False),
]
COMPONENTS = [
    ("tracking", "reward_track"),
    ("observation", "reward_observation"),
    ("coordination", "reward_coordination"),
    ("communication", "reward_communication"),
    ("semantic", "reward_semantic"),
]
FLOOR = 1e-4  # smallest value of logarithmic axes


def curve_band(results, scenario, method, metric, scale=1.0):
    """Steps, mean and std over seeds, at the validations that all seeds have; None if there are none."""
    seeds = results.seeds(scenario, method)
    if not seeds:
        return None
    values = [results.curve(scenario, method, seed, metric) for seed in seeds]
    if any(value is None for value in values):
        return None
    curves = [
        dict(zip(results.curve(scenario, method, seed, "env_steps"), value))
        for seed, value in zip(seeds, values)
    ]
    steps = sorted(set.intersection(*(set(c) for c in curves)))
    if not steps:
        return None
    values = scale * np.array([[curve[s] for s in steps] for curve in curves])
    std = values.std(axis=0, ddof=1) if len(seeds) > 1 else np.zeros(len(steps))
    return np.array(steps), values.mean(axis=0), std


def step_axis(axis):
    """Environment steps along x."""
    axis.xaxis.set_major_formatter(EngFormatter(sep=""))
    axis.set_xlabel("environment steps")
    axis.set_xlim(left=0)


def comparable(methods, metric):
    """The methods whose validations are comparable on one axis: those with a return by the scenario's
    reward."""
    if metric not in RETURNS:
        return list(methods)
    return [m for m in methods if m.reward() != "own"]


def _scale(study, metric):
    return 1.0 / study.agents if metric in RETURNS else 1.0


def _focus_returns(axis, bands, references):
    """Chooses the range of the axis: it starts near the 2 % quantile, so that one early collapse does not
    squeeze all curves."""
    values = np.concatenate([mean - std for _, mean, std in bands])
    top = max([float((mean + std).max()) for _, mean, std in bands] + references)
    low = float(np.quantile(values, 0.02))
    axis.set_ylim(low - 0.05 * (top - low), top + 0.06 * (top - low))


def convergence(study, results, paper, scenario, table, folder):
    """Return, error, tail distance and loss against steps: mean and std over seeds. Lines show the
    controllers and the final stage of the paper's STG-MAPPO."""
    colour, labels = colours(study), study.labels()
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 6.6))
    handles = {}
    for axis, (name, label, metric, is_logarithmic) in zip(axes.flat, PANELS):
        bands, references = [], []
        for method in comparable(study.methods, metric):
            column = training_metric(study, method.name, metric)
            band = curve_band(results, scenario, method.name, column, _scale(study, metric))
            if band is None:
                continue
            steps, mean, std = band
            bands.append(band)
            floor = FLOOR if is_logarithmic else 0.0 if metric == "whole_lost_rate" else -np.inf
            lower = np.maximum(mean - std, floor)
            axis.fill_between(steps, lower, mean + std, color=colour[method.name], alpha=0.18, lw=0)
            mean = np.maximum(mean, floor)
            (line,) = axis.plot(steps, mean, color=colour[method.name], lw=1.6)
            handles[labels[method.name]] = line
        for controller in study.controllers:
            value = final_value(study, results, scenario, controller.name, metric)
            if controller.name == "idle" or value is None:
                continue
            references.append(value[0])
            style = {"pursuit": "--", "pursuit_separated": "-."}.get(controller.name, ":")
            line = axis.axhline(references[-1], color=colour[controller.name], lw=1.2, ls=style)
            handles[labels[controller.name]] = line
        theirs = paper_value(paper, table, "STG-MAPPO", metric)
        if theirs is not None:
            references.append(theirs[0])
            line = axis.axhline(theirs[0], color="#B22222", lw=1.0, ls=(0, (6, 2, 1, 2, 1, 2)))
            handles["STG-MAPPO (paper), final stage"] = line
        axis.set_title(name)
        axis.set_ylabel(label)
        if is_logarithmic and bands:
            # Uses the means, because one seed that is far off early would stretch the axis over decades.
            means = np.concatenate([mean for _, mean, _ in bands] + [references])
            logarithmic(axis, max(float(means.min()), FLOOR), float(means.max()))
        elif metric == "whole_lost_rate":
            top = max(0.02, axis.get_ylim()[1])
            axis.set_ylim(-0.03 * top, top)
        elif bands:
            _focus_returns(axis, bands, references)
        step_axis(axis)
    title(figure, f"{scenario}: validations during training, mean ± std over seeds")
    legend_below(figure, list(handles.values()), list(handles))
    return save(figure, folder, f"convergence_{scenario}")


def per_seed(study, results, scenario, folder):
    """Return and tail distance of every training, for the methods that are in the paper's tables or have the
    observation of STG-MAPPO. Each method has a colour; each of up to four seeds has a line style."""
    methods = [m for m in study.methods if m.paper or m.variant == "stg"] or study.methods[:2]
    colour = colours(study)
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 4.2))
    handles = {}
    seeds = results.all_seeds(scenario)
    styles = ["-", "--", ":", "-."] if len(seeds) <= 4 else ["-"]
    for axis, (name, label, metric, is_logarithmic) in zip(axes, (PANELS[0], PANELS[2])):
        drawn = []
        for method in comparable(methods, metric):
            for i, seed in enumerate(results.seeds(scenario, method.name)):
                column = training_metric(study, method.name, metric)
                values = results.curve(scenario, method.name, seed, column)
                if values is None:
                    continue
                values = np.array(values)
                drawn.append(values)
                axis.plot(
                    results.curve(scenario, method.name, seed, "env_steps"),
                    values * _scale(study, metric),
                    color=colour[method.name],
                    ls=styles[i % len(styles)],
                    lw=1.3 if len(styles) > 1 else 0.8,
                )
                handles[method.label] = Line2D([], [], color=colour[method.name], lw=3.0)
        axis.set_title(name)
        axis.set_ylabel(label)
        if is_logarithmic and drawn:
            values = np.concatenate(drawn)
            logarithmic(axis, max(float(values.min()), FLOOR), float(values.max()))
        step_axis(axis)
    if len(styles) > 1:
        for seed, ls in zip(seeds, styles):
            handles[f"seed {seed}"] = Line2D([], [], color="#222222", lw=1.3, ls=ls)
    title(figure, f"{scenario}: every training")
    legend_below(figure, list(handles.values()), list(handles))
    return save(figure, folder, f"per_seed_{scenario}")


def reward_components(study, results, scenario, folder):
    """The terms of the reward before weighting, and the cost of the controls, for the first method."""
    method = study.methods[0]
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.8), gridspec_kw={"width_ratios": [3, 2]})
    palette = ["#0072B2", "#56B4E9", "#009E73", "#E69F00", "#CC79A7"]
    diagnostics = [("control cost", "control_cost"), ("saturated actions", "saturation_rate")]
    for axis, entries, shades in (
        (axes[0], COMPONENTS, palette),
        (axes[1], diagnostics, ["#D55E00", "#222222"]),
    ):
        for (label, metric), shade in zip(entries, shades):
            band = curve_band(results, scenario, method.name, metric)
            if band is None:
                continue
            steps, mean, std = band
            axis.fill_between(steps, mean - std, mean + std, color=shade, alpha=0.18, lw=0)
            axis.plot(steps, mean, color=shade, lw=1.6, label=label)
        step_axis(axis)
        if axis.lines:
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncol=3)
    axes[0].set_title("Reward terms before weighting")
    axes[0].set_ylabel("mean over decisions and AUVs")
    axes[1].set_title("Control diagnostics")
    axes[1].set_ylabel("mean over decisions and AUVs")
    axes[1].set_ylim(bottom=-0.03 * axes[1].get_ylim()[1])
    figure.suptitle(f"{scenario}: {method.label}, mean ± std over seeds")
    figure.tight_layout()
    return save(figure, folder, f"reward_components_{scenario}")
