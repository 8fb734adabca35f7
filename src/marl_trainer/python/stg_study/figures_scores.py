"""Figures of the cost of a comparison and of its spread: profiles, time, actions."""

import numpy as np

from stg_study.figure_style import colours, legend_below, plt, save
from stg_study.figures_curves import comparable, curve_band, step_axis
from stg_study.statistics import performance_profile
from stg_study.tables import training_metric

LINES = {"pursuit": "--", "pursuit_separated": "-."}
PROFILE_POINTS = 200


def profiles(study, results, scenario, folder):
    """Share of the episodes, of all seeds and conditions, with a return above x."""
    colour, labels = colours(study), study.labels()
    scores = {}
    for name in study.method_names():
        parts = [results.scores(scenario, c, name, "return") for c in study.conditions]
        if name != "idle" and all(part is not None for part in parts):
            scores[name] = np.concatenate([part.ravel() for part in parts])
    figure, axis = plt.subplots(figsize=(7.0, 4.6))
    handles = {}
    if scores:
        low = min(float(np.quantile(values, 0.05)) for values in scores.values())
        high = max(float(values.max()) for values in scores.values())
        at = np.linspace(low, high + 0.01 * (high - low), PROFILE_POINTS)
        for name, values in scores.items():
            (handles[labels[name]],) = axis.plot(
                at,
                performance_profile(values, at),
                color=colour[name],
                lw=1.6 if name in {m.name for m in study.methods} else 1.2,
                ls="-" if name in {m.name for m in study.methods} else LINES.get(name, ":"),
            )
    axis.set_xlabel("return of an episode, sum over AUVs")
    axis.set_ylabel("share of the episodes above")
    axis.set_ylim(-0.02, 1.02)
    figure.suptitle(f"{scenario}: performance profiles, all seeds and conditions", fontsize=10)
    legend_below(figure, list(handles.values()), list(handles))
    return save(figure, folder, f"profiles_{scenario}")


def _against_seconds(axis, study, results, scenario, handles):
    """Returns of the validations against wall time, with one line per training."""
    colour = colours(study)
    for method in comparable(study.methods, "scenario_return"):
        for seed in results.seeds(scenario, method.name):
            seconds = results.curve(scenario, method.name, seed, "wall_seconds")
            column = training_metric(study, method.name, "scenario_return")
            returns = results.curve(scenario, method.name, seed, column)
            if returns is None:
                continue
            returns = np.array(returns)
            (handles[method.label],) = axis.plot(
                seconds, returns / study.agents, color=colour[method.name], lw=1.0, alpha=0.6
            )
    axis.set_title("Return against time")
    axis.set_ylabel("per episode, mean over AUVs")
    axis.set_xlabel("seconds, one worker, beside other trainings")


def effort(study, results, scenario, folder):
    """Return against wall time; saturated actions and control cost against steps (as Figure S3)."""
    colour = colours(study)
    figure, axes = plt.subplots(1, 3, figsize=(12.5, 4.4))
    handles = {}
    _against_seconds(axes[0], study, results, scenario, handles)
    for axis, (name, metric) in zip(
        axes[1:], (("Saturated actions", "saturation_rate"), ("Control cost", "control_cost"))
    ):
        for method in study.methods:
            band = curve_band(results, scenario, method.name, metric)
            if band is None:
                continue
            steps, mean, std = band
            lower = np.maximum(mean - std, 0.0)
            axis.fill_between(steps, lower, mean + std, color=colour[method.name], alpha=0.18, lw=0)
            (handles[method.label],) = axis.plot(steps, mean, color=colour[method.name], lw=1.6)
        axis.set_title(name)
        axis.set_ylabel("mean over decisions and AUVs")
        axis.set_ylim(bottom=-0.03 * max(axis.get_ylim()[1], 1e-6))
        step_axis(axis)
    figure.suptitle(f"{scenario}: what the trainings cost, validations", fontsize=10)
    legend_below(figure, list(handles.values()), list(handles), columns=7)
    return save(figure, folder, f"effort_{scenario}")
