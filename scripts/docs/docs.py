#!/usr/bin/python3
"""Builds the documentation site: the pages of docs/, references made from the code, C++ headers.

Needs mkdocs-material; doxygen for the C++ headers, which are left out with a line where it is
missing. Links that lead nowhere end the build. Exit status: 0 done, 1 mkdocs refuses, 2 wrong usage.
"""

import argparse
import ast
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = ROOT / "build" / "site"
MKDOCS = "mkdocs"
CONFIG = """\
site_name: STG Swarm
docs_dir: pages
use_directory_urls: false
theme:
  name: material
  font: false
  features: [navigation.tabs, navigation.top, search.highlight, search.suggest]
  palette:
    - {media: "(prefers-color-scheme: light)", scheme: default, primary: blue grey, toggle: {icon: material/weather-night, name: dark}}
    - {media: "(prefers-color-scheme: dark)", scheme: slate, primary: blue grey, toggle: {icon: material/weather-sunny, name: light}}
plugins: [search]
markdown_extensions: [tables, admonition, toc: {permalink: true}, pymdownx.superfences]
extra: {generator: false, version: {provider: mike}}
"""
PROGRAMS = {
    "marl_trainer": ["train", "evaluate", "bench_env", "check_trace"],
    "acoustic_channel": ["simulate"],
    "auv_dynamics": ["check_vehicle"],
}
DOXYFILE = """
PROJECT_NAME = "STG Swarm"
INPUT = {input}
RECURSIVE = YES
FILE_PATTERNS = *.hpp
STRIP_FROM_INC_PATH = {input}
OUTPUT_DIRECTORY = {out}
HTML_OUTPUT = cpp
GENERATE_LATEX = NO
QUIET = YES
WARNINGS = NO
EXTRACT_ALL = YES
SEARCHENGINE = YES
HAVE_DOT = NO
SOURCE_BROWSER = NO
VERBATIM_HEADERS = NO
"""


def rebased(text, folder):
    """A page's text with its links out of docs/ turned to the repository's files as text."""

    def turn(match):
        label, target = match.group(1), match.group(2)
        if re.match(r"(https?:|mailto:|#)", target):
            return match.group(0)
        path = target.partition("#")[0]
        place = (ROOT / "docs" / folder / path).resolve()
        if (ROOT / "docs") in place.parents and place.suffix in (".md", ".png", ".svg", ".jpg"):
            return match.group(0)
        if place == ROOT / "README.md":
            return match.group(0).replace(target, "../" * len(folder.parts) + "index.md")
        inside = place.relative_to(ROOT) if ROOT in place.parents else path
        return f"{label.strip('![]')} (`{inside}`)"

    return re.sub(r"(!?\[[^\]]*\])\(([^)\s]+)\)", turn, text)


def copy_pages(to):
    """Copies docs/ and the README, which begins the site."""
    for file in sorted((ROOT / "docs").rglob("*")):
        inside = file.relative_to(ROOT / "docs")
        if file.is_dir():
            continue
        target = to / inside
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".md":
            target.write_text(rebased(file.read_text(), inside.parent))
        elif file.suffix in (".png", ".svg", ".jpg"):
            shutil.copyfile(file, target)
    readme = re.sub(r"\]\((?!docs/|https?:|mailto:|#)", "](../", (ROOT / "README.md").read_text())
    readme = readme.replace("](docs/", "](")
    (to / "index.md").write_text(rebased(readme, pathlib.Path(".")))


def write_topics(to):
    """All messages, as their files describe them, and all names of topics."""
    lines = ["# Topics, messages and services", "", "Made from the headers `topics.hpp` and the message files.", ""]
    lines += ["## Names", "", "| name | package |", "|---|---|"]
    for header in sorted((ROOT / "src").rglob("topics.hpp")):
        package = header.relative_to(ROOT / "src").parts[0]
        lines += [f"| `{name}` | {package} |" for name in re.findall(r'char k\w+\[\] = "([^"]+)"', header.read_text())]
    lines += ["", "## Messages and services"]
    for file in sorted([*(ROOT / "src/auv_msgs").rglob("*.msg"), *(ROOT / "src/auv_msgs").rglob("*.srv")]):
        lines += ["", f"### {file.stem}", "", "```", file.read_text().rstrip(), "```"]
    (to / "topics.md").write_text("\n".join(lines) + "\n")


def write_commands(to):
    """What every program says of itself; those that are not built are named."""
    lines = ["# Command lines", "", "## ./stg", "", "```", output([ROOT / "stg", "help"]), "```"]
    for package, names in PROGRAMS.items():
        for name in names:
            program = ROOT / "devel/lib" / package / name
            said = output([program, "--help"]) if program.exists() else "(not built)"
            lines += ["", f"## rosrun {package} {name}", "", "```", said, "```"]
    (to / "commands.md").write_text("\n".join(lines) + "\n")


