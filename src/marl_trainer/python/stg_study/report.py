"""Writes the report of a study: one page for each scenario, an overview, and the figures."""

import os

from stg_study import figure_style, figures_bars, figures_curves, figures_scores, tables, tables_cost
from stg_study.data import Paper, Results
from stg_study.files import write_atomically
from stg_study.statistics import FINAL_SHARE, RESAMPLES

# The paper's tables: main, final stage, per seed, stress.
PAPER_TABLES = {"medium": ("1", "S3", "S4", "S7"), "hard": ("2", "S5", "S6", "S8")}

CONVENTIONS = """\
- Distances are in workspace units. This simulator reads them as metres; the paper calls them km.
- **Return** uses the scenario's own reward for every method, even if the method was trained with another
  reward. **Training's return** uses, for the same episodes, the reward of the method's training. It is a
  dash where it was not measured, and for controllers, because they are not trained. The figures show the
  return.
- The paper's rows: in the authors' release, the return of each algorithm uses the reward of its training.
  For STG-MAPPO this is the scenario's reward. For the baselines it is another reward, so their returns are
  only in the column of the training's return.
- Evaluations (Tables 1, 2, S7, S8, comparison, interquartile means) **sum** returns over the AUVs.
  Training curves and final stages (Tables S3-S6, S9, curves, bars) **average** them over the AUVs, as
  the paper does. The two differ by a factor of {agents}, the number of AUVs.
- Tail: the last 100 decisions. Tracking error and lost rate are those of the whole episode in Tables
  S3-S6, and those of the tail in Tables 1, 2, S7 and S8.
- Final stage: the last {final} % of the validations of a training. A validation runs the deterministic
  policy in held-out episodes. Best checkpoint: the validation with the highest training's return. The
  evaluations use this checkpoint.
- Evaluation: {episodes} episodes from seed {first} + {stride} x training seed. They are in the reporting
  block: no training, validation or other choice used them. Controllers and policies use the same episodes.
- mean ± std: in Tables 1, 2, S3, S5 and S9 over training seeds, and for a controller over as many blocks
  of episodes. In Tables S7, S8 and the comparison over the episodes of all seeds.
- Interquartile means: the score of a training in a condition is the mean over its episodes. The middle
  half of all scores is averaged. For the 95 % bootstrap intervals, the trainings are drawn again {resamples}
  times. With {seeds} seeds the intervals are rough.
- Probability of improvement: Agarwal et al. 2021. It is 0.5 for equal methods.
- Colliding pairs: number of pairs of AUVs in contact, mean over the decisions of the episode or of the
  tail. The paper does not have these numbers. In band: share of the tail with d between d_l and d_u.
- Rows marked (paper) have the paper's own numbers.
"""


def _heading(table, ours):
    return f"Table {table}: {ours}" if table else ours[0].upper() + ours[1:]


def _figure(name, text):
    return f"![{text}](figures/{name}.png)\n"


