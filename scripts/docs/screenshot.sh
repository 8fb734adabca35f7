#!/usr/bin/env bash
# Makes a picture of a recorded run in rviz, without a display. Needs a built and sourced workspace.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

usage() {
  cat <<'TEXT'
usage: scripts/docs/screenshot.sh [OPTIONS] OUT.png

  --bag FILE        recorded run to show (default: this program records a run of --scenario)
  --scenario NAME   scenario to record, launch/NAME.launch (default: medium)
  --seed N          seed of that run (default: 3)
  --view NAME       overview or follow (default: overview)
  --at SECONDS      moment of the recording to show (default: 1.5)
  --size WxH        size of the picture (default: 1280x800)
TEXT
}

fail() {
  echo "screenshot: $*" >&2
  exit 2
}

bag='' scenario=medium seed=3 view=overview at=1.5 size=1280x800 out=''
while (($# > 0)); do
  case "$1" in
    --bag | --scenario | --seed | --view | --at | --size)
      (($# > 1)) || fail "$1 needs a value"
      declare "${1#--}=$2"
      shift 2
      ;;
    -h | --help)
      usage
      exit 0
      ;;
    -*) fail "unknown option $1" ;;
    *)
      [[ -z "$out" ]] || fail "more than one output file"
      out=$1
      shift
      ;;
  esac
done
[[ -n "$out" ]] || { usage >&2; exit 2; }
[[ -f "$root/rviz/$view.rviz" ]] || fail "no view '$view'"
[[ "$at" =~ ^[0-9]+([.][0-9]+)?$ ]] || fail "--at: '$at' is not a number of seconds"
[[ -d "$(dirname "$out")" ]] || fail "there is no folder for $out"
[[ "$size" =~ ^[0-9]+x[0-9]+$ ]] || fail "--size: not of the form 1280x800"

work=$(mktemp -d)
pids=()
cleanup() {
  local pid
  for pid in "${pids[@]}"; do kill -INT "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap cleanup EXIT

# A ROS master of its own, so that this does not disturb another run.
port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 LIBGL_ALWAYS_SOFTWARE=1

if [[ -z "$bag" ]]; then
  bag=$work/run.bag
  echo "screenshot: recording $scenario"
  roslaunch -p "$port" stg_bringup "$scenario.launch" gui:=false episodes:=1 seed:="$seed" real_time_factor:=0 \
    record:=true bag:="$bag" >"$work/run.log" 2>&1 || true
fi
[[ -f "$bag" ]] || { tail -n 20 "$work"/*.log >&2 || true; fail "no bag $bag"; }
bag=$(readlink -f "$bag")

# The picture shows only the scene: the margin with menu and tool bar is cut off.
width=${size%x*} height=${size#*x} margin=120
/usr/bin/python3 - "$bag" "$work/scenario.yaml" <<'PYTHON'
import sys
import rosbag

with rosbag.Bag(sys.argv[1]) as bag, open(sys.argv[2], "w") as out:
    out.write(next((m.data for _, m, _ in bag.read_messages("/scenario")), "{}"))
PYTHON
"$root/src/stg_monitor/scripts/view.py" "$view" --scenario-file "$work/scenario.yaml" --write "$work/view.rviz"
sed -e "s/^  Height: .*/  Height: $((height + margin))/" -e "s/^  Width: .*/  Width: $((width + 32))/" \
  "$work/view.rviz" >"$work/shot.rviz"

# rviz needs some seconds to start. The replay starts at the beginning, so that there are trails, and
# stops at the wanted time.
rate=$(/usr/bin/python3 -c "print(max(1.0, $at / 6.0))")
roslaunch -p "$port" stg_bringup replay.launch gui:=false stay:=true bag:="$bag" \
  duration:="$at" rate:="$rate" delay:=8 >"$work/replay.log" 2>&1 &
pids+=($!)
xvfb-run -a -s "-screen 0 $((width + 32))x$((height + margin))x24" bash -c "
  rviz -d '$work/shot.rviz' >'$work/rviz.log' 2>&1 & viewer=\$!
  # Succeeds if the replay has reached the wanted time and rviz runs.
  shown() {
    grep -q 'player.*process has finished cleanly' '$work/replay.log' &&
      rosnode list 2>/dev/null | grep -q '^/rviz'
  }
  for ((tries = 0; tries < 120; ++tries)); do sleep 1; ! shown || break; done
  sleep 5
  ! shown || import -window root '$work/shot.png'
  kill \$viewer"
[[ -f "$work/shot.png" ]] || { tail -n 20 "$work"/re*.log "$work"/rviz.log >&2; fail "rviz did not show the run"; }
convert "$work/shot.png" -crop "${size}+16+62" +repage "$out"
echo "screenshot: $out"
