"""The C++ headers of the site, by doxygen."""

import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
# The page of the site with links to the headers.
PAGE = """# C++ headers

Of all classes and functions that another package may use, made by doxygen from `include/` of each package:
<a href="../cpp/index.html">overview</a>, <a href="../cpp/annotated.html">classes</a>, <a href="../cpp/files.html">headers</a>.
"""
NAMESPACES = {
    "stg": "Numbers and lanes, time, random numbers, errors and files, which everything else needs: package auv_common.",
    "stg::config": "Strict configuration files and options with their ranges: package auv_common.",
    "stg::dynamics": "Vehicles, world, current, targets and sensing: package auv_dynamics.",
    "stg::acoustics": "Propagation, modems, medium access, links and the network: package acoustic_channel.",
    "stg::acoustics::janus": "Packets and waveforms of JANUS.",
    "stg::acoustics::micromodem": "Sentences of the Micromodem.",
    "stg::acoustics::s2c": "Commands and notifications of S2C modems.",
    "stg::agent": "What one AUV knows, estimates, says and decides: package stg_agent.",
    "stg::task": "The reward, the metrics and the critic's state: package stg_env.",
    "stg::env": "Scenarios, environments and evaluation: package stg_env.",
    "stg::learn": "Networks, buffers, algorithms and training: package marl_trainer.",
    "stg::python": "The engine as the Python module stg: package stg_python.",
}
DOXYFILE = """
PROJECT_NAME = "STG Swarm"
INPUT = {input} {pages}
RECURSIVE = YES
FILE_PATTERNS = *.hpp *.dox
STRIP_FROM_PATH = {input}
STRIP_FROM_INC_PATH = {input}
INPUT_FILTER = "awk -f {here}/file_comments.awk"
LAYOUT_FILE = {pages}/layout.xml
OUTPUT_DIRECTORY = {out}
HTML_OUTPUT = cpp
HTML_EXTRA_STYLESHEET = {here}/headers.css
HTML_COLORSTYLE_HUE = 205
HTML_COLORSTYLE_SAT = 70
HTML_COLORSTYLE_GAMMA = 90
GENERATE_LATEX = NO
QUIET = YES
WARNINGS = NO
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
AUTOLINK_SUPPORT = NO
SEARCHENGINE = YES
HAVE_DOT = NO
SOURCE_BROWSER = NO
VERBATIM_HEADERS = NO
"""


def overview():
    """The first page, with the purpose of each namespace. Names in comments do not refer to these
    namespaces."""
    rows = "\n".join(f"<tr><td>@ref {name} \"{name}\"</td><td>{text}</td></tr>" for name, text in NAMESPACES.items())
    spaces = "\n".join(f"/** @namespace {name}\n@brief {text} */" for name, text in NAMESPACES.items())
    return (f"/** @mainpage C++ headers\nWhat another package may use of each package, one folder per subject.\n"
            f"<table><tr><th>namespace</th><th>what is in it</th></tr>\n{rows}\n</table> */\n{spaces}\n")  # fmt: skip


def write_headers(site):
    """Writes the pages of the headers into the folder cpp of the site."""
    if not shutil.which("doxygen"):
        print("docs: without doxygen the C++ headers are left out", file=sys.stderr)
        return
    inputs = " ".join(str(p) for p in sorted((ROOT / "src").glob("*/include")))
    with tempfile.TemporaryDirectory() as folder:
        pages = pathlib.Path(folder)
        (pages / "overview.dox").write_text(overview())
        subprocess.run(["doxygen", "-l", "layout.xml"], cwd=pages, check=True, stdout=subprocess.DEVNULL)
        layout = (pages / "layout.xml").read_text()
        back = '<navindex>\n    <tab type="user" visible="yes" url="../index.html" title="Back to the site"/>'
        (pages / "layout.xml").write_text(layout.replace("<navindex>", back, 1))
        settings = DOXYFILE.format(input=inputs, out=site, pages=pages, here=HERE)
        # doxygen warns about words in comments that look like its commands, and no option switches this off.
        subprocess.run(["doxygen", "-"], input=settings, text=True, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
