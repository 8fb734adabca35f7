"""The report's tables as Markdown. Their layout is the paper's, with the paper's rows below ours."""

from stg_study.statistics import iqm_interval, mean_std

# Column title, metric of an evaluation or validation, digits after the point.
CONTACT = [
    ("Coll. pairs", "colliding_pairs", 2),
    ("Coll. pairs, tail", "tail_colliding_pairs", 2),
]
STRESS = [
    ("Return", "return", 1),
    ("Training's return", "training_return", 1),
    ("Tail dist.", "tail_distance", 4),
    ("Track err.", "tracking_error", 4),
    ("Lost", "lost_rate", 3),
    ("Action", "action_norm", 3),
    ("Sat.", "saturation_rate", 3),
    ("Control", "control_cost", 3),
    ("Comm.", "communication_quality", 3),
]
# Training curves: the paper averages the returns of the agents, and takes error and lost rate over the whole
# episode (its final errors of .012 belong to tail distances of .014).
FINAL = [
    ("Return", "scenario_return", 2),
    ("Training's return", "return", 2),
    ("Tail dist.", "tail_distance", 4),
    ("Track err.", "mean_error", 4),
    ("Lost", "whole_lost_rate", 3),
    ("Sat.", "saturation_rate", 3),
    ("Control", "control_cost", 3),
]
PAPER_NAME = {"mean_error": "tracking_error", "whole_lost_rate": "lost_rate"}
RETURNS = ("return", "training_return", "scenario_return")
FINAL_TABLES = ("S3", "S4", "S5", "S6", "S9")
CONDITION_LABELS = {
    "nominal": "Nominal",
    "fast_target": "Fast target",
    "far_initialization": "Far initialization",
    "limited_sensing": "Limited sensing",
    "degraded_communication": "Communication degraded",
    "combined_stress": "Combined stress",
}
NOTHING = "–"
NONE_THERE = 1e9  # value of a metric if there is nothing to measure: the distance to no obstacle
TEXT_COLUMNS = {"Algorithm", "Condition", "Flown by", "Method", "Scenario", "Seed IDs", "Variant"}
TEXT_COLUMNS |= {"Networks", "Best other", "Knows"}


def paper_value(paper, table, algorithm, metric, *key):
    """The paper's figure of a metric. Its release tabulates returns by the reward of each algorithm's
    training. Only for STG-MAPPO this is the scenario's reward."""
    training = "return" if table in FINAL_TABLES else "training_return"
    if metric in RETURNS:
        if metric != training and not algorithm.startswith("STG-MAPPO"):
            return None
        metric = "return"
    return paper.get(table, algorithm, PAPER_NAME.get(metric, metric), *key)


def training_metric(study, name, metric):
    """The column of a metric for a method or controller. If both returns are the same, only `return` is
    measured. None if it is not measured."""
    rewards = {method.name: method.reward() for method in study.methods}
    if metric not in RETURNS[1:]:
        return metric
    reward = rewards.get(name, "scenario")
    if reward == "variant":
        return metric
    if name not in rewards and metric == "training_return":
        return None  # a controller is not trained with a reward
    return "return" if reward == "scenario" else None


def condition_label(condition):
    """A condition in the paper's words."""
    return CONDITION_LABELS.get(condition, condition.replace("_", " ").capitalize())


def cell(value, digits, scale=1.0):
    """`mean ± std`; only the mean if there is no std; a dash if there is no value."""
    if value is None or value[0] >= NONE_THERE:
        return NOTHING
    mean, std = value
    text = f"{mean * scale:.{digits}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text if std is None else f"{text} ± {std * scale:.{digits}f}"


def _line(cells):
    """A line of a Markdown table. A label may contain the sign that ends a cell, so this is escaped."""
    return "| " + " | ".join(str(value).replace("|", "\\|") for value in cells) + " |"


def markdown(header, rows):
    """A Markdown table with its numbers aligned to the right."""
    rules = ["---" if name in TEXT_COLUMNS else "---:" for name in header]
    lines = [_line(header), "|" + "|".join(rules) + "|"]
    for row in rows:
        if len(row) != len(header):
            raise ValueError(f"{len(row)} cells in a table of {len(header)} columns: {row}")
        lines.append(_line(row))
    return "\n".join(lines) + "\n"


def over_seeds(study, results, scenario, conditions, name, metric):
    """(mean, std) over seeds of their means over the conditions, or None."""
    column = training_metric(study, name, metric)
    scores = [results.scores(scenario, c, name, column) for c in conditions if column]
    if not scores or any(s is None or len(s) != len(scores[0]) for s in scores):
        return None
    return mean_std(sum(s.mean(axis=1) for s in scores) / len(scores))


