#!/usr/bin/python3
"""Prints the number of AUVs of a scenario: `agents` of its file, or else of its base.

Usage: scenario_agents.py SCENARIO, a name or a YAML file. Prints nothing when it cannot tell; what
is wrong with the file, the nodes say best.
"""

import os
import pathlib
import sys

import yaml

SHIPPED = pathlib.Path(__file__).resolve().parents[1] / "src" / "stg_bringup" / "scenarios"
LONGEST_CHAIN = 20  # of bases


def agents_of(scenario):
    """Returns the number of AUVs, or None."""
    shipped = pathlib.Path(os.environ.get("STG_SCENARIOS") or SHIPPED)
    if "/" in scenario or scenario.endswith(".yaml"):
        file = pathlib.Path(scenario)
    else:
        file = shipped / f"{scenario}.yaml"
    for _ in range(LONGEST_CHAIN):
        try:
            content = yaml.safe_load(file.read_text(encoding="utf-8"))
        except (OSError, ValueError, yaml.YAMLError):
            return None
        if not isinstance(content, dict):
            return None
        if "agents" in content or "base" not in content:
            agents = content.get("agents")
            return agents if isinstance(agents, int) else None
        base = str(content["base"])
        beside = file.parent / base
        file = beside if "/" in base or beside.exists() else shipped / base
    return None


if __name__ == "__main__":
    found = agents_of(sys.argv[1])
    if found is not None:
        print(found)
