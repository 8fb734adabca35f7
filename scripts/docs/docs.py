#!/usr/bin/python3
"""Builds the documentation site: the pages of docs/, references made from the code, C++ headers.

Needs mkdocs-material; doxygen for the C++ headers, which are left out with a line where it is
missing. Links that lead nowhere end the build. Exit status: 0 done, 1 mkdocs refuses, 2 wrong usage.
"""

import argparse
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import headers as cpp
from navigation import navigation
from references import write_commands, write_python, write_topics

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = ROOT / "build" / "site"
MKDOCS = "mkdocs"
PICTURES = (".png", ".svg", ".jpg", ".mp4")
CONFIG = """\
site_name: STG Swarm
docs_dir: pages
use_directory_urls: false
theme:
  name: material
  font: false
  icon: {logo: material/submarine}
  features: [navigation.tabs, navigation.top, navigation.indexes, search.highlight, search.suggest, content.code.copy]
  palette:
    - {media: "(prefers-color-scheme: light)", scheme: default, primary: custom, accent: custom, toggle: {icon: material/weather-night, name: dark}}
    - {media: "(prefers-color-scheme: dark)", scheme: slate, primary: custom, accent: custom, toggle: {icon: material/weather-sunny, name: light}}
extra_css: [site.css]
plugins: [search]
markdown_extensions: [tables, admonition, toc: {permalink: true}, pymdownx.superfences]
"""
EXTRA = {False: "extra: {generator: false}\n", True: "extra: {generator: false, version: {provider: mike}}\n"}
# The menu requests a file. In a page from disk, a script contains the content of this file.
VERSIONS_FROM_DISK = """if (window.__versions) {
  const asked = window.fetch;
  window.fetch = (url, ...more) => String(url.url || url).endsWith("/versions.json")
    ? Promise.resolve(new Response(JSON.stringify(window.__versions))) : asked(url, ...more);
}
"""


def rebased(text, folder):
    """The text of a page, in which links out of docs/ point to the repository's files as text."""

    def turn(match):
        label, target = match.group(1), match.group(2)
        if re.match(r"(https?:|mailto:|#)", target):
            return match.group(0)
        path = target.partition("#")[0]
        place = (ROOT / "docs" / folder / path).resolve()
        if (ROOT / "docs") in place.parents and place.suffix in (".md", *PICTURES):
            return match.group(0)
        if place == ROOT / "README.md":
            return match.group(0).replace(target, "../" * len(folder.parts) + "index.md")
        inside = place.relative_to(ROOT) if ROOT in place.parents else path
        return f"{label.strip('![]')} (`{inside}`)"

    return re.sub(r"(!?\[[^\]]*\])\(([^)\s]+)\)", turn, text)


def copy_pages(to):
    """Copies docs/ and the README, which is the first page."""
    for file in sorted((ROOT / "docs").rglob("*")):
        inside = file.relative_to(ROOT / "docs")
        if file.is_dir():
            continue
        target = to / inside
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            target.write_text(rebased(file.read_text(), inside.parent))
        elif file.suffix in PICTURES:
            shutil.copyfile(file, target)
    readme = re.sub(r"\]\((?!docs/|https?:|mailto:|#)", "](../", (ROOT / "README.md").read_text())
    readme = readme.replace("](docs/", "](")
    (to / "index.md").write_text(rebased(readme, pathlib.Path(".")))


