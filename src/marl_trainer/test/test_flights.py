"""Studies of flights: the table follows from the episodes, and a file that is no study is refused."""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml
from stg_common.yaml_files import read_yaml
from stg_study import flight_page, flight_study, statistics

PACKAGE = pathlib.Path(__file__).resolve().parents[1]
# In place of `evaluate`: episode e of gain g is in the band for g + 0.01 e. With true states it is there for
# 0.1 more, and when silent for 0.2 less. The return is left out where it would be NaN.
EVALUATE = f"""#!{sys.executable}
import json, statistics, sys
given = {{a: b for a, b in zip(sys.argv, sys.argv[1:]) if a.startswith("--")}}
gain = float(given["--policy"].partition("gain=")[2] or 0.5)
gain += 0.1 * ("--privileged" in sys.argv) - 0.2 * ("silent=1" in sys.argv)
values = [gain + 0.01 * e for e in range(int(given["--episodes"]))]
with open(given["--csv"], "w") as file:
    file.write("episode,band_share\\n" + "".join(f"{{e}},{{v}}\\n" for e, v in enumerate(values)))
print(json.dumps({{"band_share": statistics.mean(values), "band_share_std": statistics.stdev(values),
                   "return": None, "seed_block": "choosing" if int(given["--seed"]) < 1000000 else "reporting"}}))
"""
STUDY = {
    "kind": "flights", "name": "sample", "title": "A sample", "episodes": 5,
    "knows": {"own": {}, "silent": {"set": ["silent=1"]}, "true states": {"privileged": True}},
    "pilots": {"better": "law:gain=0.6"}, "compare": "better", "gap_closed": True,
    "sections": [{"title": "All", "scenarios": ["field"], "conditions": ["nominal", "calm"],
                  "pilots": {"better": ["own", "true states"], "law": ["own", "silent"]}}],
    "columns": [{"metric": "band_share", "title": "in band", "digits": 3},
                {"metric": "gap_closed", "title": "gap closed"}, {"metric": "return", "title": "return"}],
}  # fmt: skip


