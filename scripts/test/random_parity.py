#!/usr/bin/python3
"""Flies random scenarios in the graph in lockstep and in the environment, which must not differ.

Each draw is a shipped scenario with some keys changed, a controller, a seed and an autopilot. The
test of parity (src/stg_bringup/test/parity_test.cpp) compares two episodes of it. What the loader
refuses counts as refused. Needs `./stg build` and `./stg build stg_bringup_parity_test`.
"""

import argparse
import collections
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEVEL = pathlib.Path(os.environ.get("STG_BUILD_ROOT", ROOT)) / "devel"
TEST = """<launch>
  <include file="{root}/launch/medium.launch">
    <arg name="scenario" value="{file}" />
    <arg name="agents" value="{agents}" />
    <arg name="policy" value="{policy}" />
    <arg name="autopilot" value="{autopilot}" />
    <arg name="seed" value="{seed}" />
    <arg name="real_time_factor" value="0" />
    <arg name="deadline" value="20" />
    <arg name="required" value="false" />
    <arg name="table" value="false" />
  </include>
  <param name="/world/wait_for_node" value="/parity" />
  <test test-name="parity_drawn" pkg="stg_bringup" type="stg_bringup_parity_test" name="parity"
        time-limit="120">
    <param name="seed" value="{seed}" />
    <param name="policy" value="{policy}" />
  </test>
</launch>
"""
BASES = (
    "medium hard physical two_targets medium_release medium_separated field field12 field20 fig6_8 "
    "utracking"
).split()
OF_SEA = ("field", "fig6", "utracking")
CONTROLLERS = ("pursuit", "pursuit_separated", "encircle", "idle")
MOTIONS = ("constant_velocity", "coordinated_turn", "legs", "random_waypoint", "evasive")
MODEMS = ("ideal", "micromodem_fsk_r0", "micromodem_psk_r1", "janus", "evologics_s2c")
ACCESS = ("periodic", "tdma", "aloha", "slotted_aloha", "csma")
# Possible values of a key: a choice, or a number between two limits. Lengths are scaled with the scenario.
CHOICES = {
    "target.motion": MOTIONS,
    "reset.stage": ("easy", "medium", "hard"),
    "vehicle.integrator": ("semi_implicit", "rk4"),
    "vehicle.fully_actuated.added_mass_coriolis": ("full", "no_munk", "off"),
    "control.heading": ("free", "along_velocity"),
    "navigation.kind": ("perfect", "dead_reckoning"),
    "channel.physical.modem.profile": MODEMS,
    "channel.physical.modem.queue": ("newest", "fifo"),
    "channel.physical.propagation.paths": (1, 3, 8),
    "channel.physical.water.sound_speed": ("mackenzie", "profile"),
    "channel.physical.water.absorption": ("thorp", "francois_garrison"),
    "observation.order": ("nearest", "index"),
    "observation.graph": (True, False),
    "reward.kind": ("paper", "release", "release_raw"),
    "sensing.bearing.ambiguous": (True, False),
}
NUMBERS = {
    "control.smoothing": (0.0, 0.9),
    "control.max_delta": (0.0, 0.6),
    "disturbance.force_std_n": (0.0, 5.0),
    "sensing.detection_probability": (0.0, 1.0),
    "sensing.range.outlier_probability": (0.0, 0.5),
    "sensing.range.false_alarm_probability": (0.0, 0.5),
    "sensing.range.field_of_view_deg": (30.0, 360.0),
    "sensing.bearing.bearing_std_deg": (0.5, 20.0),
    "navigation.dead_reckoning.heading_std_deg": (0.0, 10.0),
    "channel.physical.noise.burst_every_s": (1.0, 20.0),
    "channel.physical.noise.site_db": (0.0, 110.0),
    "channel.contention.rest_s": (0.0, 3.0),
    "channel.slots.length_s": (1.0, 8.0),
    "channel.extended.sound_speed_mps": (100.0, 1500.0),
    "reward.weights.separation": (0.0, 2.0),
    "reward.terms.effort.weight": (0.0, 1.0),
    "track.measurements.memory_s": (1.0, 60.0),
    "track.neighbour_max_age_s": (0.5, 20.0),
}
# Sections of things: the key that chooses the thing, and the names of the things that read the section.
THINGS = {
    "channel.physical": ("channel.model", ("physical",)),
    "channel.extended": ("channel.model", ("extended",)),
    "channel.periodic": ("channel.access", ("periodic",)),
    "channel.slots": ("channel.access", ("tdma", "slotted_aloha")),
    "channel.contention": ("channel.access", ("aloha", "csma")),
    "navigation.dead_reckoning": ("navigation.kind", ("dead_reckoning",)),
    "sensing.position": ("sensing.sensor", ("position",)),
    "sensing.range": ("sensing.sensor", ("range",)),
    "sensing.bearing": ("sensing.sensor", ("bearing",)),
    "track.measurements": ("track.filter", ("measurements",)),
}
LENGTHS = {
    "sensing.range_m": (0.2, 1.5),
    "sensing.position.noise_std_m": (0.0, 0.1),
    "sensing.range.range_std_m": (0.005, 0.2),
    "sensing.cue_std_m": (0.0, 1.5),
}


