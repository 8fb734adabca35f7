#!/usr/bin/python3
"""Prints the number of AUVs of a scenario: `agents` of its file, or else of its base.

Usage: scenario_agents.py SCENARIO, a name or a YAML file. Prints nothing when it cannot find the
number: the nodes then report the error in the scenario. If a file cannot be read as YAML, it prints
the error and exits with status 2.
"""

import os
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "src"
from stg_common.program import run_program
from stg_common.yaml_files import read_yaml

SHIPPED = SOURCE / "stg_bringup" / "scenarios"
LONGEST_CHAIN = 20  # largest number of bases


def agents_of(scenario):
    """Returns the number of AUVs, or None."""
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
        if "agents" in content or "base" not in content:
            agents = content.get("agents")
            return agents if type(agents) is int else None
        base = str(content["base"])
        beside = file.parent / base
        file = beside if "/" in base or beside.exists() else shipped / base
    return None


def main():
    """Prints the number; returns the exit status."""
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    found = agents_of(sys.argv[1])
    if found is not None:
        print(found)
    return 0


if __name__ == "__main__":
    run_program("scenario_agents", main)
