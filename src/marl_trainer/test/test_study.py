"""Tests of the parts of a study: time left, table cells, the paper's figures, the reader of studies."""

import os
import tempfile
import unittest

import numpy as np
import yaml

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))

from stg_study import figure_style, jobs, runner, study
from stg_study import tables, tables_cost
from stg_study.data import Paper
from stg_study.figures_curves import comparable

STUDIES = ("acoustic", "baselines", "equal_terms", "full", "paper")


class Job:
    """What the estimate needs to know of a job."""

    def __init__(self, kind, fraction=0.0):
        self.kind, self._fraction = kind, fraction

    def fraction_done(self):
        return self._fraction


class Running:
    """A job that has run for `seconds` and began at `start_fraction`."""

    def __init__(self, job, seconds, start_fraction=0.0):
        self.job, self.start_fraction, self._seconds = job, start_fraction, seconds

    def seconds(self):
        return self._seconds


class TimeLeft(unittest.TestCase):
    def test_finished_jobs_tell_how_long_the_rest_takes(self):
        estimate = runner.Estimate()
        estimate.add("training", 40.0)
        estimate.add("evaluation", 2.0)
        waiting = [Job("training"), Job("evaluation"), Job("evaluation")]
        running = [Running(Job("training", 0.75), 30.0)]
        self.assertEqual(estimate.left(waiting, running, 2), (1.25 * 40.0 + 2 * 2.0) / 2.0)

    def test_running_training_tells_before_any_is_finished(self):
        estimate = runner.Estimate()
        self.assertIsNone(estimate.left([Job("training")], [], 1))
        # A resumed training went from one half to three quarters in 10 s. A whole one takes 40 s.
        running = [Running(Job("training", 0.75), 10.0, 0.5)]
        self.assertEqual(estimate.left([Job("training")], running, 1), 50.0)

    def test_durations_are_for_people(self):
        texts = [runner.duration(s) for s in (4.4, 200.0, 3900.0)]
        self.assertEqual(texts, ["4 s", "3 min 20 s", "1 h 05 min"])


class Cells(unittest.TestCase):
    def test_cells_read_as_in_the_paper(self):
        self.assertEqual(tables.cell((254.806, 11.66), 2), "254.81 ± 11.66")
        self.assertEqual(tables.cell((0.0131, None), 3), "0.013")
        self.assertEqual(tables.cell(None, 3), "–")
        self.assertEqual(tables.cell((1e9, 0.0), 1), "–")
        self.assertEqual(tables.cell((-0.0001, 0.0), 3), "0.000 ± 0.000")
        self.assertEqual(tables.cell((1019.2, 46.6), 2, scale=0.25), "254.80 ± 11.65")

    def test_tables_are_complete_rows_of_markdown(self):
        text = tables.markdown(["Algorithm", "Return"], [["A", 1.5]])
        self.assertEqual(text, "| Algorithm | Return |\n|---|---:|\n| A | 1.5 |\n")
        text = tables.markdown(["|e|"], [["a|"]])
        self.assertEqual(text, "| \\|e\\| |\n|---:|\n| a\\| |\n")
        with self.assertRaises(ValueError):
            tables.markdown(["Algorithm", "Return"], [["A"]])


class Cost(unittest.TestCase):
    def test_networks_that_are_alike_are_counted_together(self):
        text = "actor_0:9158 actor_1:9158 critic:27265"
        self.assertEqual(tables_cost.parameters(text), (45581, "2 × actor 9,158, critic 27,265"))
        self.assertEqual(tables_cost.parameters("values:10"), (10, "values 10"))
        self.assertEqual(tables_cost.parameters(""), (0, ""))