def main_table(study, results, paper, scenario, table):
    """Tables 1 and 2: distances, losses and returns, averaged over all conditions, as mean ± std of the
    seeds' means."""
    header = ["Algorithm", "Nominal dist.", "Combined dist.", "Nominal lost", "Combined lost"]
    header += ["Avg. return", "Avg. training's return"]
    header += ["Nominal coll. pairs", "tail", "Combined coll. pairs", "tail"]
    cells = [(c, m) for m in ("tail_distance", "lost_rate") for c in ("nominal", "combined_stress")]
    rows = []
    for name in study.method_names():
        row = [study.labels()[name]]
        for condition, metric in cells:
            row.append(cell(results.over_seeds(scenario, condition, name, metric), 4))
        for metric in RETURNS[:2]:
            row.append(
                cell(over_seeds(study, results, scenario, study.conditions, name, metric), 2)
            )
        for condition in ("nominal", "combined_stress"):
            for _, metric, digits in CONTACT:
                row.append(cell(results.over_seeds(scenario, condition, name, metric), digits))
        rows.append(row)
    for algorithm in paper.algorithms(table):
        row = [f"{algorithm} (paper)"]
        row += [cell(paper.get(table, algorithm, m, c), 3) for c, m in cells]
        for metric in RETURNS[:2]:
            row.append(cell(paper_value(paper, table, algorithm, metric, "all"), 2))
        rows.append(row + [NOTHING] * 4)
    return markdown(header, rows)


def final_value(study, results, scenario, name, metric):
    """(mean, std) over seeds of the final stage of a method, or of a controller's nominal evaluation; None if
    there is none. Returns are averaged over the AUVs."""
    column = training_metric(study, name, metric)
    value = column and results.final_over_seeds(scenario, name, column)
    if not value and column and not results.seeds(scenario, name):
        own = metric == "return" and name not in {m.name for m in study.methods}
        value = None if own else results.over_seeds(scenario, "nominal", name, column)
    if not value or metric not in RETURNS:
        return value or None
    mean, std = value
    return mean / study.agents, std and std / study.agents


def _final_row(study, results, scenario, name, columns):
    """Final-stage cells of a method, or of a controller from its nominal evaluation."""
    return [
        cell(final_value(study, results, scenario, name, metric), digits)
        for _, metric, digits in columns
    ]


def final_table(study, results, paper, scenario, table):
    """Tables S3 and S5: the last fifth of the validations, as mean ± std over seeds."""
    columns = FINAL + CONTACT
    rows = []
    for name in study.method_names():
        count = len(results.seeds(scenario, name)) or NOTHING
        rows.append(
            [study.labels()[name], count] + _final_row(study, results, scenario, name, columns)
        )
    for algorithm in paper.algorithms(table):
        row = [f"{algorithm} (paper)", 3]
        for _, metric, digits in FINAL:
            row.append(cell(paper_value(paper, table, algorithm, metric), min(digits, 3)))
        rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Seeds"] + [c[0] for c in columns], rows)


def seed_table(study, results, paper, scenario, table):
    """Tables S4 and S6: the final stage of every training, and the controllers' evaluations by block of
    evaluation seeds."""
    columns = FINAL + CONTACT
    rows = []
    for method in study.methods:
        for seed in results.seeds(scenario, method.name):
            points = len(results.curve(scenario, method.name, seed, "tail_distance"))
            row = [method.label, seed, points]
            for _, metric, digits in columns:
                column = training_metric(study, method.name, metric)
                values = column and results.final_points(scenario, method.name, seed, column)
                scale = 1.0 / study.agents if metric in RETURNS else 1.0
                value = (sum(values) / len(values), None) if values else None
                row.append(cell(value, digits, scale))
            rows.append(row)
    for controller in study.controllers:
        seeds = results.evaluated_seeds(scenario, "nominal", controller.name)
        for block, seed in enumerate(seeds):
            row = [controller.label, seed, NOTHING]
            for _, metric, digits in columns:
                scale = 1.0 / study.agents if metric in RETURNS else 1.0
                column = training_metric(study, controller.name, metric)
                if metric == "return":
                    row.append(NOTHING)
                    continue
                scores = results.scores(scenario, "nominal", controller.name, column)
                row.append(cell((scores[block].mean(), None), digits, scale))
            rows.append(row)
    for algorithm in paper.algorithms(table):
        for seed in paper.seeds(table, algorithm):
            points = paper.get(table, algorithm, "evaluation_points", seed=seed)
            row = [f"{algorithm} (paper)", seed, cell(points, 0)]
            for _, metric, digits in FINAL:
                value = paper_value(paper, table, algorithm, metric, "nominal", seed)
                row.append(cell(value, min(digits, 3)))
            rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Seed", "Eval pts"] + [c[0] for c in columns], rows)


