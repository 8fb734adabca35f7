"""Tables about the fairness of a comparison: options, networks, cost, and probabilities to be better."""

import re

import numpy as np

from stg_study.collect import THRESHOLDS
from stg_study.statistics import mean_std, probability_of_improvement
from stg_study.tables import NOTHING, cell, markdown

# Title, and one or several options of train, of which a method has at most one.
OPTIONS = [
    ("γ", "gamma"),
    ("Learning rate", "lr"),
    ("Critic's rate", "critic-lr"),
    ("Final share of rates", "lr-final"),
    ("Actor", "actor-hidden"),
    ("Critic", "critic-hidden"),
    ("Environments", "envs"),
    ("Steps per update", "horizon"),
    ("Batch", "minibatch batch"),
    ("Epochs or replayed", "epochs replayed"),
    ("n-step", "n-step"),
    ("τ", "tau"),
]


def options_table(study, results):
    """The training options of every method, after the names and labels of the methods."""
    rows = []
    for method in study.methods:
        row = [method.label, results.option(method.name, "algorithm") or NOTHING, method.variant]
        for _, names in OPTIONS:
            found = [results.option(method.name, name) for name in names.split()]
            row.append(next((text for text in found if text), NOTHING).replace(";", ", "))
        rows.append(row)
    return markdown(["Method", "Algorithm", "Variant"] + [title for title, _ in OPTIONS], rows)


def parameters(text):
    """Number of parameters of all networks together, and a text with each network, from runs.csv. Similar
    ones, such as actor_0 and actor_1, are counted together. (0, "") for an empty text."""
    total, alike = 0, {}
    for name, count in (part.rsplit(":", 1) for part in text.split()):
        total += int(count)
        key = (re.sub(r"_\d+$", "", name), int(count))
        alike[key] = alike.get(key, 0) + 1
    words = [f"{n} × " * (n > 1) + f"{name} {size:,}" for (name, size), n in alike.items()]
    return total, ", ".join(words)


def cost_table(study, results, scenario):
    """Networks, arithmetic and time of every method, and the number of its trainings that reached each
    threshold."""
    header = ["Method", "Seeds", "Parameters", "Networks", "MFLOP/step", "Steps", "Wall s"]
    header += ["No loss"] + [f"Reach {t}" for t in THRESHOLDS[1:]] + ["s to 1030, median"]
    rows = []
    for method in study.methods:
        runs = results.runs_of(scenario, method.name)
        if not runs:
            continue
        count, parts = parameters(runs[0]["parameters"])
        row = [method.label, len(runs), f"{count:,}" if count else NOTHING]
        row.append(parts or NOTHING)
        flops = runs[0]["update_flop_per_env_step"]
        row.append(NOTHING if flops is None else f"{flops / 1e6:.2f}")
        row.append(f"{runs[0]['env_steps']:,}")
        row.append(cell(mean_std([run["wall_seconds"] for run in runs]), 0))
        for name in THRESHOLDS:
            reached = sum(run[f"seconds_to_{name}"] is not None for run in runs)
            row.append(f"{reached}/{len(runs)}")
        # A training that never reaches it takes longer than any that does.
        times = [run["seconds_to_1030"] for run in runs]
        times = sorted(np.inf if time is None else time for time in times)
        middle = float(np.median(times)) if times[-1] < np.inf else times[len(times) // 2]
        row.append(f"{middle:.1f}" if middle < np.inf else "never")
        rows.append(row)
    return markdown(header, rows)


def _training_scores(study, results, scenario, name, metric="return"):
    """[conditions, seeds]: mean over the episodes of each training, or None."""
    scores = [results.scores(scenario, c, name, metric) for c in study.conditions]
    if any(s is None or len(s) != len(scores[0]) for s in scores):
        return None
    return np.array([s.mean(axis=1) for s in scores])


def improvement_table(study, results, scenario):
    """Probability, over all conditions, that a training of the row's method has a higher return than one of
    the column's. For a controller, blocks of episodes take the place of trainings."""
    names = [n for n in study.method_names() if n != "idle"]
    scores = {n: _training_scores(study, results, scenario, n) for n in names}
    names = [n for n in names if scores[n] is not None]
    labels, rows = study.labels(), []
    for ours in names[: len(study.methods)]:
        row = [labels[ours]]
        for theirs in names:
            if theirs == ours:
                row.append(NOTHING)
                continue
            point, low, high = probability_of_improvement(scores[ours], scores[theirs])
            row.append(f"{point:.2f} [{low:.2f}, {high:.2f}]")
        rows.append(row)
    return markdown(["Method"] + [labels[n] for n in names], rows)
