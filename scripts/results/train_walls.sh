#!/usr/bin/env bash
# Trains one policy over entities for several scenarios between walls and any number of AUVs, in a built and
# sourced workspace. There are three runs: imitation of a privileged controller, MAPPO, MAPPO with a share of
# imitation. A finished run is not repeated, and a stopped one goes on. The policy is
# OUT/hold/policy_last.onnx. See docs/entities.md.
# Usage: train_walls.sh SCENARIOS OUT [TRAIN_SWARM_OPTION ...]   e.g. train_walls.sh medium,hard runs/walls
set -euo pipefail
[[ "${1:-}" != -h && "${1:-}" != --help ]] || { sed -n '2,6s/^# //p' "$0"; exit; }
(($# >= 2)) || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
scenario=$1 out=$2
shift 2

# The study that flies the imitated law defines it.
studies=$(cd "$(dirname "$(readlink -f "$0")")/../../src/marl_trainer/studies" && pwd)
teacher=$(sed -n "s/^  teacher's law: \"\(.*\)\"$/\1/p" "$studies/flights/shipped.yaml")
[[ -n "$teacher" ]]

# stage NAME OPTION...: makes one run.
stage() {
  local folder=$out/$1
  shift
  local go_on=()
  if [[ -e "$folder/checkpoint.ckpt" ]]; then go_on=(--resume); fi
  if [[ ${#go_on[@]} == 0 && -n "${before:-}" ]]; then go_on=(--start-from "$before"); fi
  rosrun marl_trainer train_swarm --scenario "$scenario" --action velocity3 --out "$folder" \
    --envs 128 --horizon 40 --segment 50 --episode-steps 512 --noise-time 0 \
    --band 0 --shaping 0 --gamma 0.9 --min-log-std -8 --max-log-std -2 --critic-learning-rate 1e-3 \
    --validation-episodes 16 "${go_on[@]}" "$@"
  before=$folder
}
imitation=(--imitate "$teacher" --privileged-teacher true --imitation-steps 1000000000)
mappo=(--epochs 3 --minibatch 6400 --learning-rate 1e-4 --grad-clip 5 --target-kl 0.05)

stage imitate "${imitation[@]}" --steps 3072000 --epochs 1 --minibatch 1600 --learning-rate 2e-3 \
  --last-learning-rate 2e-5 --log-std -4.5 "$@"
stage return "${mappo[@]}" --steps 1536000 --last-learning-rate 1e-5 --log-std -4 "$@"
stage hold "${imitation[@]}" --imitation-share 0.5 --imitation-focus 2 "${mappo[@]}" --steps 1536000 \
  --last-learning-rate 1e-6 --log-std -5 "$@"
echo "$out/hold/policy_last.onnx"
