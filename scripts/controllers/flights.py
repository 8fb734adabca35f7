"""Flights of `evaluate` that tuning and tables share, each flown once and kept in a file."""

import hashlib
import json
import os
import subprocess

CONDITIONS = (
    "nominal", "fast_target", "far_initialization", "limited_sensing", "degraded_communication",
    "strong_current", "combined_stress",
)
# So much noise at the site that no frame is recognised.
SILENCE = ("channel.noise.site_db=200.0",)


class Flights:
    """Evaluations by what was asked; a run that is started again goes on where it ended."""

    def __init__(self, file, evaluate="evaluate", workers=1):
        self.file, self.workers = file, workers
        self.program = [evaluate] if os.sep in evaluate else ["rosrun", "marl_trainer", evaluate]
        self.known = {}
        if os.path.exists(file):
            with open(file, encoding="utf-8") as lines:
                for line in lines:
                    flight = json.loads(line)
                    self.known[flight["key"]] = flight["found"]

    def fly(self, policy, scenario, condition, episodes, seed, overrides=()):
        """Returns the metrics of `evaluate`: means, and standard deviations as <name>_std."""
        asked = [policy, scenario, condition, episodes, seed, *overrides]
        key = hashlib.sha256(json.dumps(asked).encode()).hexdigest()[:16]
        if key not in self.known:
            command = self.program + [
                "--policy", policy, "--scenario", scenario, "--condition", condition,
                "--episodes", str(episodes), "--seed", str(seed), "--workers", str(self.workers),
            ]
            for override in overrides:
                command += ["--set", override]
            run = subprocess.run(
                command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
            )
            self.known[key] = json.loads(run.stdout.strip().splitlines()[-1])
            os.makedirs(os.path.dirname(os.path.abspath(self.file)), exist_ok=True)
            with open(self.file, "a", encoding="utf-8") as lines:
                record = {"key": key, "asked": asked, "found": self.known[key]}
                lines.write(json.dumps(record) + "\n")
        return self.known[key]
