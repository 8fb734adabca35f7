"""Reference pages of the site that are made from the code: topics and messages, command lines, the module
stg."""

import ast
import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Compiled programs, and programs that run from their sources.
PROGRAMS = {
    "marl_trainer": ["train", "train_swarm", "evaluate", "bench_env", "check_trace"],
    "acoustic_channel": ["simulate"],
    "auv_dynamics": ["check_vehicle", "crop_terrain"],
}
SCRIPTS = {
    "marl_trainer": ["reproduce", "tune"],
    "acoustic_channel": ["plot_network.py"],
    "stg_monitor": ["report.py", "bag_report.py"],
}
TITLES = {"__init__": "stg", "_core": "stg: types of the engine"}


def write_topics(to):
    """All messages, as described in their files, and all names of topics."""
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
    """The help of every program (programs that are not built are marked), and the arguments of launch
    files."""
    lines = ["# Command lines", "", "## ./stg", "", "```", output([ROOT / "stg", "help"]), "```"]
    for package, names in PROGRAMS.items():
        for name in names:
            program = ROOT / "devel/lib" / package / name
            said = output([program, "--help"]) if program.exists() else "(not built)"
            lines += ["", f"## rosrun {package} {name}", "", "```", said, "```"]
    for package, names in SCRIPTS.items():
        for name in names:
            said = output([ROOT / "src" / package / "scripts" / name, "--help"])
            lines += ["", f"## rosrun {package} {name}", "", "```", said, "```"]
    for file in sorted([*(ROOT / "launch").glob("*.launch"), *(ROOT / "src/acoustic_channel/launch").glob("*.launch")]):
        package = "acoustic_channel" if "src" in file.parts else "stg_bringup"
        lines += ["", f"## roslaunch {package} {file.name}", "", "| argument | default | meaning |", "|---|---|---|"]
        lines += launch_arguments(file)
    (to / "commands.md").write_text("\n".join(lines) + "\n")


def launch_arguments(file):
    """Rows of a table: the arguments of a launch file that a user may set."""
    cell = lambda text: re.sub(r"\s+", " ", text).replace("|", "\\|")
    code = lambda text: f"`{cell(text)}`" if text.strip() else ""
    return [f"| `{one.get('name')}:=` | {'required' if one.get('default') is None else code(one.get('default'))} | {cell(one.get('doc', ''))} |"
            for one in ElementTree.parse(file).getroot().findall("arg") if one.get("value") is None]  # fmt: skip


def output(command):
    """The output of a command."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, timeout=300)
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
            lines += ["", f"## {TITLES.get(file.stem, f'stg.{file.stem}')}", "", ast.get_docstring(module) or ""]
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
        return ["", f"{'#' * depth} {node.name}", "", *told(text), *inner]
    arguments = ast.unparse(node.args)
    return ["", f"{'#' * depth} {of + '.' if of else ''}{node.name}", "", f"`{node.name}({arguments})`", "", *told(text)]


def told(text):
    """A docstring: as text, or with its own line breaks if it has more than paragraphs."""
    if not text:
        return []
    if re.search(r"^([ \t]|[-*>] )", text.replace("\n\n", "\n"), re.MULTILINE):
        return ["```text", text, "```"]
    parts = text.split("`")  # every second part is code and stays unchanged
    parts[::2] = [re.sub(r"([\\*_\[\]<>#|~])", r"\\\1", part) for part in parts[::2]]
    return ["`".join(parts)]
