"""What the reproduce command publishes: it keeps rows, and it refuses some episodes."""

import shutil
import unittest


from study_case import StudyCase
from stg_study.study import load_study


class Published(StudyCase):
    def test_keep_flies_one_method_again_and_leaves_the_rows_of_the_others(self):
        self.assertEqual(self.reproduce()[0], 0)
        before = {name: self.rows(name) for name in ("results.csv", "curves.csv", "runs.csv")}
        shutil.rmtree(self.path("work"))
        kept = self.path("study.yaml")
        with open(kept, encoding="utf-8") as file:
            text = file.read()
        with open(kept, "w", encoding="utf-8") as file:
            file.write(text.replace("label: STG-MAPPO", "label: Flown before"))
        status, output, calls = self.reproduce("--methods", "tau6", "--keep")
        self.assertEqual(status, 0, output)
        self.assertEqual(sum(c.startswith("train ") for c in calls), 2)
        self.assertFalse([c for c in calls if "--policy pursuit" in c])
        for name, rows in before.items():
            made = self.rows(name)
            for method in ("stg", "tau6", "pursuit", "simple"):
                of_method = [row for row in rows if row["method"] == method]
                self.assertEqual([row for row in made if row["method"] == method], of_method)
        self.assertEqual([(m.name, m.label) for m in load_study(kept).methods],
                         [("stg", "Flown before"), ("tau6", "raw")])  # fmt: skip
        status, output, _ = self.reproduce("--methods", "tau6", "--keep", "--episodes", "5")
        self.assertEqual(status, 2)
        self.assertIn("--keep: ", output)
        self.assertIn("has other episodes", output)

    def test_nothing_is_published_of_episodes_that_something_was_chosen_by(self):
        with open(self.study, "a", encoding="utf-8") as file:
            file.write("evaluation_seed: 3000\n")
        status, output, _ = self.reproduce("--methods", "stg", "--seeds", "0")
        self.assertEqual(status, 1, output)
        self.assertIn("to the choosing block, but must belong to the reporting block", output)
        self.assertEqual(self.rows("results.csv"), [])


if __name__ == "__main__":
    unittest.main()