class PaperFigures(unittest.TestCase):
    """Compares the copied tables of the paper with the paper and with each other."""

    def setUp(self):
        self.paper = Paper()

    def test_figures_stand_as_printed(self):
        get = self.paper.get
        stg = "STG-MAPPO"
        self.assertEqual(get("1", stg, "return", "all"), (1018.84, 15.93))
        self.assertEqual(get("2", "MAPPO", "tail_distance", "combined_stress"), (0.095, 0.040))
        self.assertEqual(get("S3", stg, "return"), (254.81, 11.66))
        self.assertEqual(get("S5", stg, "tracking_error"), (0.022, 0.004))
        self.assertEqual(get("S6", "MASAC", "tail_distance", seed=2), (1.304, None))
        self.assertEqual(get("S7", stg, "return", "combined_stress"), (1002.0, 44.1))
        self.assertEqual(get("S7", "MASAC", "tail_distance", "far_initialization"), (1.205, 0.152))
        self.assertEqual(get("S8", stg, "return", "fast_target"), (979.9, 78.0))
        self.assertEqual(get("S8", "HAPPO", "communication_quality"), (0.128, 0.202))
        self.assertEqual(get("S9", "MAPPO-semantic-state", "control_cost"), (0.039, 0.003))
        self.assertIsNone(get("S7", stg, "colliding_pairs"))

    def test_every_algorithm_and_condition_is_there(self):
        for table in ("1", "2", "S3", "S4", "S5", "S6", "S7", "S8"):
            self.assertEqual(len(self.paper.algorithms(table)), 7, table)
        for table in ("S7", "S8"):
            for algorithm in self.paper.algorithms(table):
                for condition in tables.CONDITION_LABELS:
                    for _, metric, _ in tables.STRESS:
                        if metric == "training_return":
                            continue  # the paper has one return
                        self.assertIsNotNone(self.paper.get(table, algorithm, metric, condition))
        for table in ("S4", "S6"):
            for algorithm in self.paper.algorithms(table):
                self.assertEqual(self.paper.seeds(table, algorithm), ["0", "1", "2"])

    def test_average_returns_are_the_mean_of_the_stress_tables(self):
        """Tables 1 and 2 average Tables S7 and S8. This checks 84 copied returns."""
        for main, stress in (("1", "S7"), ("2", "S8")):
            for algorithm in self.paper.algorithms(main):
                returns = [
                    self.paper.get(stress, algorithm, "return", c)[0]
                    for c in tables.CONDITION_LABELS
                ]
                average = self.paper.get(main, algorithm, "return", "all")[0]
                self.assertAlmostEqual(np.mean(returns), average, delta=0.06, msg=algorithm)

    def test_final_stages_are_the_mean_of_the_seeds(self):
        for final, seeds in (("S3", "S4"), ("S5", "S6")):
            for algorithm in self.paper.algorithms(final):
                for _, metric, digits in tables.FINAL[1:]:  # only the return of the training
                    name = tables.PAPER_NAME.get(metric, metric)
                    mean, std = self.paper.get(final, algorithm, name)
                    values = [self.paper.get(seeds, algorithm, name, seed=s)[0] for s in range(3)]
                    unit = 0.01 if metric == "return" else 0.001
                    where = f"{final} {algorithm} {name}"
                    self.assertAlmostEqual(np.mean(values), mean, delta=1.01 * unit, msg=where)
                    self.assertAlmostEqual(np.std(values, ddof=1), std, delta=1.6 * unit, msg=where)


class PolicyFiles(unittest.TestCase):
    def test_one_for_all_goes_before_one_for_each(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "policy_best.onnx")
            self.assertIsNone(jobs.policy_hash(path))
            own = [os.path.join(folder, f"policy_best_{i}.onnx") for i in range(2)]
            for i, name in enumerate(own):
                with open(name, "w", encoding="utf-8") as file:
                    file.write(str(i))
            self.assertEqual(jobs.policy_files(path), own)
            before = jobs.policy_hash(path)
            with open(own[1], "w", encoding="utf-8") as file:
                file.write("changed")
            self.assertNotEqual(jobs.policy_hash(path), before)
            with open(path, "w", encoding="utf-8") as file:
                file.write("all")
            self.assertEqual(jobs.policy_files(path), [path])


class Figures(unittest.TestCase):
    def test_a_method_has_one_colour_in_all_studies_and_none_of_another(self):
        tables_of = [figure_style.colours(study.load_study(study.find_study(name)))
                     for name in STUDIES]
        known = {}
        for table in tables_of:
            for name, colour in table.items():
                self.assertEqual(known.setdefault(name, colour), colour, name)
        self.assertGreaterEqual(len(known), 18)
        for table in tables_of:
            self.assertEqual(len(set(table.values())), len(table), table)

    def test_a_legend_is_whole_and_below_what_is_drawn(self):
        plt = figure_style.plt
        for labels in (["one"], [f"a method with a rather long name, number {i}" for i in range(11)]):
            figure, axes = plt.subplots(1, 2, figsize=(9.0, 6.0))
            handles = [axes[0].plot([0, 1], [0, i])[0] for i in range(len(labels))]
            axes[0].set_xlabel("steps")
            figure_style.legend_below(figure, handles, labels)
            figure.canvas.draw()
            (legend,) = figure.legends
            box = legend.get_window_extent()
            self.assertGreaterEqual(box.x0, 0.0)
            self.assertLessEqual(box.x1, figure.bbox.width)
            self.assertGreaterEqual(box.y0, 0.0)
            for axis in axes:
                self.assertGreaterEqual(axis.get_tightbbox(figure.canvas.get_renderer()).y0, box.y1)
            self.assertEqual([text.get_text() for text in legend.get_texts()], labels)
            plt.close(figure)

    def test_a_logarithmic_axis_has_at_least_three_numbers(self):
        for low, high in ((0.011, 0.05), (0.002, 0.05), (1e-4, 1.0), (0.014, 0.02)):
            figure, axis = figure_style.plt.subplots()
            figure_style.logarithmic(axis, low, high)
            bottom, top = axis.get_ylim()
            self.assertLess(bottom, low)
            self.assertGreater(top, high)
            shown = [t for t in axis.yaxis.get_majorticklocs() if bottom <= t <= top]
            self.assertGreaterEqual(len(shown), 3, (low, high))
            figure_style.plt.close(figure)

    def test_returns_of_other_rewards_are_on_no_axis(self):
        methods = study.load_study(study.find_study("acoustic")).methods
        names = [m.name for m in comparable(methods, "scenario_return")]
        self.assertNotIn("separated", names)
        self.assertNotIn("silent", names)
        self.assertIn("stg", names)
        self.assertEqual(comparable(methods, "tail_distance"), list(methods))


