"""The repository's own files, by kind."""

import os
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
CPP = {".cpp", ".hpp"}
_SKIPPED = {"build", "devel", "install", "results", "runs", "out", "logs", "__pycache__"}


def _walk():
    """Yields the files below ROOT as relative paths, without git."""
    for folder, folders, names in os.walk(ROOT):
        skipped = _SKIPPED if folder == str(ROOT) else {"__pycache__"}
        folders[:] = [f for f in folders if f not in skipped and not f.startswith(".")]
        for name in names:
            yield os.path.relpath(os.path.join(folder, name), ROOT)


def _known_to_git():
    """Returns the files as relative paths; empty without git or without a repository."""
    if shutil.which("git") is None:
        return []
    done = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        universal_newlines=True,
        check=False,
    )
    return done.stdout.split("\0") if done.returncode == 0 else []


def all_files():
    """Returns the sorted paths of the files that belong to the repository, relative to ROOT."""
    names = _known_to_git() or _walk()
    paths = (pathlib.Path(name) for name in names if name)
    return sorted(p for p in paths if (ROOT / p).is_file() and not (ROOT / p).is_symlink())


def _interpreter(path):
    """Returns the last word of a file's #! line, or an empty string."""
    with open(ROOT / path, "rb") as file:
        line = file.readline(100)
    return line[2:].split()[-1].decode(errors="replace") if line.startswith(b"#!") else ""


def cpp_files():
    """Returns every C++ source and header."""
    return [p for p in all_files() if p.suffix in CPP]


def shell_files():
    """Returns every shell script, with or without a suffix."""
    return [p for p in all_files() if p.suffix == ".sh" or _interpreter(p).endswith("sh")]


def python_files():
    """Returns every Python file, with or without a suffix."""
    return [p for p in all_files() if p.suffix == ".py" or "python" in _interpreter(p)]
