"""Checks that the policies of a study of flights were trained as the study states.

A row such as "white noise" is only worth something if its policies were trained with white noise, and with
everything else like the other rows. train_swarm writes its options to config.json beside its policies.
"""

import os

from stg_common.files import read_json
from stg_study.study import StudyError

CONFIG = "config.json"
# Options that change no policy: they only say how often the training is validated.
WITHOUT_EFFECT = ("validation-interval", "validation-episodes")


def _options(policy):
    """The options of the training that made this policy file; None if it lies beside no CONFIG."""
    path = os.path.join(os.path.dirname(policy), CONFIG)
    return read_json(path) if os.path.exists(path) else None


def check_trainings(study, policies):
    """Raises StudyError if a training differs from what its pilot's `trained` states, or from another
    pilot's training in any option that neither of the two states. Does nothing if no pilot states any.

    policies: list of (pilot's name, seed, path of the policy)
    """
    if not any(pilot.trained for pilot in study.pilots.values()):
        return
    first = None  # (stated options, path, options) of the first training
    for name, seed, path in policies:
        options = _options(path)
        if options is None:
            raise StudyError(f"{path}: the study states how it was trained, but {CONFIG} is missing beside it")
        stated = {**study.pilots[name].trained, "seed": seed}
        for option, value in stated.items():
            if options.get(option) != value:
                raise StudyError(f"{path}: trained with {option}={options.get(option)}, "
                                 f"but the study states {value} for '{name}'")  # fmt: skip
        first = first or (stated, path, options)
        free = {*stated, *first[0], *WITHOUT_EFFECT}
        for option in sorted({*options, *first[2]} - free):
            if options.get(option) != first[2].get(option):
                raise StudyError(f"{path}: trained with {option}={options.get(option)}, but {first[1]} with "
                                 f"{first[2].get(option)}; the study states no such difference")  # fmt: skip