def output(command):
    """What a command prints."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, timeout=60)
    return done.stdout.rstrip()


def write_python(to):
    """Signatures and docstrings of the module stg."""
    lines = ["# The Python module stg", "", "Made from its sources; [Learning in Python](../python.md) shows its use."]
    for file in sorted((ROOT / "src/stg_python/python/stg").glob("*.py*")):
        if file.suffix not in (".py", ".pyi"):
            continue
        module = ast.parse(file.read_text())
        parts = [part for node in module.body for part in described(node)]
        if parts:
            lines += ["", f"## stg.{file.stem}" if file.stem != "__init__" else "## stg", "", ast.get_docstring(module) or ""]
            lines += parts
    (to / "python.md").write_text("\n".join(lines) + "\n")


def described(node, depth=3, of=""):
    """Markdown of a public function or class."""
    kinds = (ast.FunctionDef, ast.ClassDef)
    if not isinstance(node, kinds) or (node.name.startswith("_") and node.name != "__init__"):
        return []
    text = ast.get_docstring(node)
    if isinstance(node, ast.ClassDef):
        inner = [part for one in node.body for part in described(one, depth + 1, node.name)]
        return ["", f"{'#' * depth} {node.name}", "", *fenced(text), *inner]
    arguments = ast.unparse(node.args)
    return ["", f"{'#' * depth} {of + '.' if of else ''}{node.name}", "", f"`{node.name}({arguments})`", "", *fenced(text)]


def fenced(text):
    """A docstring with its own lines."""
    return ["```text", text, "```"] if text else []


def write_headers(site):
    """The C++ headers by doxygen."""
    if not shutil.which("doxygen"):
        print("docs: without doxygen the C++ headers are left out", file=sys.stderr)
        return
    inputs = " ".join(str(p) for p in sorted((ROOT / "src").glob("*/include")))
    # It remarks on words of comments that look like its commands, and has no option against it.
    subprocess.run(["doxygen", "-"], input=DOXYFILE.format(input=inputs, out=site), text=True, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip


def search_from_disk(site):
    """Lets the search work in pages that are opened from disk, where a browser reads no other file but
    a script: the index and the searching program become one, which such a page loads first."""
    index = (site / "search/search_index.json").read_text().replace("</", "<\\/")
    (worker,) = (site / "assets/javascripts/workers").glob("search.*.js")
    program = f'new Blob([{json.dumps(worker.read_text())}], {{type: "text/javascript"}})'
    text = f"var __search = {{index: Promise.resolve({index}), worker: URL.createObjectURL({program})}};\n"
    (site / "search/from_disk.js").write_text(text)
    for page in site.rglob("*.html"):
        up = "../" * (len(page.relative_to(site).parts) - 1)
        load = f"""<script>if (location.protocol === "file:") document.write('<script src="{up}search/from_disk.js"><\\/script>')</script>"""
        page.write_text(re.sub(r'(<script src="[^"]*assets/javascripts/bundle)', lambda m, s=load: s + m.group(1), page.read_text()))


def version():
    """The newest version that the changelog names."""
    found = re.search(r"^## \[([^\]]+)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    return found.group(1) if found else "unknown"


def list_versions(folder):
    """Writes what the pages' menu of versions reads, and a first page that leads to the newest."""
    found = [one.name for one in folder.iterdir() if (one / "index.html").is_file()]
    numbers = lambda name: [int(part) for part in re.findall(r"\d+", name)] or [1 << 30]  # what is not released yet is newest
    found.sort(key=numbers, reverse=True)
    entries = [{"version": name, "title": name, "aliases": []} for name in found]
    (folder / "versions.json").write_text(json.dumps(entries))
    newest = html.escape(found[0], quote=True)
    (folder / "index.html").write_text(f'<!doctype html><meta http-equiv="refresh" content="0; url={newest}/index.html">\n')


def build(site, headers):
    """Builds the site; returns the exit status."""
    with tempfile.TemporaryDirectory() as folder:
        pages = pathlib.Path(folder) / "pages"
        pages.mkdir()
        copy_pages(pages)
        (pages / "reference").mkdir()
        for write in (write_topics, write_commands, write_python):
            write(pages / "reference")
        config = pathlib.Path(folder) / "mkdocs.yml"
        config.write_text(CONFIG.replace("STG Swarm", f"STG Swarm, {version()}"))
        done = subprocess.run([MKDOCS, "build", "--strict", "-f", config, "-d", site], check=False,
                              env={**os.environ, "PYTHONWARNINGS": "ignore"})  # fmt: skip
        if done.returncode != 0:
            return 1
    search_from_disk(site)
    if headers:
        write_headers(site)
    print(f"docs: {site}/index.html")
    return 0


def main():
    """Runs the tool; returns the exit status."""
    parser = argparse.ArgumentParser(prog="docs", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=SITE, help="folder of the site (default: build/site)")
    parser.add_argument("--no-headers", action="store_true", help="without the C++ headers")
    parser.add_argument("--versions", action="store_true", help="into a folder of the version below --out, beside other versions")
    parser.add_argument("--serve", action="store_true", help="serve it on http://127.0.0.1:8301 then")
    options = parser.parse_args()
    if not shutil.which(MKDOCS):
        print("docs: no mkdocs: install Debian's mkdocs-material", file=sys.stderr)
        return 2
    site = options.out.resolve() / version() if options.versions else options.out.resolve()
    status = build(site, not options.no_headers)
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
