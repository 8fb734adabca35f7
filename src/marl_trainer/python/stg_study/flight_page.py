"""The table and the page of a study of flights: NAME.csv from its jobs, NAME.md from NAME.csv."""

import math
import os

from stg_common.csv_files import count, number, optional, table_rows
from stg_common.files import Damaged
from stg_study.collect import write_rows
from stg_study.files import write_atomically
from stg_study.flight_study import flown
from stg_study.statistics import hierarchical_interval, paired_interval
from stg_study.tables import NOTHING, cell, markdown

PLACE = ("section", "scenario", "condition", "variant")
KEY = (*PLACE, "pilot", "knows", "seeds", "episodes")
PAIRED = ("difference", "difference_low", "difference_high")
TRAINED = "Apart from their seeds, the trainings of these policies differ in these options only, as their files say.\n"
LEAST_GAP = 0.02  # if truth is worth less than this, no share of it is given
TITLES = {"scenario": "Scenario", "condition": "Condition", "variant": "Variant", "pilot": "Flown by",
          "knows": "Knows", "seeds": "Seeds", "episodes": "Episodes"}  # fmt: skip
READING = """\
All rows use the same episodes, from seed {seed} on. They are in the reporting block: no training and no choice used
them. Numbers are means over episodes; `{name}.csv` also has the standard deviations.
`rosrun marl_trainer reproduce --study {name}` makes this page. [{name}.yaml]({name}.yaml) is the study."""
READING_SEEDS = " A row with several trainings has the mean and the standard deviation over the trainings."
READING_PAIRED = (" The last column is the mean difference in `{metric}` between {pilot} and the row over the same"
                  " episodes, with its 95 % bootstrap interval over episodes.")  # fmt: skip
READING_HIERARCHY = " If there are several trainings, the bootstrap draws trainings, and then episodes of each."
READING_GAP = (" Gap closed: 0 is the best law with its own estimates, 1 is the same law with true states. There is a"
               " dash where the two differ by less than 0.02.")  # fmt: skip


def rows_of(study, cells):
    """One dictionary per cell. Incomplete cells are left out."""
    rows, episodes = [], {}
    for one in cells:
        if not all(job.complete() for job in one.jobs):
            continue
        row = {"section": one.section, "scenario": one.scenario, "condition": one.condition,
               "variant": one.variant, "pilot": one.pilot, "knows": one.knows,
               "seeds": len(one.jobs), "episodes": one.jobs[0].episodes}  # fmt: skip
        for column in study.columns:
            value = None if column.metric == "gap_closed" else flown(one, column.metric)
            row[column.metric], row[column.metric + "_std"] = value or (None, None)
        if study.compare:
            episodes[len(rows)] = [job.episode_values(study.compare_metric) for job in one.jobs]
        rows.append(row)
    _compare(study, rows, episodes)
    if study.gap_closed:
        close_gaps(rows, {name for name, pilot in study.pilots.items() if pilot.is_file()})
    return rows


def place_of(row):
    """The values that rows with the same episodes have in common."""
    return tuple(row[name] for name in PLACE)


def _compare(study, rows, episodes):
    """Sets the paired differences between the rows and the pilot that they are compared with."""
    ours = {}  # the pilot's row by place, and by place and knowledge
    for k, row in enumerate(rows):
        if row["pilot"] == study.compare:
            ours.setdefault(place_of(row), k)
            ours[place_of(row), row["knows"]] = k
    for k, values in episodes.items():
        place = place_of(rows[k])
        first = ours.get((place, rows[k]["knows"]), ours.get(place))
        if first is not None and first != k:
            several = max(len(values), len(episodes[first])) > 1
            rows[k].update(zip(PAIRED, hierarchical_interval(episodes[first], values) if several else
                               paired_interval(episodes[first][0], values[0])))  # fmt: skip


def close_gaps(rows, policies):
    """Sets gap_closed: the position of a row's share in the band between the best law on its own estimates
    (0) and the same law on true states (1); policies are no laws."""
    for place in {place_of(row) for row in rows}:
        here = [row for row in rows if place_of(row) == place]
        own = {row["pilot"]: row["band_share"] for row in here if row["knows"] == "own"}
        truth = {row["pilot"]: row["band_share"] for row in here if row["knows"] == "true states"}
        best = max((name for name in own if name not in policies), key=own.get, default=None)
        gap = truth.get(best, -math.inf) - own.get(best, 0.0)
        for row in here:
            closed = (row["band_share"] - own[best]) / gap if gap >= LEAST_GAP else None
            row["gap_closed"], row["gap_closed_std"] = closed, None


def header_of(study):
    """The columns of NAME.csv."""
    metrics = [name for column in study.columns for name in (column.metric, column.metric + "_std")]
    return [*KEY, *metrics, *(PAIRED if study.compare else ())]


def write_table(study, rows, folder):
    """Writes NAME.csv."""
    header = header_of(study)
    lines = [["" if row.get(name) is None else row[name] for name in header] for row in rows]
    write_rows(os.path.join(folder, study.name + ".csv"), header, lines)


def write_seeds(study, cells, folder):
    """Writes NAME_by_seed.csv if a pilot has several training seeds."""
    names = [column.metric for column in study.columns if column.metric != "gap_closed"]
    rows = [
        [one.section, one.scenario, one.condition, one.variant, one.pilot, seed,
         *(job.summary().get(name, "") for name in names)]
        for one in cells if len(one.jobs) > 1
        for seed, job in zip(study.pilots[one.pilot].seeds, one.jobs) if job.complete()
    ]  # fmt: skip
    if rows:
        path = os.path.join(folder, study.name + "_by_seed.csv")
        write_rows(path, [*PLACE, "pilot", "seed", *names], rows)


