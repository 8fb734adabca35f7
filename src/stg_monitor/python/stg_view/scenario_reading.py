"""Scenarios as files and bags have them, for programs that show a run; used by view.py and bag_report.py."""

import math

from stg_common.files import Damaged


SECTIONS = ("workspace", "vehicle", "reward", "sea", "reset", "target")


def is_number(value):
    """Whether a value is a finite number."""
    return type(value) in (int, float) and abs(value) < math.inf


def sections_of(scenario, name):
    """Returns a scenario as {section: {key: value}} of the sections that pictures depend on; throws
    Damaged, with the `name` of its source, where it is none."""
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
