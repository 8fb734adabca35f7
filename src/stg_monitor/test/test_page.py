"""The page in a real browser: what it shows, that it asks no other address, and that text is no code."""

import pathlib
import tempfile
import unittest

import view_fixtures
from page_case import PageCase, complaints
from stg_common.loading import load_program
from stg_view.browser import show
from stg_view.page import report_page

MODULE = pathlib.Path(__file__).resolve().parents[2] / "stg_python/python/stg/page.py"


class PageTest(PageCase):
    """What a page shows and does."""

    def test_four_in_a_box(self):
        recording = view_fixtures.made_up(4, 1.0, lost_at=(40, 2))
        fates, sent = recording.packets.fates, len({r[:1] + r[2:3] for r in recording.packets.rows})
        with self.page(recording) as driver:
            self.tour(driver)
            self.assertGreater(self.drawn(driver), 10)
            # The page has the packets of the log.
            driver.execute_script("STG.app.show('network'); STG.app.draw(performance.now())")
            rows = self.run_js(driver, "[...document.querySelectorAll('#fates tr[data-fate]')].map(r => "
                               "[Number(r.dataset.fate), Number(r.children[1].textContent)])")  # fmt: skip
            self.assertEqual([[k, n] for k, n in enumerate(fates) if n > 0], rows)
            cards = self.run_js(driver, "[...document.querySelectorAll('#network .card b')].map(b => b.textContent)")
            self.assertEqual([str(sent), str(sum(fates)), str(fates[0])], cards[:3])
            # The page shows which AUV lost the target, when and why, and which packets were missing.
            driver.execute_script("STG.app.show('story')")
            driver.execute_script(
                "[...document.querySelectorAll('.event')].find(b => b.textContent.includes('loses')).click()"
            )
            why = self.run_js(driver, "document.querySelector('.why').textContent")
            self.assertIn("0.800 m from the target, beyond the limit of 0.600 m", why)
            self.assertIn("are missing", why)
            missing_rows = [r for r in recording.packets.rows if r[1] == 2 and r[4] != 0 and r[6] < 40.0]
            self.assertIn(f"{len(missing_rows)} are missing", why)  # a made-up decision takes a second
            self.assertEqual(40.0, self.run_js(driver, "STG.app.t"))

    def test_keys_move_time_and_camera(self):
        with self.page(view_fixtures.made_up(4)) as driver:
            press = "document.dispatchEvent(new KeyboardEvent('keydown', {key: '%s', bubbles: true}))"
            press = press.replace("document.", "document.body.")
            for key in ("ArrowRight", "ArrowRight", "4", "]"):
                driver.execute_script(press % key)
            self.assertEqual([2.0, "region", 0], self.run_js(
                driver, "[STG.app.t, STG.app.scene.mode, STG.app.selected]"))  # fmt: skip
            driver.execute_script(press % " ")
            self.assertTrue(self.run_js(driver, "STG.app.playing"))
            driver.execute_script(press % "d")
            self.assertEqual(1, len({"light", "dark"} - {self.run_js(driver, "document.documentElement.dataset.theme")}))

    def test_between_two_decisions_it_is_on_its_way(self):
        recording = view_fixtures.made_up(4, 100.0)
        recording.add("episode", episode=1, seed=8, start=30.0)
        with self.page(recording) as driver:
            where = ("(() => { STG.app.seek(%s); STG.app.draw(performance.now()); "
                     "return STG.app.scene.vehicles[1].group.position.toArray(); })()")  # fmt: skip
            before, between, after = (self.run_js(driver, where % t) for t in (10, 10.25, 11))
            for a, x, b in zip(before, between, after):
                self.assertAlmostEqual(0.75 * a + 0.25 * b, x, places=5)
            # No AUV moves between the end of an episode and the start of the next one.
            self.assertEqual(*(self.run_js(driver, where % t) for t in (29, 29.5)))

    def test_one_without_packets(self):
        with self.page(view_fixtures.made_up(1, 1.0, every=0)) as driver:
            self.tour(driver)
            self.assertGreater(self.drawn(driver), 8)

    def test_twenty_at_four_kilometres(self):
        recording = view_fixtures.made_up(20, 2000.0, steps=3000, every=3, bottom=True)
        with self.page(recording) as driver:
            self.tour(driver)
            self.assertGreater(self.drawn(driver), 30)
            self.assertEqual(3000, self.run_js(driver, "STG.app.recording.steps.count"))

    def test_fifty_on_a_telephone(self):
        with self.page(view_fixtures.made_up(50, 500.0, every=1), 390, 844) as driver:
            self.tour(driver)
            self.assertEqual([390, 390], self.run_js(
                driver, "[document.documentElement.scrollWidth, window.innerWidth]"))  # fmt: skip

    def test_nothing_scrolls_sideways(self):
        with self.page(view_fixtures.made_up(4)) as driver:
            self.assertEqual(1280, self.run_js(driver, "document.documentElement.scrollWidth"))
            self.assertLessEqual(self.run_js(driver, "document.documentElement.scrollHeight"), 720)

    def test_a_chosen_title_stands_before_that_of_the_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            for is_chosen, wanted in ((False, "made up"), (True, "mine")):
                file = pathlib.Path(folder) / f"{wanted}.html"
                file.write_text(report_page(view_fixtures.made_up(2).encoded(), "mine", is_chosen), encoding="utf-8")
                show(self.driver, file.as_uri())
                self.assertEqual([wanted] * 2, [self.run_js(self.driver, "document.getElementById('title').textContent"), self.driver.title])

    def test_a_notebook_shows_it_in_a_frame(self):
        from selenium.webdriver.support.ui import WebDriverWait

        inline = load_program(MODULE).Page(report_page(view_fixtures.made_up(4).encoded(), "a run"))._repr_html_()
        with tempfile.TemporaryDirectory() as folder:
            notebook = pathlib.Path(folder) / "notebook.html"
            notebook.write_text(f"<!doctype html><title>mine</title><body>{inline}", encoding="utf-8")
            self.driver.get(notebook.as_uri())
            self.driver.switch_to.frame(0)
            try:
                WebDriverWait(self.driver, 40.0, 0.1).until(
                    lambda d: d.execute_script("return document.documentElement.dataset.ready === 'yes'"))
                self.assertEqual(60, self.run_js(self.driver, "STG.app.recording.steps.count"))
                self.tour(self.driver)
            finally:
                self.driver.switch_to.default_content()
            self.assertEqual([], complaints(self.driver))

    def test_hostile_text_is_shown_as_text(self):
        hostile = view_fixtures.HOSTILE
        recording = view_fixtures.made_up(3, name=hostile + "{}", lost_at=(20, 1))
        recording.meta.update(title=hostile, scenario=hostile, policy=hostile, channel=hostile)
        recording.notes.append(hostile)
        with self.page(recording, title=hostile) as driver:
            self.tour(driver)
            self.assertEqual(hostile, self.run_js(driver, "document.getElementById('title').textContent"))
            self.assertEqual(0, self.run_js(driver, "document.querySelectorAll('img').length"))
            self.assertNotEqual("owned", driver.title)


del PageCase  # it is no test of its own
if __name__ == "__main__":
    unittest.main()
