#!/usr/bin/python3
"""Prints the value of a key of a scenario: that of its file, or else that of its base.

Usage: scenario_key.py SCENARIO KEY; a name or a YAML file, and a path such as agents or sea.open. Prints
nothing when it cannot find a whole number, true or false: the nodes then report the error in the scenario.
If a file cannot be read as YAML, it prints the error and exits with status 2.
"""

import os
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "src"
from stg_common.program import run_program
from stg_common.yaml_files import read_yaml

SHIPPED = SOURCE / "stg_bringup" / "scenarios"
LONGEST_CHAIN = 20  # largest number of bases


def value_at(content, key):
    """Returns the value at the path `key` of a map of maps, or None."""
    for name in key.split("."):
        content = content.get(name) if isinstance(content, dict) else None
    return content


def value_of(scenario, key):
    """Returns the whole number, or true or false, or None."""
    shipped = pathlib.Path(os.environ.get("STG_SCENARIOS") or SHIPPED)
    if "/" in scenario or scenario.endswith(".yaml"):
        file = pathlib.Path(scenario)
    else:
        file = shipped / f"{scenario}.yaml"
    for _ in range(LONGEST_CHAIN):
        if not file.exists():
            return None
        content = read_yaml(file)
        if not isinstance(content, dict):
            return None
        found = value_at(content, key)
        if found is not None or "base" not in content:
            return found if type(found) in (int, bool) else None
        base = str(content["base"])
        beside = file.parent / base
        file = beside if "/" in base or beside.exists() else shipped / base
    return None


def main():
    """Prints the value; returns the exit status."""
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    found = value_of(*sys.argv[1:])
    if found is not None:
        print(str(found).lower())
    return 0


if __name__ == "__main__":
    run_program("scenario_key", main)
