"""Waits for conditions in a running graph, for the tests of all packages."""

import time


def wait_for(condition, timeout_s, what):
    """Returns condition()'s first true value; fails after `timeout_s` seconds of wall time."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"not within {timeout_s:.0f} s: {what}")