def search_from_disk(site, several):
    """Makes search and the menu of versions work in pages from disk. There a browser can load scripts but no
    other files. So the index and the search program are put into one script, which such a page loads
    first."""
    index = (site / "search/search_index.json").read_text().replace("</", "<\\/")
    (worker,) = (site / "assets/javascripts/workers").glob("search.*.js")
    program = f'new Blob([{json.dumps(worker.read_text())}], {{type: "text/javascript"}})'
    text = f"var __search = {{index: Promise.resolve({index}), worker: URL.createObjectURL({program})}};\n"
    (site / "search/from_disk.js").write_text(text + VERSIONS_FROM_DISK)
    for page in site.rglob("*.html"):
        up = "../" * (len(page.relative_to(site).parts) - 1)
        scripts = [f"{up}../versions.js"] * several + [f"{up}search/from_disk.js"]
        loads = "".join(f'<script src="{one}"><\\/script>' for one in scripts)
        load = f"""<script>if (location.protocol === "file:") document.write('{loads}')</script>"""
        page.write_text(re.sub(r'(<script src="[^"]*assets/javascripts/bundle)', lambda m, s=load: s + m.group(1), page.read_text()))


def version():
    """The newest version in the changelog."""
    found = re.search(r"^## \[([^\]]+)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    return found.group(1) if found else "unknown"


def list_versions(folder):
    """Writes the list for the menu of versions, and a first page that leads to the newest version."""
    found = [one.name for one in folder.iterdir() if (one / "index.html").is_file()]
    # A version that is not released yet is the newest.
    numbers = lambda name: [int(part) for part in re.findall(r"\d+", name)] or [1 << 30]
    found.sort(key=numbers, reverse=True)
    entries = [{"version": name, "title": name, "aliases": []} for name in found]
    (folder / "versions.json").write_text(json.dumps(entries))
    (folder / "versions.js").write_text(f"window.__versions = {json.dumps(entries)};\n")
    newest = html.escape(found[0], quote=True)
    (folder / "index.html").write_text(f'<!doctype html><meta http-equiv="refresh" content="0; url={newest}/index.html">\n')


def build(site, headers, several):
    """Builds the site; returns the exit status."""
    with tempfile.TemporaryDirectory() as folder:
        pages = pathlib.Path(folder) / "pages"
        pages.mkdir()
        copy_pages(pages)
        (pages / "reference").mkdir()
        for write in (write_topics, write_commands, write_python):
            write(pages / "reference")
        if headers and shutil.which("doxygen"):
            (pages / "reference/cpp.md").write_text(cpp.PAGE)
        shutil.copyfile(pathlib.Path(__file__).with_name("site.css"), pages / "site.css")
        config = pathlib.Path(folder) / "mkdocs.yml"
        config.write_text(CONFIG.replace("STG Swarm", f"STG Swarm, {version()}") + EXTRA[several] + f"nav: {navigation(pages)}\n")
        done = subprocess.run([MKDOCS, "build", "--strict", "-f", config, "-d", site], check=False,
                              env={**os.environ, "PYTHONWARNINGS": "ignore"})  # fmt: skip
        if done.returncode != 0:
            return 1
    search_from_disk(site, several)
    if headers:
        cpp.write_headers(site)
    print(f"docs: {site}/index.html")
    return 0


def main():
    """Runs the tool; returns the exit status."""
    parser = argparse.ArgumentParser(prog="docs", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=SITE, help="folder of the site (default: build/site)")
    parser.add_argument("--no-headers", action="store_true", help="leave out the C++ headers")
    parser.add_argument("--versions", action="store_true", help="into a folder of the version below --out, beside other versions")
    parser.add_argument("--serve", action="store_true", help="then serve the site on http://127.0.0.1:8301")
    options = parser.parse_args()
    if not shutil.which(MKDOCS):
        print("docs: mkdocs is missing: install Debian's mkdocs-material", file=sys.stderr)
        return 2
    site = options.out.resolve() / version() if options.versions else options.out.resolve()
    status = build(site, not options.no_headers, options.versions)
    if status == 0 and options.versions:
        list_versions(site.parent)
    if status == 0 and options.serve:
        print("docs: http://127.0.0.1:8301 (Ctrl-C ends it)", flush=True)
        serve = [sys.executable, "-m", "http.server", "8301", "--bind", "127.0.0.1", "-d", options.out]
        try:
            return subprocess.run(serve, check=False).returncode
        except KeyboardInterrupt:
            return 0
    return status


if __name__ == "__main__":
    sys.exit(main())
