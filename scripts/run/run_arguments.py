"""The arguments of a launch: which arguments its file has, their kinds, and a check of the given values.

The default of an argument shows its kind: `true` and `false` are switches, digits are a whole number, digits
with a point are a number, and everything else is text. If the default is another argument, the kind is that
of the other one. roslaunch accepts any value; a wrong one causes an error later or none at all.
"""

import difflib
import math
import re
import xml.etree.ElementTree as ElementTree

import roslib.packages
from roslaunch.loader import convert_value
from run_checks import Refusal

MOST_AGENTS = 255
OTHER = re.compile(r"^\$\(arg (\w+)\)$")
NUMBER = re.compile(r"^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$", re.IGNORECASE)
SEEDS = ("seed", "train_seed")
ANY_SEED = -1  # this default means the scenario's seed
# Numbers that come from the scenario if they are not given.
NUMBERS_OR_NOTHING = ("latitude", "longitude")
# Numbers that the program chooses if they are `auto`.
NUMBERS_OR_AUTO = ("lr", "critic_lr", "epochs", "critic_updates", "log_std", "noise_time")
# Arguments whose default is an expression, which roslaunch computes, and a value that shows their kind.
COMPUTED = {"open_water": "false", "target_lost_rate": "0.0"}
# An argument without effect unless another argument of the launch file has this value.
NEEDS = {
    "bag": {"record": "true"},
    "port": {"view": "web"},
    "view": {"gui": "true", "rviz": "true"},
    "config": {"emulate": "true"},
    "packet_log": {"emulate": "true"},
}
WINDOWS = ("overview", "follow", "both")  # views in rviz; a launch file with a port has `web`, too
WEB_RATE_HZ = 10.0  # the page in a browser gets no more steps per second (graph.launch)


def declared(file):
    """Returns {name: default, or None if it is required} of a launch file's arguments."""
    arguments = ElementTree.parse(file).getroot().findall("arg")
    return {arg.get("name"): arg.get("default") for arg in arguments if arg.get("value") is None}


def _as_roslaunch_reads(text):
    """Returns the bool, int, float or str that roslaunch makes of a text."""
    return convert_value(text, "auto")


def _is_whole(value):
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value):
    return _is_whole(value) or (isinstance(value, float) and math.isfinite(value))


def _what_it_takes(name, text, default):
    """Returns the kind of an argument if `text` is not of this kind; otherwise an empty string."""
    default = COMPUTED.get(name, default)
    given, usual = _as_roslaunch_reads(text), _as_roslaunch_reads(default)
    if name in NUMBERS_OR_NOTHING:
        fits, takes = not text or _is_number(given), "a number, such as 54.5, or nothing"
    elif name in NUMBERS_OR_AUTO and usual == "auto":
        fits = text == "auto" or re.match(NUMBER, text)
        takes = "a number, such as 0.001, or auto"
    elif isinstance(usual, bool):
        fits, takes = isinstance(given, bool), "true or false"
    elif name in SEEDS and usual != ANY_SEED:
        fits, takes = _is_whole(given) and given >= 0, "a whole number from 0"
    elif name == "agents":
        fits, takes = _is_whole(given), "a whole number, such as 4"
    elif _is_whole(usual):
        fits, takes = _is_whole(given), f"a whole number, such as {default}"
    elif _is_number(usual):
        fits, takes = _is_number(given), f"a number, such as {default}"
    else:
        fits, takes = isinstance(given, str), f"text (./{text} is a file of that name)"
    return "" if fits else takes


def _is_changed(name, given, defaults):
    """True if the command line gives an argument another value than its default."""
    default = defaults.get(name) or ""
    return name in given and _as_roslaunch_reads(given[name]) != _as_roslaunch_reads(default)


