"""The report's tables as Markdown, laid out like the paper's with its rows below ours."""

from stg_study.statistics import iqm_interval, mean_std

# Column title, metric of an evaluation or validation, digits after the point.
CONTACT = [
    ("Coll. pairs", "colliding_pairs", 2),
    ("Coll. pairs, tail", "tail_colliding_pairs", 2),
]
STRESS = [
    ("Return", "return", 1),
    ("Tail dist.", "tail_distance", 4),
    ("Track err.", "tracking_error", 4),
    ("Lost", "lost_rate", 3),
    ("Action", "action_norm", 3),
    ("Sat.", "saturation_rate", 3),
    ("Control", "control_cost", 3),
    ("Comm.", "communication_quality", 3),
]
# Training curves: the paper averages the agents' returns and takes the error and the lost rate
# over the whole episode (its final errors of .012 go with tail distances of .014).
FINAL = [
    ("Return", "return", 2),
    ("Tail dist.", "tail_distance", 4),
    ("Track err.", "mean_error", 4),
    ("Lost", "whole_lost_rate", 3),
    ("Sat.", "saturation_rate", 3),
    ("Control", "control_cost", 3),
]
PAPER_NAME = {"mean_error": "tracking_error", "whole_lost_rate": "lost_rate"}
CONDITION_LABELS = {
    "nominal": "Nominal",
    "fast_target": "Fast target",
    "far_initialization": "Far initialization",
    "limited_sensing": "Limited sensing",
    "degraded_communication": "Communication degraded",
    "combined_stress": "Combined stress",
}
NOTHING = "–"
TEXT_COLUMNS = {"Algorithm", "Condition", "Method", "Scenario", "Seed IDs", "Variant", "Who"}
TEXT_COLUMNS |= {"of these"}


def condition_label(condition):
    """A condition as the paper writes it."""
    return CONDITION_LABELS.get(condition, condition.replace("_", " ").capitalize())


def cell(value, digits, scale=1.0):
    """`mean ± std`, only the mean where there is no std, a dash where there is no value."""
    if value is None:
        return NOTHING
    mean, std = value
    text = f"{mean * scale:.{digits}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text if std is None else f"{text} ± {std * scale:.{digits}f}"


def _line(cells):
    """A line of a Markdown table; a label may hold the sign that ends a cell."""
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


def main_table(study, results, paper, scenario, table):
    """Tables 1 and 2: distances and losses, mean ± std of the seeds' means; the return averaged
    over all conditions, its std over seeds and conditions together."""
    header = ["Algorithm", "Nominal dist.", "Combined dist.", "Nominal lost", "Combined lost"]
    header += ["Avg. return", "Nominal coll. pairs", "tail", "Combined coll. pairs", "tail"]
    cells = [(c, m) for m in ("tail_distance", "lost_rate") for c in ("nominal", "combined_stress")]
    rows = []
    for name in study.method_names():
        row = [study.labels()[name]]
        for condition, metric in cells:
            row.append(cell(results.over_seeds(scenario, condition, name, metric), 4))
        means = []
        for condition in study.conditions:
            scores = results.scores(scenario, condition, name, "return")
            means += [] if scores is None else list(scores.mean(axis=1))
        row.append(cell(mean_std(means) if means else None, 2))
        for condition in ("nominal", "combined_stress"):
            for _, metric, digits in CONTACT:
                row.append(cell(results.over_seeds(scenario, condition, name, metric), digits))
        rows.append(row)
    for algorithm in paper.algorithms(table):
        row = [f"{algorithm} (paper)"]
        row += [cell(paper.get(table, algorithm, m, c), 3) for c, m in cells]
        row += [cell(paper.get(table, algorithm, "return", "all"), 2)] + [NOTHING] * 4
        rows.append(row)
    return markdown(header, rows)


def _final_row(study, results, scenario, name, columns):
    """Final-stage cells of a method, or of a controller from its nominal evaluation."""
    row = []
    for _, metric, digits in columns:
        scale = 1.0 / study.agents if metric == "return" else 1.0
        value = results.final_over_seeds(scenario, name, metric)
        if value is None:
            value = results.over_seeds(scenario, "nominal", name, metric)
        row.append(cell(value, digits, scale))
    return row


