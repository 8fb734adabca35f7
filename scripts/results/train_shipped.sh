#!/usr/bin/env bash
# Trains a policy in the same way as the shipped policies, in a built and sourced workspace. There are four
# runs: imitation of a privileged controller, the same with wall units, MAPPO, MAPPO with a share of
# imitation. Finished runs are not repeated. The policy is OUT/hold/policy_last.onnx. See
# docs/adr/008-privileged-teacher.md.
# Usage: train_shipped.sh SCENARIO OUT [TRAIN_OPTION ...]   e.g. train_shipped.sh medium runs/medium
set -euo pipefail
[[ "${1:-}" != -h && "${1:-}" != --help ]] || { sed -n '2,6s/^# //p' "$0"; exit; }
(($# >= 2)) || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
scenario=$1 out=$2
shift 2

# The study that flies the imitated law defines it.
studies=$(cd "$(dirname "$(readlink -f "$0")")/../../src/marl_trainer/studies" && pwd)
teacher=$(sed -n "s/^  teacher's law: \"\(.*\)\"$/\1/p" "$studies/flights/shipped.yaml")
[[ -n "$teacher" ]]
# Conditions with poor links are the hardest to learn, so they come more often.
poor=degraded_communication,combined_stress
conditions=nominal,$poor,fast_target,$poor,far_initialization,$poor,limited_sensing,$poor

# stage NAME OPTION...: makes one run, unless it is already finished.
stage() {
  local folder=$out/$1
  shift
  if grep -qs '"finished"' "$folder/summary.json"; then return; fi
  local resume=()
  if compgen -G "$folder/checkpoint_*.ckpt" >/dev/null; then resume=(--resume); fi
  rosrun marl_trainer train --scenario "$scenario" --out "$folder" --train-on "$conditions" \
    --envs 96 --horizon 100 --epochs 3 --minibatch 1600 --actor-hidden 192,192 \
    --activation relu --std-scale 0.3 --min-log-std -8 --max-log-std -2 --lr-final 0.01 \
    --validation-interval 480000 --set reward.weights.separation=0.2 \
    --set reward.separation_distance_m=0.0233 "${resume[@]}" "$@"
}
imitation=(--imitate "$teacher" --privileged-teacher true)

# The wall units need settled normalisers, so a short run comes first.
stage settle "${imitation[@]}" --imitation-steps 1000000000 --steps 1200000 --lr 2e-3 \
  --critic-lr 3e-3 --initial-log-std -4.5 "$@"
stage imitate --start-from "$out/settle" --wall-units 0.015 "${imitation[@]}" \
  --imitation-steps 1000000000 --steps 6000000 --lr 2e-3 --critic-lr 3e-3 \
  --initial-log-std -4.5 "$@"
stage return --start-from "$out/imitate" --steps 1536000 --lr 1e-4 --critic-lr 1e-3 \
  --initial-log-std -4 "$@"
stage hold --start-from "$out/return" "${imitation[@]}" --imitation-steps 1000000000 \
  --imitation-share 0.5 --imitation-focus 2 --steps 1536000 --lr 1e-4 --critic-lr 1e-3 \
  --initial-log-std -5 "$@"
echo "$out/hold/policy_last.onnx"
