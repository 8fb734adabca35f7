"""Messages like those of a fault or a stranger: copies of good ones with some field changed."""

import copy
import math

import genpy

SECONDS = (0, 1, 2**31 - 1, 2**31, 2**32 - 1)  # values of stamps
FLOATS = (math.nan, math.inf, -math.inf, 1e300, -1e300, 1e7, -1.0, 0.0, 1e-300)
TEXTS = ("", "world", "auv_7/base_link", "\x00\x01", "x" * 1000, "\u00e9\u2603")
WHOLE_LIMITS = {  # the lowest and the highest number of each type
    f"{sign}int{bits}": (0 if sign else -(2 ** (bits - 1)), 2 ** (bits - (not sign)) - 1)
    for sign in ("u", "")
    for bits in (8, 16, 32, 64)
}
WHOLE_LIMITS.update(byte=WHOLE_LIMITS["int8"], char=WHOLE_LIMITS["uint8"])
LONGEST_LIST = 40


def leaves(message, path=()):
    """Yields (path, type) of every field that is no message itself: numbers, texts and lists."""
    for name, kind in zip(message.__slots__, message._slot_types):
        value, here = getattr(message, name), path + (name,)
        if isinstance(value, genpy.Message):
            yield from leaves(value, here)
        elif kind.endswith("]"):
            yield here, kind
            for k, item in enumerate(list(value)[:3]):
                if isinstance(item, genpy.Message):
                    yield from leaves(item, here + (k,))
        else:
            yield here, kind


def owner(message, path):
    """Returns the object that holds the field at `path`."""
    for name in path[:-1]:
        message = message[name] if isinstance(name, int) else getattr(message, name)
    return message


def other_list(value, kind, random):
    """Returns another list with the same type of items."""
    fixed = kind[kind.index("[") + 1 : -1]
    if isinstance(value, bytes):
        value = bytearray(value)
        size = len(value) if fixed else random.choice((0, 1, len(value), 5000))
        return bytes(random.randrange(256) for _ in range(size))
    items = list(value)
    what = random.choice(("spoil", "spoil", "empty", "half", "twice")) if not fixed else "spoil"
    if what == "empty":
        return []
    if what == "half":
        return items[: len(items) // 2]
    if what == "twice":
        return (items * 2)[:LONGEST_LIST]
    if items and not isinstance(items[0], genpy.Message):
        k = random.randrange(len(items))
        items[k] = other_value(items[k], kind[: kind.index("[")], random)
    return items


def other_value(value, kind, random):
    """Returns another value of a field's type."""
    if kind.endswith("]"):
        return other_list(value, kind, random)
    if kind == "time":
        base = value.to_sec() if random.random() < 0.7 else 0.0
        step = random.choice((-1e3, -58.0, -0.1, 0.1, 1.0, 58.0, 1e3, 1e6) + SECONDS)
        seconds = min(max(base + step, 0.0), 2.0**32 - 0.05)
        return genpy.Time(int(seconds), int((seconds % 1.0) * 1e9))
    if kind.startswith("float"):
        number = random.choice(FLOATS + (value * (1.0 + random.uniform(-1.0, 1.0)),))
        if kind == "float32" and math.isfinite(number):
            return min(max(number, -3e38), 3e38)
        return number
    if kind == "bool":
        return not value
    if kind == "string":
        return random.choice(TEXTS)
    low, high = WHOLE_LIMITS[kind]
    return random.choice((low, high, min(max(value + random.choice((-1, 1, 7)), low), high)))


def mutated(message, random):
    """Returns a copy of a message with one or a few fields changed."""
    message = copy.deepcopy(message)
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        path, kind = random.choice(list(leaves(message)))
        place = owner(message, path)
        setattr(place, path[-1], other_value(getattr(place, path[-1]), kind, random))
    return message


def stamped(message, seconds):
    """Returns a copy of a message. All its stamps are `seconds` of simulated time."""
    message = copy.deepcopy(message)
    for path, kind in leaves(message):
        if kind == "time":
            time = genpy.Time(int(seconds), int((seconds % 1.0) * 1e9))
            setattr(owner(message, path), path[-1], time)
    return message
