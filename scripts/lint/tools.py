"""Checks by other programs. Each returns (what was checked, list of findings)."""

import collections
import re
import subprocess

from files import ROOT, cpp_files, python_files, shell_files


def run(command):
    """Runs `command` in ROOT; returns (exit status, lines of its output)."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        universal_newlines=True,
        errors="replace",
        check=False,
    )
    return done.returncode, done.stdout.splitlines()


def _judge(command, looked_at):
    """Runs a command. If it fails, every line of its output is a finding."""
    status, lines = run(command)
    findings = [line for line in lines if line.strip()] if status else []
    if status and not findings:
        findings = [f"{command[0]}: exit status {status}"]
    return looked_at, findings


def check_format(fix=False):
    """Runs clang-format with the settings of .clang-format; `fix` rewrites the files."""
    files = cpp_files()
    if fix:
        return _judge(["clang-format", "-i", *files], f"{len(files)} files")
    _, lines = run(["clang-format", "--dry-run", *files])
    places = [re.match(r"(\S+?):\d+:\d+: ", line) for line in lines]
    count = collections.Counter(match.group(1) for match in places if match)
    return f"{len(files)} files", [
        f"{name}: {number} places to format; ./stg lint --fix does it"
        for name, number in count.items()
    ]


def check_shell():
    """Runs shellcheck."""
    files = shell_files()
    return _judge(["shellcheck", "--format=gcc", *files], f"{len(files)} scripts")


def check_python():
    """Runs pyflakes: names that are unused, undefined, or defined twice."""
    files = python_files()
    return _judge(["/usr/bin/python3", "-m", "pyflakes", *files], f"{len(files)} files")


def check_catkin():
    """Runs catkin_lint, including its notices."""
    looked_at, findings = _judge(
        ["catkin_lint", "-W2", "--strict", "--offline", ROOT / "src"], "the packages"
    )
    return looked_at, [line for line in findings if not line.startswith("catkin_lint:")]
