#!/usr/bin/env bash
# Installs the wheel of dist/ in a new virtual environment, without package index, compiler and ROS, and
# runs episodes. Debian does not have gymnasium and pettingzoo. If STG_FARAMA lists folders that contain
# them, separated by colons, this also makes environments by their names in gymnasium and pettingzoo.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
alone=(env -i PATH=/usr/bin:/bin HOME="$folder" LC_ALL=C.UTF-8)
# The environment uses Debian's numpy, because pip has no index.
"${alone[@]}" python3 -m venv --system-site-packages venv
start=$SECONDS
"${alone[@]}" venv/bin/pip install --no-index "$root"/dist/stg_swarm-*.whl
"${alone[@]}" venv/bin/python -m stg.examples.random_actions
echo "check_wheel: $((SECONDS - start)) s from pip install to random_actions"
# Tries the engine that stg chooses for this processor, and the baseline engine.
for set in "" baseline; do
  "${alone[@]}" STG_INSTRUCTION_SET=$set venv/bin/python - <<'PYTHON'
import stg
print("check_wheel:", stg.INSTRUCTION_SET, stg.evaluate(stg.policy_file("medium"), "medium", episodes=4)["return"])
PYTHON
done
"${alone[@]}" venv/bin/python - <<'PYTHON'
import stg
names = stg.scenario_names()
for name in names:
    stg.parallel_env(name).reset()
short = {"time.episode_steps": 60, "time.tail_steps": 10}
flown = stg.evaluate(stg.policy_file("field"), "field", overrides=short, episodes=1)
print("check_wheel:", len(names), "scenarios start; a minute of field:", flown["return"])
PYTHON
[[ -n "${STG_FARAMA:-}" ]] || exit 0
"${alone[@]}" PYTHONPATH="$STG_FARAMA" venv/bin/python - <<'PYTHON'
import gymnasium
# gymnasium imports the module before the colon.
team = gymnasium.make("stg:stg/Team-v1", scenario="hard")
team.reset(seed=1)
team.step(team.action_space.sample())
many = gymnasium.make_vec("stg/Team-v1", num_envs=8)
many.reset(seed=1)
many.step(many.action_space.sample())
import pettingzoo, stg
from stg import swarm_v1
made = [swarm_v1.parallel_env()]
if hasattr(pettingzoo, "make"):  # 1.27
    made += [pettingzoo.make("parallel", "stg/Swarm-v1", scenario="hard"), pettingzoo.make("aec", "stg/Swarm-v1")]
for env in made:
    env.reset(seed=1)
print("check_wheel: gymnasium", gymnasium.__version__, "and pettingzoo", pettingzoo.__version__, "make", len(made) + 2)
PYTHON
