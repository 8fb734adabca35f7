"""Scenarios by name, with changes given as a dictionary."""

import os
import pathlib

from stg import _core

__all__ = ["load_scenario", "policy_file", "scenario_folder", "scenario_names"]


def scenario_folder():
    """Returns the folder of the shipped scenarios.

    $STG_SCENARIOS where it is set, else the one inside this module's folder (a wheel's), else that
    of stg_bringup on ROS_PACKAGE_PATH, else the one that belongs to the files of this module.
    """
    try:
        return _core.scenario_folder()
    except _core.UserError:
        if os.environ.get("STG_SCENARIOS"):
            raise
        for parent in pathlib.Path(__file__).resolve().parents:
            for folder in ("stg_bringup/scenarios", "share/stg_bringup/scenarios"):
                if (parent / folder).is_dir():
                    return str(parent / folder)
        raise


def policy_file(name):
    """Returns the file of the policy that ships for a scenario, "medium" or "hard".

    Raises ValueError for others.
    """
    folder = pathlib.Path(scenario_folder()).parent / "policies"
    file = folder / f"{name}.onnx"
    if not file.is_file():
        there = ", ".join(sorted(path.stem for path in folder.glob("*.onnx")))
        raise ValueError(f"policy '{name}': no policy with this name is shipped; there are: {there}")
    return str(file)


def scenario_names():
    """Returns the names of the shipped scenarios, sorted."""
    return sorted(path.stem for path in pathlib.Path(scenario_folder()).glob("*.yaml"))


def _text(value, within):
    """Returns the text of a value in a YAML file. `within` has the lists and dictionaries around it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        within = _inside(value, within)
        return "[" + ", ".join(_text(v, within) for v in value) + "]"
    return str(value)


def _inside(value, within):
    """Returns `within` and `value`. Raises ValueError if the value contains itself or is nested too deep."""
    if any(value is outer for outer in within):
        raise ValueError(f"overrides: a {type(value).__name__} contains itself")
    if len(within) >= 32:
        raise ValueError("overrides: more than 32 dictionaries or lists within each other")
    return (*within, value)


def _walk(prefix, values, within):
    """Yields "key.path=value" for a dictionary and the dictionaries in it."""
    within = _inside(values, within)
    for key, value in values.items():
        if not isinstance(key, str):
            raise TypeError(f"overrides: keys must be strings, not {type(key).__name__} ({key!r})")
        if isinstance(value, dict):
            yield from _walk(f"{prefix}{key}.", value, within)
        else:
            yield f"{prefix}{key}={_text(value, within)}"


def override_texts(overrides):
    """Returns ["key.path=value", ...] of a dictionary, nested or with dotted keys, or of a list of
    such texts."""
    if overrides is None:
        return []
    if isinstance(overrides, (list, tuple)):
        return [str(text) for text in overrides]
    if not isinstance(overrides, dict):
        raise TypeError(
            "overrides: expected a dictionary {'key.path': value} or a list of strings "
            f"'key.path=value', not {overrides!r}"
        )
    return list(_walk("", overrides, ()))


def load_scenario(scenario="medium", condition="nominal", overrides=None):
    """Returns a Scenario.

    scenario: name of a shipped one, path of a YAML file, or a Scenario, which is returned as it is.
    condition: "nominal", or name or path of an overlay. overrides: {"key.path": value}, nested or
    not, or ["key.path=value", ...], see docs/scenarios.md. Raises UserError that names file, line and key.
    """
    if isinstance(scenario, _core.Scenario):
        if overrides or condition != "nominal":
            raise ValueError("a loaded scenario takes neither condition nor overrides")
        return scenario
    texts = override_texts(overrides)
    return _core.Scenario.load(str(scenario), str(condition), texts, scenario_folder())
