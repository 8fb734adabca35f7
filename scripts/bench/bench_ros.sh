#!/usr/bin/env bash
# Measures the ROS graph of a built and sourced workspace and prints one line of JSON: the speed in
# lockstep with 4 and 20 AUVs, the time from detection to wrench in three runs in real time (of each run,
# and the middle one), and the largest resident memory of an agent node.
# Usage: bench_ros.sh [FILE]   also writes the JSON to FILE
# If a number is missing, the exit status is 1 and stderr has the last lines of each run.
set -euo pipefail
export LC_ALL=C.UTF-8  # JSON needs decimal points; the user's language may have commas

work=$(mktemp -d)
export ROS_HOME=$work/ros_home
# A free port, because another run may use the usual one.
port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=${ROS_IP:-127.0.0.1}
launch=
finish() {
  [[ -z "$launch" ]] || kill -INT "$launch" 2>/dev/null || true
  wait
  rm -rf "$work"
}
trap finish EXIT

# run NAME SECONDS ARGUMENTS...: starts a run of at most SECONDS. Its output goes to NAME.log.
run() {
  local name=$1 limit=$2
  shift 2
  timeout -s INT "$limit" roslaunch -p "$port" stg_bringup "$@" table:=false policy:=pursuit_separated \
    >"$work/$name.log" 2>&1 &
  launch=$!
}

finished() {
  wait "$launch" || true
  launch=
}

# figure NAME PATTERN: prints a number from the last line of the world, or null.
figure() {
  sed -n "s/.*world: [0-9]* steps in .*$2.*/\1/p" "$work/$1.log" | tail -n 1 | grep . || echo null
}
speed='s, \([0-9.]*\) x real time'
median='to wrench \([0-9.]*\) ms (median)'
tail99=', \([0-9.]*\) ms (99 %)'
misses='time, \([0-9]*\) with a deadline miss'

run four 120 medium.launch real_time_factor:=0 episodes:=6
finished
run twenty 180 medium.launch scenario:=swarm20 agents:=20 autopilot:=onboard real_time_factor:=0 episodes:=1 \
  "overrides:=[time.episode_steps=300]"
finished
live() {
  run "$1" 90 medium.launch real_time_factor:=1 episodes:=1 "overrides:=[time.episode_steps=300]"
}
live live1
sleep 20
memory=0
for process in /proc/[0-9]*; do
  # A process may end during this step.
  { mapfile -d '' -t words <"$process/cmdline"; } 2>/dev/null || continue
  command=${words[*]}
  if [[ "$command" == */stg_agent/agent* && "$command" == *"$ROS_HOME"* ]]; then
    kib=$(awk '/^VmRSS:/ { print $2 }' "$process/status" 2>/dev/null) || continue
    ((kib > memory)) && memory=$kib
  fi
done
finished
for name in live2 live3; do
  live "$name"
  finished
done

# each PATTERN: prints the number of each live run, as a list. middle PATTERN: prints the middle one.
each() {
  echo "[$(figure live1 "$1"), $(figure live2 "$1"), $(figure live3 "$1")]"
}
middle() {
  for name in live1 live2 live3; do figure "$name" "$1"; done | sort -g | sed -n 2p
}

json=$(printf '{"lockstep_4_auvs_x_real_time": %s, "lockstep_20_auvs_x_real_time": %s, ' \
  "$(figure four "$speed")" "$(figure twenty "$speed")")
json+=$(printf '"detection_to_wrench_median_ms": %s, "detection_to_wrench_p99_ms": %s, ' \
  "$(middle "$median")" "$(middle "$tail99")")
json+=$(printf '"detection_to_wrench_p99_ms_each": %s, ' "$(each "$tail99")")
json+=$(printf '"real_time_deadline_misses_each": %s, "largest_agent_memory_mib": %s, "cores": %s}' \
  "$(each "$misses")" "$(awk "BEGIN { printf \"%.1f\", $memory / 1024 }")" "$(env -u OMP_NUM_THREADS nproc)")
echo "$json"
[[ $# -eq 0 ]] || echo "$json" >"$1"
if [[ "$json" == *null* ]] || ((memory == 0)); then
  tail -n 20 "$work"/*.log >&2
  echo "bench_ros: a number is missing; see the end of each run above" >&2
  exit 1
fi