class Studies(unittest.TestCase):
    def test_shipped_studies_load_and_survive_a_round_trip(self):
        folder = study.shipped_studies()
        names = sorted(name for name in os.listdir(folder) if name.endswith(".yaml"))
        self.assertEqual(names, [f"{name}.yaml" for name in STUDIES])
        for name in names:
            loaded = study.load_study(os.path.join(folder, name))
            self.assertEqual(loaded.name, name[:-5])
            # The reporting block, env/seed_blocks.hpp: tables come from episodes that did not choose
            # anything.
            self.assertEqual(loaded.evaluation_seed_of(2), 5020000)
            self.assertLess(loaded.evaluation_seed_of(max(loaded.seeds)) + loaded.episodes, 6000000)
            self.assertEqual(loaded.episodes, 100)
            again = study.study_from(
                yaml.safe_load(yaml.safe_dump(study.dataclasses.asdict(loaded))), "again"
            )
            self.assertEqual(again, loaded)

    def test_shipped_studies_name_shipped_scenarios_and_variants(self):
        scenarios = os.path.join(PACKAGE, "..", "stg_bringup", "scenarios")
        for name in STUDIES:
            loaded = study.load_study(study.find_study(name))
            for scenario in loaded.scenarios:
                path = os.path.join(scenarios, scenario.name + ".yaml")
                self.assertTrue(os.path.isfile(path), path)
            variants = {method.variant for method in loaded.methods}
            self.assertLessEqual(variants, {"stg", "semantic", "velocity3", "tau6"})

    def test_the_baselines_of_the_paper_have_its_interface(self):
        loaded = study.load_study(study.find_study("paper"))
        theirs = {method.paper: method for method in loaded.methods if method.paper}
        self.assertEqual(set(theirs), set(Paper().algorithms("1")))
        for name, method in theirs.items():
            self.assertEqual(method.variant, "stg" if name == "STG-MAPPO" else "tau6")
            algorithm = "mappo" if name == "STG-MAPPO" else name.lower()
            self.assertEqual(method.train.get("algorithm", "mappo"), algorithm)

    def test_the_longer_baselines_differ_in_their_steps_only(self):
        paper = {method.name: method for method in study.load_study(study.find_study("paper")).methods}
        longer = study.load_study(study.find_study("baselines"))
        self.assertEqual(longer.steps, 2016000)
        for method in longer.methods:
            other = paper[method.name]
            self.assertEqual((method.variant, method.paper, method.train),
                             (other.variant, other.paper, other.train))  # fmt: skip

    def test_seeds_of_a_scenario_go_before_the_study_s(self):
        data = dict(yaml.safe_load(open(study.find_study("paper"), encoding="utf-8")))
        data["scenarios"] = [{"name": "a", "seeds": [7]}, {"name": "b"}]
        loaded = study.study_from(data, "file.yaml")
        trainings, evaluations = jobs.plan(loaded, "work", "bin")
        seeds = {(job.scenario, job.seed) for job in trainings}
        self.assertEqual(seeds, {("a", 7), ("b", 0), ("b", 1), ("b", 2)})
        self.assertEqual({(job.scenario, job.seed) for job in evaluations}, seeds)
        self.refused("seeds", scenarios=[{"name": "a", "seeds": [1, 1]}])

    def refused(self, expected, **changes):
        with open(study.find_study("paper"), encoding="utf-8") as file:
            data = yaml.safe_load(file)
        data.update(changes)
        with self.assertRaises(study.StudyError) as caught:
            study.study_from(data, "file.yaml")
        self.assertIn("file.yaml", str(caught.exception))
        self.assertIn(expected, str(caught.exception))

    def test_mistakes_are_refused_by_name(self):
        self.refused("sedes", sedes=[1])
        self.refused("seeds", seeds=[1, 1])
        self.refused("steps", steps="many")
        self.refused("steps", steps=True)
        self.refused("evaluation_seed_stride", evaluation_seed_stride=99)
        self.refused("scenarios[0].paper", scenarios=[{"name": "a", "paper": 3}])
        self.refused("methods[0].label", methods=[{"name": "a"}])
        self.refused("letters", methods=[{"name": "../a", "label": "A"}])
        with self.assertRaises(study.StudyError):
            study.find_study("no_such_study")


if __name__ == "__main__":
    unittest.main()
