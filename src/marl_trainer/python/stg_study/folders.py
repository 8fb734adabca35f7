"""Folders of the programs that a study runs, and of its runs."""

import contextlib
import os
import sys

from stg_study.files import locked, write_atomically
from stg_study.study import StudyError


def program_folder(given, trains=True):
    """Folder of the program evaluate and, for a study that trains, of train."""
    needed = ("train", "evaluate") if trains else ("evaluate",)
    if given:
        candidates = [given]
    else:
        prefixes = os.environ.get("CMAKE_PREFIX_PATH", "").split(":")
        candidates = [os.path.join(p, "lib", "marl_trainer") for p in prefixes if p]
        candidates.append(os.path.dirname(os.path.realpath(sys.argv[0])))
    for folder in candidates:
        if all(os.access(os.path.join(folder, name), os.X_OK) for name in needed):
            return os.path.realpath(folder)
    raise StudyError(
        f"{' and '.join(needed)} not found in {', '.join(candidates)}; build and source the "
        "workspace, or name their folder with --bin"
    )


@contextlib.contextmanager
def own_folder(path):
    """Makes a folder that git ignores, and keeps other studies out of it as long as it is held."""
    os.makedirs(path, exist_ok=True)
    with locked(path):
        write_atomically(os.path.join(path, ".gitignore"), "*\n")
        yield
