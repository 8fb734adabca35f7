#!/usr/bin/python3
"""Libraries of others: every program finds what they add, from every place that can name them."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import roslib.packages
import stg

FOLDER = (
    pathlib.Path(os.environ["CMAKE_PREFIX_PATH"].split(":")[0]).parent
    / "build/marl_trainer/examples/plugins"
)
SHORT = ("--set", "time.episode_steps=60", "--set", "time.tail_steps=20")


def library(name):
    """Returns the path of an example's library."""
    return str(FOLDER / f"lib{name}.so")


def run(package, program, *arguments, **options):
    """Runs a program of the suite; returns (status, standard output, standard error)."""
    (path,) = roslib.packages.find_node(package, program)
    done = subprocess.run(
        [path, *map(str, arguments)], capture_output=True, text=True, timeout=120.0, **options
    )
    return done.returncode, done.stdout, done.stderr


def evaluate(*arguments, **options):
    """Returns the metrics of a short evaluation, of `pursuit` unless the arguments name another policy."""
    given = arguments if "--policy" in arguments else ("--policy", "pursuit", *arguments)
    status, output, errors = run(
        "marl_trainer", "evaluate", "--episodes", 2, "--workers", 1, *SHORT, *given, **options
    )
    assert status == 0, errors
    return json.loads(output.splitlines()[-1])


SIMULATION = """\
plugins: [{library}]
duration_s: 200
seed: 1
channel: {{model: soft_range, range_m: 100, access: periodic, periodic: {{transmit_period_s: 1}}, soft_range: {{steepness: {steepness}}}}}
nodes:
  - {{id: 0, position_m: [0, 0, -10]}}
  - {{id: 1, position_m: [60, 0, -10]}}
traffic:
  - {{source: 0, kind: periodic, period_s: 1, bytes: 8}}
"""

# By library: its scenario, the choice of the thing, its key with a value, another value of it, and a
# metric on which the key has an effect.
KINDS = {
    "tracked": ("medium", {"navigation.kind": "tracked"},
                ("navigation.tracked.std_m", 0.01), 0.1, "return"),
    "last_seen": ("field", {"track.filter": "last_seen", "sensing.sensor": "position"},
                  ("track.last_seen.speed_std_mps", 0.5), 1.0, "nees"),
    "forecast": ("deep", {"localization.kind": "forecast"},
                 ("localization.forecast.std_mps", 0.1), 0.3, "navigation_nees"),
    "slow_fsk": ("physical", {"channel.physical.modem.profile": "slow_fsk",
                              "channel.physical.modem.slow_fsk.source_level_db": 140},
                 ("channel.physical.modem.slow_fsk.bit_rate_bps", 600.0), 4000.0, "return"),
    "unicycle": ("medium", {"vehicle.model": "unicycle"},
                 ("control.autopilot.unicycle.turn_first_rad", 0.1), 1.0, "return"),
}  # fmt: skip


def as_yaml(keys):
    """Returns {"a.b": value} as the text of a file."""
    tree = {}
    for path, value in keys.items():
        *sections, key = path.split(".")
        branch = tree
        for section in sections:
            branch = branch.setdefault(section, {})
        branch[key] = value
    return "".join(f"{section}: {json.dumps(part)}\n" for section, part in tree.items())


