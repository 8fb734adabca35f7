"""Scenarios from files and bags, for programs that show a run; used by view.py and bag_report.py."""

import math

from stg_common.files import Damaged


SECTIONS = ("workspace", "vehicle", "reward", "sea", "reset", "target", "track")


def is_number(value):
    """True if a value is a finite number."""
    return type(value) in (int, float) and abs(value) < math.inf


def sections_of(scenario, name):
    """Returns the sections of a scenario that pictures depend on, as {section: {key: value}}. Raises Damaged
    with the `name` of the source if it is not a scenario."""
    if not isinstance(scenario, dict):
        raise Damaged(name, "is not a scenario")
    sections = {key: scenario.get(key) or {} for key in SECTIONS}
    for key, section in sections.items():
        if not isinstance(section, dict):
            raise Damaged(name, f"{key}: is not a section")
    band = sections["reward"].get("band_m") or [0.0, 0.0]
    if not (isinstance(band, list) and len(band) == 2 and all(map(is_number, band))):
        raise Damaged(name, "reward.band_m: is not two numbers")
    return sections