def draw(seed):
    """Returns (scenario as a tree, controller, autopilot, seed of its first episode)."""
    r = random.Random(seed)
    base = r.choice(BASES)
    scale = 1000.0 if base.startswith(OF_SEA) or base == "physical" else 1.0
    steps = r.choice((1, 2, 20, 50))
    keys = {"time.episode_steps": steps, "time.tail_steps": r.randint(1, steps)}
    for key in r.sample(sorted(CHOICES), r.randint(1, 6)):
        keys[key] = r.choice(CHOICES[key])
    for table, factor in ((NUMBERS, 1.0), (LENGTHS, scale)):
        for key in r.sample(sorted(table), r.randint(0, 4)):
            keys[key] = round(factor * r.uniform(*table[key]), 5)
    if r.random() < 0.5:
        keys["sensing.sensor"] = r.choice(("position", "range", "bearing", "range_bearing"))
        keys["track.filter"] = "measurements"
    if r.random() < 0.5:
        keys["channel.model"] = r.choice(("range", "extended", "physical"))
        keys["channel.access"] = r.choice(ACCESS) if keys["channel.model"] == "physical" else ACCESS[0]
    if base.startswith(OF_SEA) and r.random() < 0.5:
        keys["vehicle.models"] = r.choices(("torpedo", "kinematic"), k=r.randint(1, 3))
    agents = r.randint(2, 6)
    keys["target.count"] = r.randint(1, 2)
    if r.random() < 0.3:  # with long decisions
        keys.update({"time.decision_steps": r.choice((20, 60, 120)), "sensing.period_s": 0.0,
                     "channel.periodic.transmit_period_s": 120.0})
    if keys.get("channel.model") == "range":
        keys["channel.range_m"] = 0.45 * scale
    if "reward.weights.separation" in keys:
        keys["reward.separation_distance_m"] = 0.024 * scale
    for section, (chooser, names) in THINGS.items():
        if keys.get(chooser) not in names:  # keys that nothing reads would be refused
            keys = {k: v for k, v in keys.items() if not k.startswith(section + ".")}
    if keys.get("channel.physical.modem.profile") == "ideal":  # it receives whatever the noise is
        heard = ("channel.physical.noise.", "channel.physical.propagation.", "channel.physical.water.absorption")
        keys = {k: v for k, v in keys.items() if not k.startswith(heard)}
    if base.startswith(OF_SEA):
        unread = ["vehicle.fully_actuated.added_mass_coriolis", "control.heading"]
        model = "kinematic" if base == "utracking" else "torpedo"
        if set(keys.get("vehicle.models", [model])) == {"kinematic"}:
            unread += ["vehicle.integrator", "disturbance.force_std_n"]
        keys = {k: v for k, v in keys.items() if k not in unread}
    tree = {"base": f"{base}.yaml", "name": "drawn", "agents": agents}
    for key, value in keys.items():
        *sections, last = key.split(".")
        at = tree
        for section in sections:
            at = at.setdefault(section, {})
        at[last] = value
    first = r.choice((0, 7, r.randrange(1_000_000), 2**31 - 2))
    return tree, r.choice(CONTROLLERS), r.choice(("external", "onboard")), first


def run(*command):
    """Runs a command in the built workspace; returns (exit status, output)."""
    shell = f"source '{DEVEL}/setup.bash'; export PATH=/usr/bin:$PATH ROS_IP=127.0.0.1; exec \"$@\""
    done = subprocess.run(["bash", "-c", shell, "-", *command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, check=False)
    return done.returncode, done.stdout


def fly(seed, folder):
    """Flies one draw in a folder. Returns its result and its last output."""
    tree, controller, autopilot, first = draw(seed)
    file = folder / "drawn.yaml"
    file.write_text(yaml.safe_dump(tree, default_flow_style=None), encoding="utf-8")
    evaluate = str(DEVEL / "lib" / "marl_trainer" / "evaluate")
    status, output = run(evaluate, "--policy", controller, "--scenario", str(file),
                         "--seed", str(first), "--episodes", "2")
    if status:
        return "refused", output.strip().splitlines()[0]
    test = folder / "drawn.test"
    test.write_text(TEST.format(root=ROOT, file=file, agents=tree["agents"], seed=first,
                                policy=controller, autopilot=autopilot), encoding="utf-8")
    package = ROOT / "src" / "stg_bringup"
    status, output = run("rostest", "--package=stg_bringup", f"--pkgdir={package}", str(test))
    (folder / "output.txt").write_text(output, encoding="utf-8")
    return ("differs", f"see {folder}") if status else ("same", "")


def main():
    """Flies the draws; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0, help="of the first draw; each later one adds 1")
    arguments = parser.parse_args()
    if arguments.draws < 1:
        parser.error("--draws: at least 1")
    for program in ("marl_trainer/evaluate", "stg_bringup/stg_bringup_parity_test"):
        if not (DEVEL / "lib" / program).exists():
            parser.error(f"{DEVEL / 'lib' / program} is not built; see the head of this file")
    counts = collections.Counter()
    for seed in range(arguments.seed, arguments.seed + arguments.draws):
        folder = pathlib.Path(tempfile.mkdtemp(prefix=f"parity_{seed}_"))
        verdict, words = fly(seed, folder)
        counts[verdict] += 1
        print(f"draw {seed}: {verdict} {words}", flush=True)
        if verdict != "differs":
            shutil.rmtree(folder)
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return 1 if counts["differs"] else 0


if __name__ == "__main__":
    sys.exit(main())