class Plugins(unittest.TestCase):
    """The examples, as libraries."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, text):
        """Writes a file of the test's folder and returns its path."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def test_a_scenario_names_its_library(self):
        zigzag = ("--plugin", library("zigzag"), "--set", "target.motion=zigzag")
        by_option = evaluate(*zigzag, "--set", "target.zigzag.leg_s=3")
        self.assertNotEqual(by_option["return"], evaluate(*zigzag)["return"], "the key has effect")
        path = self.write(
            "own.yaml",
            f"base: medium.yaml\nplugins: [{library('zigzag')}]\nname: medium\n"
            "target: {motion: zigzag, zigzag: {leg_s: 3}}\n",
        )
        by_file = evaluate("--scenario", path)
        self.assertEqual(by_file["return"], by_option["return"])
        self.assertEqual(by_file["scenario_hash"], by_option["scenario_hash"])
        os.symlink(library("zigzag"), self.folder / "libbeside.so")
        path.write_text(path.read_text().replace(library("zigzag"), "libbeside.so"))
        self.assertEqual(evaluate("--scenario", path)["return"], by_option["return"])

    def test_controller_reward_and_sensor(self):
        slow, fast = (
            evaluate("--plugin", library("orbit"), "--policy", f"orbit:speed={speed}")["return"]
            for speed in (0.0, 0.05)
        )
        self.assertNotEqual(slow, fast)
        # A controller of somebody else may read any number of the observation.
        evaluate("--plugin", library("orbit"), "--policy", "orbit", "--set", "observation.error_scale_m=2")
        term = ("--plugin", library("station_keeping"))
        weight = ("--set", "reward.terms.station_keeping.weight=0.2")
        self.assertLess(evaluate(*term, *weight)["return"], evaluate()["return"])
        evaluate("--plugin", library("sonar"), "--set", "sensing.sensor=sonar",
                 "--set", "mode=acoustic", "--set", "sensing.sonar.near_std_m=0.01")

    def test_a_vehicle_flies_with_its_autopilot(self):
        model = ("--plugin", library("unicycle"), "--set", "vehicle.model=unicycle")
        usual, slow = (evaluate(*model, "--set", f"vehicle.unicycle.lag_s={lag}") for lag in (2, 20))
        self.assertNotEqual(usual["return"], slow["return"], "the key has effect")
        turning = evaluate(*model, "--set", "control.autopilot.course_gain_ps=0.1")
        self.assertNotEqual(turning["return"], usual["return"], "the autopilot reads its key")
        path = self.write(
            "own.yaml",
            f"base: medium.yaml\nplugins: [{library('unicycle')}]\nname: medium\n"
            "vehicle: {model: unicycle, unicycle: {lag_s: 20}}\n",
        )
        by_file = evaluate("--scenario", path)
        self.assertEqual(by_file["return"], slow["return"])
        self.assertEqual(by_file["scenario_hash"], slow["scenario_hash"])

    def test_a_reward_term_and_a_medium_access_read_their_keys(self):
        term = ("--plugin", library("station_keeping"), "--set",
                "reward.terms.station_keeping.weight=0.2")
        half = evaluate(*term, "--set", "reward.terms.station_keeping.full_share=0.5")
        self.assertNotEqual(half["return"], evaluate(*term)["return"])
        lottery = ("--plugin", library("lottery"), "--set", "channel.access=lottery")
        often, seldom = (evaluate(*lottery, "--set", f"channel.lottery.mean_s={mean}")
                         for mean in (0.5, 8))
        self.assertNotEqual(often["return"], seldom["return"])

    def test_a_file_an_option_and_python_set_a_key_alike(self):
        for name, (scenario, choice, (key, value), other, metric) in KINDS.items():
            with self.subTest(name):
                keys = {**choice, key: value}
                plugin = ("--scenario", scenario, "--plugin", library(name))
                by_option, changed = (
                    evaluate(*plugin, *(f"--set={k}={v}" for k, v in {**keys, key: x}.items()))
                    for x in (value, other)
                )
                self.assertNotEqual(by_option[metric], changed[metric], "the key has effect")
                path = self.write("own.yaml", f"base: {scenario}.yaml\nname: {scenario}\n"
                                  f"plugins: [{library(name)}]\n{as_yaml(keys)}")  # fmt: skip
                by_file = evaluate("--scenario", path)
                stg.load_plugin(library(name))
                short = {"time.episode_steps": 60, "time.tail_steps": 20}
                by_python = stg.evaluate("pursuit", scenario, episodes=2, overrides={**keys, **short})
                for same in (by_file, by_python):
                    self.assertEqual(same[metric], by_option[metric])
                self.assertEqual(by_file["scenario_hash"], by_option["scenario_hash"])
                with self.assertRaisesRegex(stg.UserError, key):
                    stg.load_scenario(scenario, overrides={**keys, key: -1.0})

    def test_an_algorithm_trains_and_what_it_wrote_flies(self):
        out = self.folder / "run"
        status, output, errors = run(
            "marl_trainer", "train", "--plugin", library("hill_climbing"), "--plugin",
            library("zigzag"), "--algorithm", "hill_climbing", "--step", 0.1, "--steps", 400,
            "--envs", 4, "--horizon", 50, "--validation-episodes", 2, "--workers", 1, "--out", out,
            "--set", "target.motion=zigzag", *SHORT)
        self.assertEqual(status, 0, output + errors)
        saved = (out / "scenario.yaml").read_text()
        self.assertIn(library("zigzag"), saved.splitlines()[0], "the saved scenario names it")
        evaluate("--scenario", out / "scenario.yaml", "--policy", out / "policy_best.onnx")

    def test_the_network_alone(self):
        shares = []
        for steepness in (1, 30):
            text = SIMULATION.format(library=library("soft_range"), steepness=steepness)
            path = self.write("network.yaml", text)
            status, output, errors = run(
                "acoustic_channel", "simulate", path, "--out", self.folder / "out", "--quiet")
            self.assertEqual(status, 0, errors)
            shares.append(json.loads(output.splitlines()[-1])["delivered"])
        self.assertLess(shares[0], 180)
        self.assertGreater(shares[1], 195)

    def test_python(self):
        overrides = {"target.motion": "zigzag", "target.zigzag.leg_s": 7.0}
        stg.load_plugin(library("zigzag"))
        stg.load_plugin(library("zigzag"))  # this adds nothing a second time
        scenario = stg.load_scenario("medium", overrides=overrides)
        self.assertEqual(scenario["target.zigzag.leg_s"], 7.0)
        again = stg.Scenario.from_yaml(scenario.to_yaml())
        self.assertEqual(again.hash, scenario.hash)
        text = scenario.to_yaml().replace(library("zigzag"), library("lottery"))
        with self.assertRaisesRegex(stg.UserError, "text:1: plugins: .*liblottery.so: is not loaded"):
            stg.Scenario.from_yaml(text)  # such a text may come from a bag
        stg.load_plugin(library("unicycle"))
        unicycle = {"vehicle.model": "unicycle", "vehicle.unicycle.lag_s": 2.0}
        self.assertIn("lag_s: 2", stg.load_scenario("medium", overrides=unicycle).to_yaml())
        with self.assertRaisesRegex(stg.UserError, "vehicle.unicycle.lag_s"):
            stg.load_scenario("medium", overrides={**unicycle, "vehicle.unicycle.lag_s": -1.0})
        flights = [stg.evaluate("pursuit", "medium", episodes=1, seed=3000, overrides={
            **unicycle, "vehicle.unicycle.lag_s": lag, "time.episode_steps": 60,
            "time.tail_steps": 20}) for lag in (2.0, 20.0)]  # fmt: skip
        self.assertNotEqual(flights[0]["return"], flights[1]["return"])
        with self.assertRaisesRegex(stg.UserError, "cannot open shared object file"):
            stg.load_plugin("/nonexistent/libmine.so")

    def test_what_cannot_be_loaded_is_refused_by_file_and_line(self):
        path = self.write("own.yaml", "base: medium.yaml\n\nplugins: [libnowhere.so]\n")
        text = self.write("libtext.so", "no library\n")
        source = self.write("other.cpp", 'extern "C" const char* stg_plugin_built_for() '
                            '{ return "0.9 with 4 lanes"; }\n'
                            'extern "C" void stg_plugin_register() {}\n')
        other, twice = self.folder / "libother.so", self.folder / "libtwice.so"
        subprocess.run(["g++", "-shared", "-fPIC", source, "-o", other], check=True)
        twice.write_bytes(pathlib.Path(library("zigzag")).read_bytes())
        libcore = next(iter(stg_libraries("libauv_common.so")))
        for arguments, expected in (
                (("--scenario", path), f"{path}:3: plugins: libnowhere.so: cannot open"),
                (("--plugin", text), "libtext.so: file too short|invalid ELF header"),
                (("--plugin", other), "was built for version 0.9 with 4 lanes, this program is"),
                (("--plugin", library("zigzag"), "--plugin", twice),
                 "libtwice.so: target motion: 'zigzag' is registered twice"),
                (("--plugin", libcore), "has no block STG_PLUGIN"),
                (("--set", "plugins=zigzag"), "plugins: expected a list of libraries")):
            status, _, errors = run("marl_trainer", "evaluate", "--policy", "idle", *arguments)
            self.assertNotEqual(status, 0)
            self.assertRegex(errors, expected)


def stg_libraries(name):
    """Yields the suite's libraries of this name in the workspaces that are sourced."""
    for folder in os.environ["CMAKE_PREFIX_PATH"].split(":"):
        path = pathlib.Path(folder) / "lib" / name
        if path.exists():
            yield path


if __name__ == "__main__":
    unittest.main()