class Flights(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("train", "evaluate"):
            (self.folder / name).write_text(EVALUATE)
            (self.folder / name).chmod(0o755)

    def reproduce(self, *arguments, **changes):
        """Runs the program; returns the finished process."""
        file = self.folder / "study.yaml"
        file.write_text(yaml.safe_dump({**STUDY, **changes}))
        runs = [] if "--report-only" in arguments else ["--bin", str(self.folder), "--jobs", "2"]
        return subprocess.run(
            [sys.executable, str(PACKAGE / "scripts" / "reproduce"), "--study", str(file), "--out",
             str(self.folder / "out"), *runs, *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)

    def rows(self):
        """Returns {(condition, pilot, knows): row} of the table."""
        made = flight_study.flight_study_from(dict(STUDY), "study")
        found = flight_page.read_table(made, str(self.folder / "out"))
        return {(row["condition"], row["pilot"], row["knows"]): row for row in found}

    def test_the_gap_is_that_of_the_best_law_although_a_policy_is_better(self):
        place = {"section": "All", "scenario": "field", "condition": "nominal", "variant": ""}
        rows = [{**place, "pilot": pilot, "knows": knows, "band_share": share}
                for pilot, knows, share in [("law", "own", 0.8), ("law", "true states", 0.9), ("weak", "own", 0.5),
                                            ("weak", "true states", 1.0), ("policy", "own", 0.85)]]  # fmt: skip
        flight_page.close_gaps(rows, {"policy"})
        for row, closed in zip(rows, [0.0, 1.0, -3.0, 2.0, 0.5]):
            self.assertAlmostEqual(row["gap_closed"], closed)

    def test_the_table_follows_from_the_episodes(self):
        run = self.reproduce()
        self.assertEqual(run.returncode, 0, run.stderr + run.stdout)
        rows = self.rows()
        self.assertEqual(len(rows), 8)
        law = rows["calm", "law", "own"]
        self.assertAlmostEqual(law["band_share"], 0.52)
        self.assertAlmostEqual(law["band_share_std"], 0.01 * math.sqrt(2.5))
        # Both fly the same episodes, so their difference is 0.1 in each episode and in each resample.
        for name in ("difference", "difference_low", "difference_high"):
            self.assertAlmostEqual(law[name], 0.1)
        self.assertIsNone(rows["calm", "better", "own"]["difference"])
        # With own estimates the best pilot closes nothing of its gap to the truth. With true states it closes
        # all of it.
        for (pilot, knows), closed in {("better", "own"): 0.0, ("better", "true states"): 1.0,
                                       ("law", "own"): -1.0, ("law", "silent"): -3.0}.items():  # fmt: skip
            self.assertAlmostEqual(rows["calm", pilot, knows]["gap_closed"], closed)
        page = (self.folder / "out" / "sample.md").read_text()
        self.assertIn("| calm | `law` | own | 0.520 | -1.00 | – | +0.100 [+0.100, +0.100] |", page)
        self.assertIn("from seed 5,000,000", page)

    def test_a_study_that_is_started_again_flies_nothing_twice(self):
        self.reproduce()
        page = (self.folder / "out" / "sample.md").read_bytes()
        (self.folder / "evaluate").write_text("#!/bin/false\n")
        for more in ((), ("--report-only",)):
            self.assertEqual(self.reproduce(*more).returncode, 0)
            self.assertEqual((self.folder / "out" / "sample.md").read_bytes(), page)

    def test_seeds_for_choosing_are_refused(self):
        run = self.reproduce(seed=7000)
        self.assertEqual(run.returncode, 1)
        self.assertIn("belong to the choosing block, but must belong to the reporting block", run.stdout)

    def test_what_is_no_study_of_flights_is_refused_in_one_line(self):
        section = STUDY["sections"][0]
        for changes, what in (
            ({"episodes": 0}, "episodes must be positive"),
            ({"sections": [{**section, "pilots": {"law": ["rumour"]}}]}, "must be some of own, silent"),
            ({"sections": [{**section, "pilots": {"law": "own"}}]}, "must be some of own, silent"),
            ({"columns": [{"metric": "return"}]}, r"columns\[0\].title: missing"),
            ({"knows": {"own": {"blind": True}}}, "knows.own.blind: unknown key"),
            ({"pilots": {"better": "{policies}/a.onnx"}}, "needs --policies"),
            ({"pilots": {"better": "{nothing}/a.onnx"}}, "in braces is unknown"),
        ):
            run = self.reproduce(**changes)
            with self.subTest(what):
                self.assertEqual(run.returncode, 2)
                self.assertRegex(run.stderr, rf"^reproduce: [^\n]*{what}[^\n]*\n$")
        for option in ("--quick", "--keep", "--seeds=1"):
            run = self.reproduce(option)
            self.assertRegex(run.stderr, r"^reproduce: --\w+: has no effect, because a study of flights has no trainings\n$")
        run = self.reproduce("--policies", str(self.folder))
        self.assertRegex(run.stderr, r"^reproduce: --policies: has no effect, .* in \{policies\}\n$")

    def test_what_no_flight_and_no_table_uses_is_refused(self):
        columns = [{"metric": "band_share", "title": "in band", "beside": True}]
        for changes, what in (
            ({"pilots": {**STUDY["pilots"], "spare": "law"}}, "pilots.spare: has no effect, because no section flies it"),
            ({"knows": {**STUDY["knows"], "rumour": {}}}, "knows.rumour: has no effect, because no pilot"),
            ({"compare": "best"}, "compare: 'best' is no pilot of a section; there are better, law"),
            ({"compare": "", "compare_metric": "return"}, "compare_metric: has no effect without compare"),
            ({"beside": ["better"]}, "beside: must have a pilot and at least one other"),
            ({"beside": ["better", "spare"]}, "beside: 'spare' does not fly with 'own' in the section All"),
            ({"columns": columns}, r"columns\[0\].beside: has no effect, because the study has no list beside"),
        ):
            with self.subTest(what), self.assertRaisesRegex(flight_study.StudyError, "^study: " + what):
                flight_study.flight_study_from({**STUDY, **changes}, "study")
        for changes in ({"beside": ["better", "law"], "columns": columns}, {"compare": "law", "compare_metric": "return"}):
            flight_study.flight_study_from({**STUDY, **changes}, "study")

    def test_the_table_beside_leaves_out_places_whose_flights_are_not_finished(self):
        column = {"metric": "band_share", "title": "in band", "beside": True}
        made = flight_study.flight_study_from({**STUDY, "beside": ["better", "law"], "columns": [column]}, "study")
        place = {"section": "All", "scenario": "field", "variant": "", "knows": "own"}
        rows = [{**place, "condition": c, "pilot": p, "band_share": 0.5}
                for c, p in (("nominal", "better"), ("nominal", "law"), ("calm", "better"))]  # fmt: skip
        table = flight_page.beside_table(made, rows)
        self.assertIn("| field | nominal | `law` | 0.50 / 0.50 |", table)
        self.assertNotIn("calm", table)

    def test_the_overrides_of_the_knowledge_replace_those_of_the_variant(self):
        changed = {**STUDY, "sections": [{**STUDY["sections"][0], "variants": {"loud": ["x=1", "silent=0"]}}]}
        cells = flight_study.plan_flights(flight_study.flight_study_from(changed, "study"), "work", "bin")
        given = {cell.knows: cell.jobs[0].arguments for cell in cells}
        self.assertEqual(given["own"][-4:], ["--set", "x=1", "--set", "silent=0"])
        self.assertEqual(given["silent"][-4:], ["--set", "x=1", "--set", "silent=1"])

    def test_rows_of_several_trainings_have_the_deviation_over_them(self):
        policy = {"policy": "{policies}/{seed}.onnx", "seeds": [4, 6]}
        made = flight_study.flight_study_from({**STUDY, "pilots": {"better": policy}}, "study")
        for seed in (4, 6):
            (self.folder / f"{seed}.onnx").write_text("x")
        cells = flight_study.plan_flights(made, str(self.folder), str(self.folder), str(self.folder))
        self.assertEqual([len(cell.jobs) for cell in cells[:2]], [2, 2])
        values = iter((0.4, 0.6))
        for job in cells[0].jobs:
            value = next(values)
            job.summary = lambda value=value: {"band_share": value, "band_share_std": 9.0}
        mean, std = flight_study.flown(cells[0], "band_share")
        self.assertAlmostEqual(mean, 0.5)
        self.assertAlmostEqual(std, math.sqrt(0.02))

    def test_the_trainings_must_be_what_the_study_states(self):
        everything = {"noise-time": 60.0, "without": "nothing", "validation-interval": 100}
        for name, options in (
            ("all_4", everything), ("white_4", {**everything, "noise-time": 0.0, "validation-interval": 2}),
        ):  # fmt: skip
            (self.folder / name).mkdir()
            (self.folder / name / "policy.onnx").write_text("x")
            (self.folder / name / "config.json").write_text(json.dumps({"seed": 4, **options}))
        pilots = {
            name: {"policy": "{policies}/" + name + "_{seed}/policy.onnx", "seeds": [4]} for name in ("all", "white")
        }
        section = {**STUDY["sections"][0], "pilots": {"all": ["own"], "white": ["own"]}}

        def plan(**trained):
            changed = {**STUDY, "compare": "all", "sections": [section], "knows": {"own": {}},
                       "pilots": {n: {**p, "trained": trained.get(n, {})} for n, p in pilots.items()}}  # fmt: skip
            made = flight_study.flight_study_from(changed, "study")
            return flight_study.plan_flights(made, str(self.folder), str(self.folder), str(self.folder))

        self.assertEqual(len(plan()), 4)  # a study that states nothing compares whatever it likes
        self.assertEqual(len(plan(white={"noise-time": 0.0})), 4)
        for trained, what in (
            ({"white": {"noise-time": 5.0}}, r"white_4/policy.onnx: trained with noise-time=0.0, but the study states 5.0"),
            ({"all": {"without": "nothing"}}, "white_4.*noise-time=0.0, but .*all_4.* with 60.0; .* no such difference"),
        ):
            with self.subTest(trained), self.assertRaisesRegex(flight_study.StudyError, what):
                plan(**trained)
        (self.folder / "white_4" / "config.json").unlink()
        with self.assertRaisesRegex(flight_study.StudyError, "white_4.*config.json is missing"):
            plan(white={"noise-time": 0.0})

    def test_shipped_studies_load_and_their_published_pages_follow_from_their_tables(self):
        published = PACKAGE.parents[1] / "docs" / "results"
        tables = sorted(published.glob("*/*.csv"))
        for path in sorted((PACKAGE / "studies" / "flights").glob("*.yaml")):
            made = flight_study.flight_study_from(read_yaml(path), str(path))
            self.assertEqual(made.name, path.stem)
            for table in [t for t in tables if t.stem == made.name]:
                saved = flight_study.flight_study_from(read_yaml(table.with_suffix(".yaml")), "saved")
                with tempfile.TemporaryDirectory() as folder:
                    for part in [table.name, *saved.trainings]:
                        os.symlink(table.parent / part, os.path.join(folder, part))
                    flight_page.write_page(saved, folder)
                    page = pathlib.Path(folder, table.stem + ".md").read_text()
                self.assertEqual(page, table.with_suffix(".md").read_text(), table)

    def test_a_paired_interval_holds_the_mean(self):
        mean, low, high = statistics.paired_interval([1.0, 2.0, 3.0, 9.0], [0.0, 2.0, 1.0])
        self.assertAlmostEqual(mean, 1.0)
        self.assertTrue(0.0 <= low <= mean <= high <= 2.0)

    def test_a_training_without_a_task_is_refused(self):
        path = self.folder / "validation.csv"
        path.write_text("steps,seconds,task,band_share\n1,2,a,0.5\n1,2,b,0.7\n2,3,a,0.5\n")
        with self.assertRaisesRegex(Exception, "other tasks at 2 steps"):
            flight_page.training_table(str(path))
        path.write_text("steps,seconds,task,band_share\n1000,2,a,0.5\n2000,3,a,0.4\n")
        self.assertIn("The last mean is 0.800 of the best one (0.400 of 0.500)", flight_page.training_table(str(path)))


if __name__ == "__main__":
    unittest.main()