def _check_priority(given, defaults):
    """Refuses a real-time priority for a run that does not follow the wall clock (graph.launch)."""
    name = "realtime_priority"
    if not _is_changed(name, given, defaults) or _as_roslaunch_reads(given[name]) == 0:
        return
    factor = given.get("real_time_factor", defaults["real_time_factor"])
    if not 0.0 < float(factor) <= 1.0:
        raise Refusal(
            f"{name}:={given[name]} has no effect, because real_time_factor is {factor}; add a"
            f" real_time_factor above 0 and at most 1, or leave out {name}"
        )


def _check_page(given, defaults):
    """Refuses arguments that have no effect on a page in a browser."""
    if "port" not in defaults or given.get("view", defaults["view"]) != "web":
        return
    if given.get("gui", "").lower() == "true":
        raise Refusal("gui:=true has no effect, because view is web; leave out one of them")
    rate = given.get("display_rate", "0")
    if _is_changed("display_rate", given, defaults) and float(rate) > WEB_RATE_HZ:
        raise Refusal(
            f"display_rate:={rate} has no effect above {WEB_RATE_HZ:g}, because view is web; add"
            f" display_rate:={WEB_RATE_HZ:g}, or leave out display_rate"
        )


def _check_effect(given, defaults):
    """Refuses arguments that have no effect beside the others, and two names for the scenario.

    @param given     {name: text} of the command line
    @param defaults  {name: text or None} of the launch file
    @throws Refusal  names the argument, and the other one which it needs
    """
    view, views = given.get("view", "overview"), WINDOWS + ("web",) * ("port" in defaults)
    if "view" in defaults and view not in views:
        raise Refusal(f"view: '{view}' is none of {', '.join(views)}")
    for name, needed in NEEDS.items():
        if given.get(name) in (None, defaults.get(name)) or (name == "view" and view == "web"):
            continue
        for other, value in needed.items():
            now = given.get(other, defaults.get(other))
            if other in defaults and str(now).lower() != value:
                raise Refusal(
                    f"{name}:={given[name]} has no effect, because {other} is {now}; add"
                    f" {other}:={value}, or leave out {name}"
                )
    _check_priority(given, defaults)
    _check_page(given, defaults)
    task, scenario = given.get("task"), given.get("scenario")
    if task and scenario and task != scenario:
        raise Refusal(
            f"task:={task} and scenario:={scenario} are two scenarios; leave out one of them"
        )


def check(words):
    """Refuses arguments that the launch file does not have, values of another kind, and arguments
    without effect.

    @param words  a roslaunch command line: [OPTIONS] PACKAGE FILE NAME:=TEXT ...
    @throws Refusal  names the argument and its kind
    """
    names = [word for word in words if ":=" not in word and not word.startswith("-")]
    found = roslib.packages.find_resource(*names[-2:]) if len(names) > 1 else []
    if not found:
        return
    defaults = declared(found[0])
    pairs = [word.split(":=", 1) for word in words if ":=" in word and word[0] != "_"]
    given = dict(pairs)
    for name in given:
        values = [text for other, text in pairs if other == name]
        if len(values) > 1:
            shown = " and ".join(f"{name}:={text}" for text in values)
            raise Refusal(f"{name} is given {len(values)} times ({shown}); leave out all but one")
    for name, text in given.items():
        if name not in defaults:
            near = difflib.get_close_matches(name, defaults, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"it has {', '.join(defaults)}"
            raise Refusal(f"{names[-1]} has no argument '{name}'; {hint}")
        if name == "bag" and "'" in text:
            raise Refusal("bag: the name must not contain '")
        if name == "agents" and not (text.isdecimal() and 1 <= int(text) <= MOST_AGENTS):
            raise Refusal(f"agents: '{text}' is not a whole number from 1 to {MOST_AGENTS}")
        if text and not text.strip():
            raise Refusal(f"{name}: '{text}' is blank")
        default, other = defaults[name] or "", OTHER.match(defaults[name] or "")
        takes = _what_it_takes(name, text, defaults[other.group(1)] if other else default)
        if takes:
            raise Refusal(f"{name} takes {takes}, not '{text}'")
    _check_effect(given, defaults)
