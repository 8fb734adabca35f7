"""Figures of the final stage and of the stress conditions: bars and box plots."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from stg_study import figure_style as style
from stg_study.figure_style import PAPER_COLOUR, colours, plt, save, title
from stg_study.figures_curves import comparable
from stg_study.tables import (
    RETURNS, ablated, condition_label, final_value, paper_value, training_metric,
)  # fmt: skip

FINAL = [
    ("Return, mean over AUVs", "scenario_return", "{:.1f}"),
    ("Tail distance", "tail_distance", "{:.3f}"),
    ("Tracking error, whole episode", "mean_error", "{:.3f}"),
    ("Target lost, share of decisions", "whole_lost_rate", "{:.3f}"),
]
ABLATION = [FINAL[0], FINAL[1], FINAL[3], ("Saturated actions, share", "saturation_rate", "{:.3f}")]


def _bars(axis, rows, number):
    """Horizontal bars from (label, (mean, std) or None, colour, hatch), first row on top."""
    values = [row[1] for row in rows if row[1] is not None]
    if not values:
        return
    reach = max(abs(mean) + (std or 0.0) for mean, std in values) or 1.0
    for place, (_, value, colour, hatch) in enumerate(rows):
        if value is None:
            continue
        mean, std = value
        axis.barh(place, mean, xerr=std or None, color=colour, hatch=hatch, height=0.72,
                  edgecolor="#555555", lw=0.4, error_kw={"lw": 0.9, "capsize": 2})  # fmt: skip
        edge = max(mean, 0.0) + (std or 0.0)
        axis.text(edge + 0.02 * reach, place, number.format(mean), va="center", fontsize=8)
    axis.set_yticks(range(len(rows)))
    axis.set_yticklabels([row[0] for row in rows])
    axis.invert_yaxis()
    axis.grid(axis="y", visible=False)
    low = min(0.0, min(mean - (std or 0.0) for mean, std in values))
    axis.set_xlim(1.05 * low, 1.25 * reach)
    axis.xaxis.set_major_locator(MaxNLocator(4))


def final_stage(study, results, paper, scenario, table, folder):
    """Bars of the last fifth of the training: our methods, the controllers, and the paper's algorithms."""
    colour, labels = colours(study), study.labels()
    count = len(study.method_names()) + len(paper.algorithms(table))
    figure, axes = plt.subplots(1, 4, figsize=(12.5, 1.6 + 0.27 * count), sharey=True)
    for axis, (name, metric, number) in zip(axes, FINAL):
        rows = [
            (labels[n], final_value(study, results, scenario, n, metric), colour[n], None)
            for n in study.method_names()
        ]
        for algorithm in paper.algorithms(table):
            value = paper_value(paper, table, algorithm, metric)
            rows.append((f"{algorithm} (paper)", value, PAPER_COLOUR, "///"))
        _bars(axis, rows, number)
        axis.set_title(name)
    _share_rows(axes, count)
    title(figure, f"{scenario}: last 20 % of validations, mean ± std over seeds")
    figure.tight_layout()
    return save(figure, folder, f"final_stage_{scenario}")


def _share_rows(axes, count):
    """A shared axis is inverted once for every panel; this puts the first row on top."""
    axes[0].set_ylim(count - 0.4, -0.6)


def ablation(study, results, paper, scenario, folder, with_paper):
    """Bars of Table S9: every variant, with the paper's figure below it."""
    colour = colours(study)
    rows_of = {}
    for name, metric, _ in ABLATION:
        rows = []
        for method in ablated(study):
            value = final_value(study, results, scenario, method.name, metric)
            rows.append((method.label, value, colour[method.name], None))
            if with_paper and method.ablation in paper.algorithms("S9"):
                theirs = paper_value(paper, "S9", method.ablation, metric)
                rows.append(("(paper)", theirs, PAPER_COLOUR, "///"))
        rows_of[name] = rows
    count = len(rows_of[ABLATION[0][0]])
    figure, axes = plt.subplots(1, 4, figsize=(12.5, 1.6 + 0.3 * count), sharey=True)
    for axis, (name, _, number) in zip(axes, ABLATION):
        _bars(axis, rows_of[name], number)
        axis.set_title(name)
    _share_rows(axes, count)
    title(figure, f"{scenario}: ablation, last 20 % of validations, mean ± std over seeds")
    figure.tight_layout()
    return save(figure, folder, f"ablation_{scenario}")