def scenario_page(study, results, paper, scenario, folder):
    """Markdown of one scenario. Its figures are written to `folder`/figures."""
    name, figures = scenario.name, os.path.join(folder, "figures")
    main, final, seeds, stress = PAPER_TABLES.get(scenario.paper, ("", "", "", ""))
    medium = scenario.paper == "medium"
    page = [f"# {study.title}: {name}\n"]

    def section(title, *parts):
        page.append("## " + title + "\n")
        page.extend(parts)

    section(
        _heading(main, "nominal and combined stress, best checkpoints"),
        tables.main_table(study, results, paper, name, main),
    )
    section(
        _heading(final, "final stage, last 20 % of the validations"),
        tables.final_table(study, results, paper, name, final),
    )
    section(
        _heading(seeds, "final stage of every seed"),
        tables.seed_table(study, results, paper, name, seeds),
    )
    section(
        _heading(stress, "best checkpoints under every condition"),
        tables.stress_table(study, results, paper, name, stress),
    )
    if tables.ablated(study):
        section(
            _heading("S9" if medium else "", "ablation, final stage"),
            tables.ablation_table(study, results, paper, name, medium),
            _figure(
                figures_bars.ablation(study, results, paper, name, figures, medium), "Ablation"
            ),
        )
    section(
        "Interquartile means and 95 % bootstrap intervals",
        tables.iqm_table(study, results, name),
    )
    section(
        "Probability of improvement",
        "The probability that a training of the row's method has a higher return than one of the "
        "column's method: mean over the conditions, with a 95 % bootstrap interval over trainings. "
        "For a controller, blocks of episodes take the place of trainings.\n",
        tables_cost.improvement_table(study, results, name),
    )
    section("Cost", tables_cost.cost_table(study, results, name))
    if any(results.seeds(name, method.name) for method in study.methods):
        section(
            "Figures of the training",
            _figure(
                figures_curves.convergence(study, results, paper, name, final, figures),
                "Convergence",
            ),
            _figure(
                figures_bars.final_stage(study, results, paper, name, final, figures),
                "Final stage",
            ),
            _figure(figures_bars.final_boxes(study, results, name, figures), "Final stage, boxes"),
            _figure(
                figures_curves.reward_components(study, results, name, figures), "Reward terms"
            ),
            _figure(figures_curves.per_seed(study, results, name, figures), "Every training"),
            _figure(figures_scores.effort(study, results, name, figures), "Time and actions"),
        )
    section(
        "Performance profiles",
        _figure(figures_scores.profiles(study, results, name, figures), "Profiles"),
    )
    section(
        "Figure of the stress conditions",
        _figure(
            figures_bars.stress_boxes(study, results, paper, name, stress, figures), "Conditions"
        ),
    )
    return "\n".join(page)


def write_report(study, folder):
    """Writes report.md, a page for each scenario and the figures from the CSVs in `folder`."""
    figure_style.check_labels(study, os.path.join(folder, "study.yaml"))
    results, paper = Results(folder), Paper()
    overview = [f"# {study.title}\n"]
    if study.notes:
        overview.append(study.notes.strip() + "\n")
    command = f"rosrun marl_trainer reproduce --study {study.name} --out FOLDER"
    overview.append(
        f"`{command}` makes these results. With `--report-only` it makes only the pages and figures "
        "again, from the CSV files. [study.yaml](study.yaml) is the study.\n"
    )
    for scenario in study.scenarios:
        page = scenario_page(study, results, paper, scenario, folder)
        write_atomically(os.path.join(folder, scenario.name + ".md"), page)
        stress = PAPER_TABLES.get(scenario.paper, ("",) * 4)[3]
        overview.append(f"## {scenario.name}\n")
        overview.append(f"All tables and figures: [{scenario.name}.md]({scenario.name}.md)\n")
        overview.append(tables.comparison_table(study, results, paper, scenario.name, stress))
    overview.append("## Trainings\n")
    overview.append(
        "The first table has the options of the first training of each method. The next tables have "
        "the number of trained parameters, the operations in the matrix products of the updates per "
        "environment step, and the wall time with one worker while several trainings ran at once. "
        "The time to a return is that of the first validation that reached it without losing a "
        "target.\n"
    )
    overview.append(tables_cost.options_table(study, results))
    for scenario in study.scenarios:
        overview.append(f"### {scenario.name}\n")
        overview.append(tables_cost.cost_table(study, results, scenario.name))
    overview.append("### Every training\n")
    overview.append(tables.runs_table(study, results))
    overview.append("## How to read the tables\n")
    overview.append(
        CONVENTIONS.format(
            agents=study.agents,
            episodes=study.episodes,
            first=study.evaluation_seed,
            stride=study.evaluation_seed_stride,
            final=round(100 * FINAL_SHARE),
            resamples=RESAMPLES,
            seeds={2: "two", 3: "three", 5: "five"}.get(len(study.seeds), len(study.seeds)),
        )
    )
    write_atomically(os.path.join(folder, "report.md"), "\n".join(overview))
