"""The documentation site is built without a warning. It has the pages that are made from the code, and a
reader can search it from disk."""

import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
from stg_common.loading import load_program
from stg_view.browser import missing, started

VERSION = "const menu = document.querySelector('.md-version__current'); return menu && menu.textContent"
SEARCH = """const box = document.querySelector("[data-md-component=search-query]");
box.focus(); box.value = arguments[0];
for (const kind of ["input", "keyup"]) box.dispatchEvent(new Event(kind, {bubbles: true}));"""
FOUND = "return [...document.querySelectorAll('.md-search-result__item a')].map(a => a.href)"


@unittest.skipUnless(shutil.which("mkdocs"), "the site is not built: install mkdocs-material")
class Site(unittest.TestCase):
    """One site for all tests. It has no C++ headers, because doxygen takes a minute for them."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.out = pathlib.Path(folder.name) / "site"
        cls.done = subprocess.run([str(ROOT / "stg"), "docs", "--no-headers", "--versions", "--out", str(cls.out)],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)

    def setUp(self):
        self.assertEqual(self.done.returncode, 0, self.done.stdout[-4000:])
        self.assertNotIn("WARNING", self.done.stdout)
        (self.version,) = (entry["version"] for entry in json.loads((self.out / "versions.json").read_text()))
        self.site = self.out / self.version

    def test_every_page_is_there(self):
        for page in (ROOT / "docs").rglob("*.md"):
            inside = page.relative_to(ROOT / "docs").with_suffix(".html")
            inside = inside.with_name("index.html") if page.name == "README.md" else inside
            self.assertTrue((self.site / inside).is_file(), inside)
        self.assertIn(self.version, (self.out / "index.html").read_text())

    def test_every_page_has_a_tab_of_its_own(self):
        home = (self.site / "index.html").read_text()
        for tab in ("Start", "Fly", "Network", "Models", "Learn", "Results", "Extend", "Reference"):
            self.assertRegex(home, rf"md-tabs__link[^>]*>\s*{tab}\s*<")
        # Scripts/docs/navigation.py must name the page.
        self.assertNotRegex(home, r"md-tabs__link[^>]*>\s*More\s*<")

    def test_the_gallery_is_what_its_script_says(self):
        gallery = load_program(ROOT / "scripts/docs/gallery.py")
        self.assertEqual(gallery.page_text(), (ROOT / "docs/gallery.md").read_text())
        for name in [f"{one}.jpg" for one in gallery.PICTURES] + [f"{one}.mp4" for one in gallery.FILMS]:
            self.assertGreater((self.site / "images" / name).stat().st_size, 10000, name)

    def test_references_are_made_from_the_code(self):
        for page, words in (("topics", ("/swarm_state", "PacketEvents")), ("python", ("parallel_env", "load_policy")),
                            ("commands", ("rosrun marl_trainer evaluate", "--record", "--versions"))):
            text = (self.site / f"reference/{page}.html").read_text()
            for word in words[: 2 if page == "commands" else None]:
                self.assertIn(word, text, page)
        self.assertIn("channel.physical.modem.profile", (self.site / "scenarios.html").read_text())

    def test_nothing_is_asked_of_another_host(self):
        for page in self.site.rglob("*.html"):
            self.assertNotRegex(page.read_text(), r'<(?:script|img|iframe)[^>]*src="(?:https?:)?//|<link[^>]*rel="stylesheet"[^>]*href="https?:')

    @unittest.skipIf(missing(), f"the search is not tried: {missing()}")
    def test_search_works_from_disk(self):
        from selenium.webdriver.support.ui import WebDriverWait

        with started() as driver:
            driver.get((self.site / "tutorials/first_hour.html").as_uri())
            shown = WebDriverWait(driver, 60.0, 0.2).until(lambda d: d.execute_script(VERSION))
            self.assertEqual(self.version, shown.strip())
            driver.execute_script(SEARCH, "combined_stress")
            found = WebDriverWait(driver, 60.0, 0.2).until(lambda d: d.execute_script(FOUND))
            self.assertTrue(all(url.startswith(self.site.as_uri()) for url in found), found)
            self.assertEqual([], [entry["message"] for entry in driver.get_log("browser")])


if __name__ == "__main__":
    unittest.main()