def _box(axis, position, values, colour, width=0.7):
    axis.boxplot(
        [values],
        positions=[position],
        widths=width,
        patch_artist=True,
        boxprops={"facecolor": colour, "alpha": 0.65, "lw": 0.7},
        medianprops={"color": "black", "lw": 1.2},
        whiskerprops={"lw": 0.7},
        capprops={"lw": 0.7},
        flierprops={"marker": ".", "ms": 2.5, "mfc": "#555555", "mec": "none"},
    )


def final_boxes(study, results, scenario, folder):
    """Box plots of the validations of the last fifth, all seeds together (as Figure S1)."""
    colour = colours(study)
    figure, axes = plt.subplots(1, 4, figsize=(12.5, 3.9))
    for axis, (name, metric, _) in zip(axes, FINAL):
        scale = 1.0 / study.agents if metric in RETURNS else 1.0
        for place, method in enumerate(study.methods):
            if method not in comparable(study.methods, metric):
                continue
            column = training_metric(study, method.name, metric)
            points = [
                results.final_points(scenario, method.name, seed, column)
                for seed in results.seeds(scenario, method.name)
            ]
            if points and all(p is not None for p in points):
                _box(axis, place, scale * np.concatenate(points), colour[method.name])
        if metric == "whole_lost_rate":
            axis.set_ylim(-0.002, max(0.02, axis.get_ylim()[1]))
        axis.set_xticks([])
        axis.set_xlim(-0.6, len(study.methods) - 0.4)
        axis.set_title(name.replace(", ", ",\n"))
    title(figure, f"{scenario}: validations of the last 20 %, all seeds")
    boxes = [plt.Rectangle((0, 0), 1, 1, fc=colour[m.name], alpha=0.65) for m in study.methods]
    style.legend_below(figure, boxes, [m.label for m in study.methods], columns=6)
    return save(figure, folder, f"final_boxes_{scenario}")


def stress_boxes(study, results, paper, scenario, table, folder):
    """Box plots over all episodes of every condition, the paper's STG-MAPPO as mean ± std."""
    colour, labels = colours(study), study.labels()
    names = [n for n in study.method_names() if n != "idle"]
    pairs = study.agents * (study.agents - 1) // 2
    panels = [
        ("Return, sum over AUVs", "return"),
        ("Tail distance", "tail_distance"),
        (f"Colliding pairs per decision, tail (of {pairs})", "tail_colliding_pairs"),
    ]
    figure, axes = plt.subplots(3, 1, figsize=(11.0, 9.6), sharex=True)
    width = 0.84 / (len(names) + 1)
    handles = {}
    for axis, (panel, metric) in zip(axes, panels):
        centres, lowest, highest = [], np.inf, 0.0
        for group, condition in enumerate(study.conditions):
            for place, name in enumerate(names):
                scores = results.scores(scenario, condition, name, metric)
                if scores is None:
                    continue
                x = group - 0.42 + width * (place + 0.5)
                _box(axis, x, scores.ravel(), colour[name], 0.85 * width)
                handles[labels[name]] = plt.Rectangle((0, 0), 1, 1, fc=colour[name], alpha=0.65)
                centres.append(float(np.median(scores)))
                lowest = min(lowest, float(scores.min()))
                highest = max(highest, float(scores.max()))
            theirs = paper.get(table, "STG-MAPPO", metric, condition)
            if theirs is not None:
                x = group - 0.42 + width * (len(names) + 0.5)
                handles["STG-MAPPO (paper), mean ± std"] = axis.errorbar(
                    x, theirs[0], yerr=theirs[1], fmt="D", ms=4, color="#B22222", capsize=2, lw=1
                )
        if metric == "tail_distance" and centres:
            style.logarithmic(axis, lowest, highest)
        if metric == "return" and centres:
            axis.set_ylim(bottom=max(axis.get_ylim()[0], min(centres) - 150.0))
        axis.set_title(panel)
    axes[-1].set_xticks(range(len(study.conditions)))
    axes[-1].set_xticklabels([condition_label(c) for c in study.conditions])
    axes[-1].set_xlim(-0.5, len(study.conditions) - 0.5)
    title(figure, f"{scenario}: best checkpoints, episodes of all seeds")
    style.legend_below(figure, list(handles.values()), list(handles), columns=5)
    return save(figure, folder, f"stress_{scenario}")