def read_table(study, folder):
    """The rows of NAME.csv."""
    header = header_of(study)
    kinds = {name: optional(number) for name in header}
    kinds.update(dict.fromkeys((*PLACE, "pilot", "knows"), str), seeds=count, episodes=count)
    return list(table_rows(os.path.join(folder, study.name + ".csv"), kinds))


def _value(column, row):
    """A cell of the page."""
    value = row[column.metric]
    if value is None or not math.isfinite(value):
        return NOTHING
    std = row[column.metric + "_std"] if column.std or row["seeds"] > 1 else None
    return cell((value, std), column.digits, column.scale)


def _pilot(study, name):
    """The text for a pilot on a page: code if it is an argument of --policy."""
    return name if name in study.pilots else f"`{name}`"


def section_table(study, rows):
    """The Markdown table of a section's rows. Columns with the same value in every row are left out."""
    shown = [name for name in KEY[1:] if name == "pilot" or len({row[name] for row in rows}) > 1]
    header = [TITLES[name] for name in shown] + [column.title for column in study.columns]
    header += [f"{study.compare} − row"] if study.compare else []
    lines = []
    for row in rows:
        cells = [_pilot(study, row[name]) if name == "pilot" else row[name] for name in shown]
        cells += [_value(column, row) for column in study.columns]
        if study.compare and row["difference"] is None:
            cells.append("")
        elif study.compare:
            cells.append("{:+.3f} [{:+.3f}, {:+.3f}]".format(*(row[name] for name in PAIRED)))
        lines.append(cells)
    return markdown(header, lines)


def trained_table(study):
    """The options in which trainings of pilots differ from each other."""
    lines = [
        [name, ", ".join(f"`--{option} {option_text(value)}`" for option, value in pilot.trained.items())]
        for name, pilot in study.pilots.items() if pilot.trained
    ]  # fmt: skip
    return markdown(["Flown by", "Trained with"], lines)


def option_text(value):
    """An option's value as on a command line."""
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else value


def beside_table(study, rows):
    """Compares, for each place, the first pilot of `beside` with the best of the others by the first
    column."""
    ours, *others = study.beside
    columns = [column for column in study.columns if column.beside]
    header = ["Scenario", "Condition", "Best other"] + [column.title for column in columns]
    lines = []
    for place in dict.fromkeys(place_of(row) for row in rows):
        here = {row["pilot"]: row for row in rows if place_of(row) == place and row["knows"] == "own"}
        if any(name not in here for name in study.beside):
            continue  # its flights are not finished
        best = max((here[name] for name in others), key=lambda row: row[study.columns[0].metric])
        pairs = [" / ".join(cell((row[c.metric], None), c.digits, c.scale) for row in (here[ours], best))
                 for c in columns]  # fmt: skip
        lines.append([place[1], place[2], _pilot(study, best["pilot"]), *pairs])
    return markdown(header, lines)


def training_table(path):
    """Every task's share in the band at each validation of a training, and a comparison of the last
    validation with the best one."""
    kinds = {"steps": count, "seconds": number, "task": str, "band_share": number}
    steps = {}  # {steps: {task: row}}
    for row in table_rows(path, kinds):
        steps.setdefault(row["steps"], {})[row["task"]] = row
    tasks = list(next(iter(steps.values()), {}))
    lines, means = [], []
    for step, rows in steps.items():
        if set(rows) != set(tasks):
            raise Damaged(path, f"other tasks at {step} steps")
        shares = [rows[task]["band_share"] for task in tasks]
        means.append(sum(shares) / len(shares))
        seconds = f"{rows[tasks[0]]['seconds']:.0f}"
        lines.append([f"{step:,}", seconds, *(f"{s:.3f}" for s in shares), f"{means[-1]:.3f}"])
    if not means:
        raise Damaged(path, "contains no validation")
    table = markdown(["Decisions of a swarm", "Seconds", *tasks, "Mean"], lines)
    share, last, best = means[-1] / max(means), means[-1], max(means)
    return table + f"\nThe last mean is {share:.3f} of the best one ({last:.3f} of {best:.3f}).\n"


def write_page(study, folder):
    """Writes NAME.md from NAME.csv."""
    rows = read_table(study, folder)
    reading = READING.format(seed=f"{study.seed:,}", name=study.name)
    reading += READING_SEEDS if any(row["seeds"] > 1 for row in rows) else ""
    reading += READING_GAP if study.gap_closed else ""
    if study.compare:
        reading += READING_PAIRED.format(pilot=study.compare, metric=study.compare_metric)
        reading += READING_HIERARCHY if any(row["seeds"] > 1 for row in rows) else ""
    page = [f"# {study.title}\n", reading + "\n", study.notes.strip() + "\n"] if study.notes else [
        f"# {study.title}\n", reading + "\n"]  # fmt: skip
    if study.beside:
        page += [f"## {study.beside[0]} / best of the others\n", beside_table(study, rows)]
    for section in study.sections:
        here = [row for row in rows if row["section"] == section.title]
        if here:
            episodes = {row["episodes"] for row in here}
            page.append(f"## {section.title}\n")
            if len(episodes) == 1:
                page.append(f"{episodes.pop()} episodes per row.\n")
            page.append(section_table(study, here))
    if any(pilot.trained for pilot in study.pilots.values()):
        page += ["## Trainings\n", TRAINED, trained_table(study)]
    for training in study.trainings:
        path = os.path.join(folder, training, "validation.csv")
        page += [f"## {training.replace('_', ' ').capitalize()}\n", training_table(path)]
    write_atomically(os.path.join(folder, study.name + ".md"), "\n".join(page))
