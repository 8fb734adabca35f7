"""Stand-ins for the programs train, evaluate and bench_env. They write the same files, at once."""

import os
import stat

METRICS = [
    *("return", "tail_distance", "tracking_error", "lost_rate", "action_norm", "saturation_rate"),
    *("control_cost", "communication_quality", "band_rate", "colliding_pairs"),
    *("tail_colliding_pairs", "min_separation", "time_to_band", "mean_error", "whole_lost_rate"),
    *("reward_track", "reward_observation", "reward_coordination", "reward_communication"),
    *("reward_semantic", "reward_separation"),
]

COMMON = f"""#!/usr/bin/python3
import hashlib, json, math, os, random, signal, sys, time
METRICS = {METRICS!r}
HERE = os.path.dirname(os.path.abspath(__file__))

def seed_by(path, *more):
    # The folder of a test has another name in every run; what lies in it has not.
    random.seed(" ".join([os.path.relpath(path, HERE), *more]))

def option(name, default=None):
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else default

with open(os.path.join(HERE, "calls"), "a") as calls:
    calls.write(os.path.basename(__file__) + " " + " ".join(sys.argv[1:]) + "\\n")
with open(os.path.join(HERE, "parents"), "a") as parents:
    parents.write(str(os.getppid()) + "\\n")
if any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK")):
    sys.exit("this stub is taken for a rank")

def sample(quality, noise):
    values = {{name: 0.5 + 0.01 * noise for name in METRICS}}
    values["return"] = -200.0 + 1240.0 * quality + 8.0 * noise
    values["tail_distance"] = 0.013 + 0.9 * (1.0 - quality) + 0.0005 * noise
    values["tracking_error"] = 0.003 + 0.9 * (1.0 - quality) + 0.0002 * noise
    values["mean_error"] = 0.012 + 0.7 * (1.0 - quality) + 0.0005 * noise
    values["lost_rate"] = values["whole_lost_rate"] = max(0.0, 0.6 - quality)
    values["saturation_rate"] = values["control_cost"] = 0.02 * (1.0 - quality)
    values["colliding_pairs"] = values["tail_colliding_pairs"] = min(6.0, abs(2.0 + noise))
    return values

LEVEL = {{"stg": 0.99, "semantic": 0.85, "velocity3": 0.8, "tau6": 0.9}}
"""

TRAIN = (
    COMMON
    + """
out, steps, seed = option("--out"), int(option("--steps", 1000)), int(option("--seed"))
level = LEVEL[option("--variant", "stg")]
config = os.path.join(out, "config.json")
if "--resume" not in sys.argv and os.path.exists(config):
    sys.exit("holds another run")
seed_by(out)
os.makedirs(out, exist_ok=True)
algorithm = option("--algorithm", "mappo")
open(config, "w").write(json.dumps({"algorithm": algorithm, "gamma": 0.9, "lr": 0.003}))
if os.environ.get("STUB_FAIL", "none") in out:
    sys.exit("this stub fails")

def stop(number, frame):
    open(os.path.join(out, "checkpoint_000000000001.ckpt"), "w").write("x")
    sys.exit(130)

signal.signal(signal.SIGINT, stop)
if "STUB_SLEEP" in os.environ and "--resume" not in sys.argv:
    open(os.path.join(out, "sleeping"), "w").write("x")
    time.sleep(float(os.environ["STUB_SLEEP"]))
interval = int(option("--validation-interval", max(1, steps // 20)))
with open(os.path.join(out, "progress.csv"), "w") as csv:
    names = ["validation_" + name for name in METRICS + ["scenario_return"]]
    csv.write(",".join(["env_steps", "wall_seconds", "validation_seconds"] + names) + "\\n")
    speed = 3.0 + random.random()
    for at in range(interval // 2, steps + 1, interval // 2):
        cells = [str(at), str(at / 1e4), "0.1"]
        if at % interval:
            cells += [""] * len(names)
        else:
            quality = level * (1.0 - math.exp(-speed * 4.0 * at / steps))
            values = sample(quality, random.gauss(0, 1))
            values["scenario_return"] = values["return"] + 1.0
            cells += [f"{value:.9g}" for value in values.values()]
        csv.write(",".join(cells) + "\\n")
open(os.path.join(out, "policy_best.onnx"), "w").write(f"{level} {seed}")
summary = {"stopped": "finished", "env_steps": steps, "wall_seconds": 12.5,
           "env_steps_per_second": steps / 12.5,
           "time_to_threshold": {"no_loss": {"seconds": 3.0, "env_steps": 9}, "1000": None,
                                 "1030": None if option("--algorithm") == "madqn" else
                                         {"seconds": 50.0 + 20.0 * seed, "env_steps": 9}},
           "parameters": {"actor": 1000, "critic": 234}, "update_flops_per_env_step": 2.5e6,
           "best_validation": {"return": 1041.5}, "update_gflops": 20.0,
           "peak_sgemm_gflops": 80.0,
           "phase_seconds": {"environment": 2.5, "inference": 2.5, "update": 7.5}}
open(os.path.join(out, "summary.json"), "w").write(json.dumps(summary))
"""
)

EVALUATE = (
    COMMON
    + """
policy, csv, count = option("--policy"), option("--csv"), int(option("--episodes"))
quality = float(open(policy).read().split()[0]) if policy.endswith(".onnx") else 0.97
quality -= {"nominal": 0.0, "combined_stress": 0.05}.get(option("--condition"), 0.02)
if policy == "idle":
    quality = 0.2
first = int(option("--seed"))
seed_by(policy, option("--condition"), str(first))
rows = [sample(quality, random.gauss(0, 1)) for _ in range(count)]
with open(csv, "w") as file:
    file.write(",".join(["episode", "seed"] + METRICS + ["training_return"]) + "\\n")
    for e, row in enumerate(rows):
        row["training_return"] = row["return"] - 1.0
        values = [f"{row[name]:.9g}" for name in METRICS + ["training_return"]]
        file.write(",".join([str(e), str(first + e)] + values) + "\\n")
reporting = 5000000 <= first and first + count <= 6000000
summary = {"seed_block": "reporting" if reporting else "choosing"}
for name in METRICS + ["training_return"]:
    values = [row[name] for row in rows]
    mean = sum(values) / count
    summary[name] = mean
    summary[name + "_std"] = (sum((v - mean) ** 2 for v in values) / max(1, count - 1)) ** 0.5
print("some text before the object")
print(json.dumps(summary))
"""
)

BENCH_ENV = (
    COMMON
    + """
result = {"env_steps_per_second": 1000.0 * int(option("--workers")),
          "agent_steps_per_second": 4000.0 * int(option("--workers"))}
if "--scaling" in sys.argv:
    result["scaling"] = [{"agents": 100, "env_steps_per_second": 7.0, "ns_per_agent_step": 1e9}]
print("some text before the object")
print(json.dumps(result))
"""
)


def write_stubs(folder):
    """Puts the programs into `folder`."""
    for name, text in (("train", TRAIN), ("evaluate", EVALUATE), ("bench_env", BENCH_ENV)):
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)


def calls(folder):
    """Returns the command lines with which the stubs were started, and forgets them."""
    path = os.path.join(folder, "calls")
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    os.remove(path)
    return lines
