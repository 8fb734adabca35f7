"""Chooses the engine for this processor if there are several, as in a wheel.

$STG_INSTRUCTION_SET names one; results differ in their last
bits between instruction sets, see docs/platforms.md.
"""

import importlib.machinery
import importlib.util
import os
import pathlib
import sys


def _file(name):
    """Returns the engine of an instruction set, or None."""
    folder = pathlib.Path(__file__).parent / f"_{name.replace('-', '_')}"
    return next(iter(sorted(folder.glob("_core.*.so"))), None)


def _load(file):
    """Loads a file as the module stg._core."""
    loader = importlib.machinery.ExtensionFileLoader("stg._core", str(file))
    module = importlib.util.module_from_spec(
        importlib.util.spec_from_file_location("stg._core", str(file), loader=loader)
    )
    sys.modules["stg._core"] = module
    loader.exec_module(module)


def choose():
    """Loads the chosen engine as the module stg._core, before any other import of it."""
    wanted = os.environ.get("STG_INSTRUCTION_SET", "")
    file = _file("x86-64-v3")
    if file and wanted in ("", "x86-64-v3"):
        from stg import _processor  # pylint: disable=import-outside-toplevel

        if _processor.X86_64_V3:
            _load(file)
    from stg import _core  # pylint: disable=import-outside-toplevel

    if wanted not in ("", _core.INSTRUCTION_SET):
        raise ImportError(
            f"STG_INSTRUCTION_SET: the engine of stg for '{wanted}' is not installed, or this processor cannot run it"
        )