def final_table(study, results, paper, scenario, table):
    """Tables S3 and S5: the last fifth of the validations, mean ± std over seeds."""
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
            value = paper.get(table, algorithm, PAPER_NAME.get(metric, metric))
            row.append(cell(value, min(digits, 3)))
        rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Seeds"] + [c[0] for c in columns], rows)


def seed_table(study, results, paper, scenario, table):
    """Tables S4 and S6: the final stage of every training, the controllers' evaluations by block
    of evaluation seeds."""
    columns = FINAL + CONTACT
    rows = []
    for method in study.methods:
        for seed in results.seeds(scenario, method.name):
            points = len(results.curve(scenario, method.name, seed, "return"))
            row = [method.label, seed, points]
            for _, metric, digits in columns:
                values = results.final_points(scenario, method.name, seed, metric)
                scale = 1.0 / study.agents if metric == "return" else 1.0
                row.append(cell((sum(values) / len(values), None), digits, scale))
            rows.append(row)
    for controller in study.controllers:
        scores = {
            metric: results.scores(scenario, "nominal", controller.name, metric)
            for _, metric, _ in columns
        }
        if scores["return"] is None:
            continue
        seeds = results.evaluated_seeds(scenario, "nominal", controller.name)
        for block, seed in enumerate(seeds):
            row = [controller.label, seed, NOTHING]
            for _, metric, digits in columns:
                scale = 1.0 / study.agents if metric == "return" else 1.0
                row.append(cell((scores[metric][block].mean(), None), digits, scale))
            rows.append(row)
    for algorithm in paper.algorithms(table):
        for seed in paper.seeds(table, algorithm):
            points = paper.get(table, algorithm, "evaluation_points", seed=seed)
            row = [f"{algorithm} (paper)", seed, cell(points, 0)]
            for _, metric, digits in FINAL:
                value = paper.get(table, algorithm, PAPER_NAME.get(metric, metric), seed=seed)
                row.append(cell(value, min(digits, 3)))
            rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Seed", "Eval pts"] + [c[0] for c in columns], rows)


def stress_table(study, results, paper, scenario, table):
    """Tables S7 and S8: best checkpoints under every condition, mean ± std over all episodes."""
    columns = STRESS + CONTACT
    rows = []
    for name in study.method_names():
        for condition in study.conditions:
            row = [study.labels()[name], condition_label(condition)]
            for _, metric, digits in columns:
                row.append(cell(results.over_episodes(scenario, condition, name, metric), digits))
            rows.append(row)
    for algorithm in paper.algorithms(table):
        for condition in study.conditions:
            row = [f"{algorithm} (paper)", condition_label(condition)]
            for _, metric, digits in STRESS:
                value = paper.get(table, algorithm, metric, condition)
                row.append(cell(value, min(digits, 3)))
            rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Algorithm", "Condition"] + [c[0] for c in columns], rows)


def ablated(study):
    """The methods of the ablation."""
    return [method for method in study.methods if method.ablation]


def ablation_table(study, results, paper, scenario, with_paper):
    """Table S9: the variants over the final stage; the paper's is of its medium scenario."""
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
            value = paper.get("S9", algorithm, PAPER_NAME.get(metric, metric))
            row.append(cell(value, min(digits, 3)))
        rows.append(row + [NOTHING] * len(CONTACT))
    return markdown(["Variant", "Seeds", "Seed IDs"] + [c[0] for c in columns], rows)


IQM_METRICS = [c for c in STRESS if c[1] in ("return", "tail_distance", "tracking_error")]
IQM_METRICS += [("Lost", "lost_rate", 3)] + CONTACT


def iqm_table(study, results, scenario):
    """Interquartile means of every condition and of all together, 95 % bootstrap intervals."""
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
    header = ["Condition", "Who", "Return", "Tail dist.", "Tail err.", "Lost"]
    header += [c[0] for c in CONTACT]
    metrics = [c for c in STRESS[:4]]
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
    """How long every training took, and when it first reached each return without a loss."""
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