def stress_table(study, results, paper, scenario, table):
    """Tables S7 and S8: best checkpoints under every condition, as mean ± std over all episodes."""
    columns = STRESS + CONTACT
    rows = []
    for name in study.method_names():
        for condition in study.conditions:
            row = [study.labels()[name], condition_label(condition)]
            for _, metric, digits in columns:
                column = training_metric(study, name, metric)
                value = column and results.over_episodes(scenario, condition, name, column)
                row.append(cell(value or None, digits))
            rows.append(row)
    for algorithm in paper.algorithms(table):
        for condition in study.conditions:
            row = [f"{algorithm} (paper)", condition_label(condition)]
            for _, metric, digits in STRESS:
                value = paper_value(paper, table, algorithm, metric, condition)
                row.append(cell(value, min(digits, 3)))
            rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Condition"] + [c[0] for c in columns], rows)


def ablated(study):
    """The methods of the ablation."""
    return [method for method in study.methods if method.ablation]


def ablation_table(study, results, paper, scenario, with_paper):
    """Table S9: the variants in the final stage. The paper's values are for its medium scenario."""
    columns = [c for c in FINAL if c[1] != "mean_error"] + CONTACT
    rows = []
    for method in reversed(ablated(study)):
        seeds = results.seeds(scenario, method.name)
        row = [method.label, len(seeds), ",".join(map(str, seeds)) or NOTHING]
        rows.append(row + _final_row(study, results, scenario, method.name, columns))
    for controller in study.controllers:
        row = [controller.label, NOTHING, NOTHING]
        rows.append(row + _final_row(study, results, scenario, controller.name, columns))
    for algorithm in paper.algorithms("S9") if with_paper else []:
        row = [f"{algorithm} (paper)", 3, "0,1,2"]
        for _, metric, digits in columns[: -len(CONTACT)]:
            row.append(cell(paper_value(paper, "S9", algorithm, metric), min(digits, 3)))
        rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Variant", "Seeds", "Seed IDs"] + [c[0] for c in columns], rows)


IQM_METRICS = [c for c in STRESS if c[1] in ("return", "tail_distance", "tracking_error")]
IQM_METRICS += [("Lost", "lost_rate", 3)] + CONTACT


def iqm_table(study, results, scenario):
    """Interquartile means for every condition and for all together, with 95 % bootstrap intervals."""
    rows = []
    groups = [(condition_label(c), [c]) for c in study.conditions]
    if len(study.conditions) > 1:
        groups.append(("All conditions", study.conditions))
    for name in study.method_names():
        for label, conditions in groups:
            row = [study.labels()[name], label]
            for _, metric, digits in IQM_METRICS:
                scores = [results.scores(scenario, c, name, metric) for c in conditions]
                if any(s is None or len(s) != len(scores[0]) for s in scores):
                    row.append(NOTHING)
                    continue
                point, low, high = iqm_interval(scores)
                row.append(f"{point:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]")
            rows.append(row)
    return markdown(["Algorithm", "Condition"] + [c[0] for c in IQM_METRICS], rows)


def comparison_table(study, results, paper, scenario, table):
    """Return, tail distance, tail error, lost rate and contacts side by side, by condition."""
    reference = [c.name for c in study.controllers if c.name != "idle"]
    metrics = STRESS[:1] + STRESS[2:5] + [("In band", "band_rate", 2)]
    header = ["Condition", "Flown by"] + [c[0] for c in metrics + CONTACT]
    rows = []
    for condition in study.conditions:
        for name in [m.name for m in study.methods if m.variant == "stg"] + reference:
            row = [condition_label(condition), study.labels()[name]]
            for _, metric, digits in metrics + CONTACT:
                row.append(cell(results.over_episodes(scenario, condition, name, metric), digits))
            rows.append(row)
        if paper.get(table, "STG-MAPPO", "return", condition) is not None:
            row = [condition_label(condition), "STG-MAPPO (paper)"]
            for _, metric, digits in metrics:
                row.append(cell(paper.get(table, "STG-MAPPO", metric, condition), min(digits, 3)))
            rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(header, rows)


def runs_table(study, results):
    """Duration of every training, and the times at which it first reached each return without a loss."""
    times = [("no loss", "no_loss")] + [(t, t) for t in ("1000", "1020", "1030", "1040")]
    header = ["Scenario", "Method", "Seed", "Steps", "Wall s", "Steps/s"]
    header += [f"s to {label}" for label, _ in times]
    rows = []
    for run in results.runs:
        row = [run["scenario"], study.labels().get(run["method"], run["method"]), run["seed"]]
        row += [f"{run['env_steps']:,}", f"{run['wall_seconds']:.1f}"]
        row.append(f"{run['env_steps_per_second']:,.0f}")
        for _, name in times:
            value = run[f"seconds_to_{name}"]
            row.append(NOTHING if value is None else f"{value:.1f}")
        rows.append(row)
    return markdown(header, rows)
