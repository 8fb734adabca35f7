"""Shared by the tests of the page: a browser, a page that is open in it, and the browser's complaints."""

import contextlib
import json
import pathlib
import tempfile
import unittest

from stg_view.browser import missing, show, started
from stg_view.page import report_page

LACK = missing()
LARGEST_MB = 10.0


def complaints(driver):
    """Returns the complaints of the browser, without its remarks on drawing and on its own pages."""
    said = [e["message"] for e in driver.get_log("browser")]
    return [text for text in said if "GL Driver Message" not in text and not text.startswith("chrome://")]


def asked(driver):
    """Returns the addresses that the page asked for, except its own."""
    found = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            if not url.startswith(("data:", "blob:", "about:", "chrome://")):
                found.append(url)
    return found


@unittest.skipIf(LACK, f"the page is not opened: {LACK}")
class PageCase(unittest.TestCase):
    """Each test opens a page from disk and looks at it."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.driver = cls.stack.enter_context(started(log_requests=True))

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    @contextlib.contextmanager
    def page(self, recording, width=1280, height=720, title="a run", place=""):
        """Opens the page of a recording. At the end there must be no complaint and no other request."""
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
        """Returns the value of an expression in the page."""
        return driver.execute_script(f"return {text}")

    def tour(self, driver):
        """Looks at everything that the page can show."""
        for tab in ("plots", "network", "table", "story"):
            driver.execute_script(f"STG.app.show('{tab}'); STG.app.draw(performance.now())")
        for mode in ("target", "auv", "region", "above", "swarm"):
            driver.execute_script(f"STG.app.camera('{mode}'); STG.app.draw(performance.now())")
        driver.execute_script("STG.app.seek(STG.app.recording.end); STG.app.draw(performance.now())")

    def drawn(self, driver):
        """Returns the number of different colours in a coarse raster of the scene."""
        return self.run_js(driver, """(() => {
            STG.app.draw(performance.now());
            const c = document.createElement("canvas"); c.width = c.height = 64;
            const x = c.getContext("2d");
            x.drawImage(document.getElementById("scene"), 0, 0, 64, 64);
            const d = x.getImageData(0, 0, 64, 64).data, s = new Set();
            for (let k = 0; k < d.length; k += 4) s.add(d[k] * 65536 + d[k + 1] * 256 + d[k + 2]);
            return s.size; })()""")
