"""The page in a real browser: what it shows, that it asks nobody, and that no text becomes code."""

import contextlib
import json
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import view_fixtures  # noqa: E402  (found by the line above, and finds the others)
from stg_view.browser import missing, show, started  # noqa: E402
from stg_view.page import report_page  # noqa: E402

LACK = missing()
LARGEST_MB = 10.0


def complaints(driver):
    """What the browser complains about; its remarks on drawing and on its own pages are none."""
    said = [e["message"] for e in driver.get_log("browser")]
    return [text for text in said if "GL Driver Message" not in text and not text.startswith("chrome://")]


def asked(driver):
    """Addresses that the page asked for, itself aside."""
    found = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            if not url.startswith(("data:", "blob:", "about:", "chrome://")):
                found.append(url)
    return found


@unittest.skipIf(LACK, f"the page is not opened: {LACK}")
class PageTest(unittest.TestCase):
    """Every test opens a page from disk and looks at it."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.driver = cls.stack.enter_context(started(log_requests=True))

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    @contextlib.contextmanager
    def page(self, recording, width=1280, height=720, title="a run", place=""):
        """The page of a recording, open; afterwards there was no complaint and no other request."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "run.html"
            file.write_text(report_page(recording.encoded(), title), encoding="utf-8")
            self.assertLess(file.stat().st_size, LARGEST_MB * 1e6)
            show(self.driver, file.as_uri() + place, width, height)
            yield self.driver
            self.assertEqual([], complaints(self.driver))
            others = [url for url in asked(self.driver) if not url.startswith(file.as_uri())]
            self.assertEqual([], others)

    def run_js(self, driver, text):
        """What an expression of the page is."""
        return driver.execute_script(f"return {text}")

    def tour(self, driver):
        """Looks at everything that can be looked at."""
        for tab in ("plots", "network", "table", "story"):
            driver.execute_script(f"STG.app.show('{tab}'); STG.app.draw(performance.now())")
        for mode in ("target", "auv", "region", "above", "swarm"):
            driver.execute_script(f"STG.app.camera('{mode}'); STG.app.draw(performance.now())")
        driver.execute_script("STG.app.seek(STG.app.recording.end); STG.app.draw(performance.now())")

    def drawn(self, driver):
        """How many different colours the scene has in a coarse raster."""
        return self.run_js(driver, """(() => {
            STG.app.draw(performance.now());
            const c = document.createElement("canvas"); c.width = c.height = 64;
            const x = c.getContext("2d");
            x.drawImage(document.getElementById("scene"), 0, 0, 64, 64);
            const d = x.getImageData(0, 0, 64, 64).data, s = new Set();
            for (let k = 0; k < d.length; k += 4) s.add(d[k] * 65536 + d[k + 1] * 256 + d[k + 2]);
            return s.size; })()""")

    def test_four_in_a_box(self):
        recording = view_fixtures.made_up(4, 1.0, lost_at=(40, 2))
        fates, sent = recording.packets.fates, len({r[:1] + r[2:3] for r in recording.packets.rows})
        with self.page(recording) as driver:
            self.tour(driver)
            self.assertGreater(self.drawn(driver), 10)
            # Packets in the page are those of the log.
            driver.execute_script("STG.app.show('network'); STG.app.draw(performance.now())")
            rows = self.run_js(driver, "[...document.querySelectorAll('#fates tr[data-fate]')].map(r => "
                               "[Number(r.dataset.fate), Number(r.children[1].textContent)])")  # fmt: skip
            self.assertEqual([[k, n] for k, n in enumerate(fates) if n > 0], rows)
            cards = self.run_js(driver, "[...document.querySelectorAll('#network .card b')].map(b => b.textContent)")
            self.assertEqual([str(sent), str(sum(fates)), str(fates[0])], cards[:3])
            # Who lost the target, when, why, and which packets were missing.
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

    def test_memory_of_a_long_run_is_bounded(self):
        with self.page(view_fixtures.made_up(20, 100.0, steps=50)) as driver:
            # An hour at 10 Hz: steps and packets as the live node sends them.
            rows, most = self.run_js(driver, """(() => {
                const r = STG.app.recording; let most = 0;
                const names = Object.keys(r.steps.columns);
                for (let k = 0; k < 36000; k += 100) {
                  r.on_steps({rows: 100}, names.map((name) => { const c = r.steps.columns[name];
                    const data = new c.data.constructor(100 * c.width);
                    if (name === "t") data.forEach((_, j) => { data[j] = 50 + 0.1 * (k + j); });
                    return {name, type: {Float64Array: "f8", Float32Array: "f4", Uint8Array: "u1"}[data.constructor.name], width: c.width, data}; }));
                  let bytes = 0;
                  for (const c of Object.values(r.steps.columns)) bytes += c.data.byteLength;
                  most = Math.max(most, bytes);
                }
                return [r.steps.count, most]; })()""")  # fmt: skip
            self.assertGreater(rows, 1000)
            self.assertLess(most, 50e6)


if __name__ == "__main__":
    unittest.main()
