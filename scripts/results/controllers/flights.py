"""Flights of `evaluate` that tuning and tables share, each flown once and kept in a file."""

import argparse
import hashlib
import json
import os
import subprocess

from stg_common.files import Damaged, expect, member, read_text

CONDITIONS = (
    "nominal", "fast_target", "far_initialization", "limited_sensing", "degraded_communication",
    "strong_current", "no_bottom_lock", "combined_stress",
)
# So much noise at the site that no frame is recognised.
SILENCE = ("channel.physical.noise.site_db=200.0",)


class FlightError(Exception):
    """Why there is no flight, told in words for the user."""


def count(text):
    """An argument of a command line that is a positive whole number."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


class Flights:
    """Evaluations by what was asked; a run that is started again goes on where it ended."""

    def __init__(self, file, evaluate="evaluate", workers=1):
        self.file, self.workers = file, workers
        self.program = [evaluate] if os.sep in evaluate else ["rosrun", "marl_trainer", evaluate]
        self.known = {}
        if os.path.exists(file):
            for number, line in enumerate(read_text(file).splitlines(), start=1):
                try:
                    flight = expect(file, json.loads(line), dict)
                except (ValueError, RecursionError):
                    raise Damaged(file, "is not JSON; delete this line to go on", number) from None
                key = member(file, flight, "key", str)
                self.known[key] = member(file, flight, "found", dict)

    def fly(self, policy, scenario, condition, episodes, seed, overrides=(), privileged=False):
        """Returns the metrics of `evaluate`: means, and standard deviations as <name>_std.
        privileged: a built-in controller reads true states."""
        asked = [policy, scenario, condition, episodes, seed, *overrides]
        if privileged:
            asked.append("--privileged")
        key = hashlib.sha256(json.dumps(asked).encode()).hexdigest()[:16]
        if key not in self.known:
            command = self.program + [
                "--policy", policy, "--scenario", scenario, "--condition", condition,
                "--episodes", str(episodes), "--seed", str(seed), "--workers", str(self.workers),
            ]
            if privileged:
                command.append("--privileged")
            for override in overrides:
                command += ["--set", override]
            run = subprocess.run(
                command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False
            )
            if run.returncode != 0:
                said = (run.stderr.strip().splitlines() or ["it said nothing"])[-1]
                raise FlightError(f"evaluate: exit status {run.returncode}: {said}")
            self.known[key] = json.loads(run.stdout.strip().splitlines()[-1])
            os.makedirs(os.path.dirname(os.path.abspath(self.file)), exist_ok=True)
            with open(self.file, "a", encoding="utf-8") as lines:
                record = {"key": key, "asked": asked, "found": self.known[key]}
                lines.write(json.dumps(record) + "\n")
        return self.known[key]
