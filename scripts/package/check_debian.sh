#!/usr/bin/env bash
# Installs the packages of dist/debian in a new Debian 12 without a compiler, and runs the programs. Then
# it upgrades and purges the packages and checks that no file is left. Needs root, mmdebstrap and lintian.
# Usage: check_debian.sh [MIRROR]
# It measures downloads separately. If STG_BASE names a tar file of a Debian 12, it uses this system.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
mirror=${1:-http://deb.debian.org/debian}
index=$root/dist/debian
policy=/usr/share/stg_bringup/policies/medium.onnx
work=$(mktemp -d)
new=$work/new

say() {
  echo "check_debian: $*"
}

# inside COMMAND: runs it in the new system. All processes that it starts end with it.
inside() {
  local net=()
  [[ -n "${WITH_NET:-}" ]] || net=(--net)
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --kill-child "${net[@]}" bash -c '
    mount --make-rprivate /
    mount -t proc proc "$0/proc" && mount -t tmpfs tmpfs "$0/dev/shm" 2>/dev/null || true
    mount --bind "$1" "$0/srv/stg"
    ip link set lo up 2>/dev/null || true
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
      STG_INSTRUCTION_SET="$3" chroot "$0" sh -c "cd /root && $2"' "$new" "$index" "$*" "${STG_INSTRUCTION_SET:-}"
}

# timed NAME COMMAND ...: prints how long the command took, and its processor time.
timed() {
  local name=$1 TIMEFORMAT='%R %U %S'
  shift
  { time "$@" >"$work/log" 2>&1; } 2>"$work/time" || { tail -n 40 "$work/log" >&2; say "failed: $name"; exit 1; }
  say "$(awk '{ printf "%6.1f s (processor: %5.1f s)", $1, $2 + $3 }' "$work/time")  $name"
}

# repeat_as VERSION: makes packages with the same files and another version, to test an upgrade.
repeat_as() {
  local package folder=$work/repacked
  mkdir -p "$work/next"
  for package in "$index"/*.deb; do
    rm -rf "$folder"
    dpkg-deb -R "$package" "$folder"
    sed -i -e "s/^Version: .*/Version: $1/" -e "s/(= $(<"$root/VERSION"))/(= $1)/g" "$folder/DEBIAN/control"
    dpkg-deb -Zgzip -z1 --root-owner-group -b "$folder" "$work/next" >/dev/null
  done
  (cd "$work/next" && apt-ftparchive packages . >Packages)
}

files() {
  (cd "$new" && find . -xdev \( -path ./proc -o -path ./root -o -path ./srv -o -path ./tmp -o -path ./var/cache -o \
    -path ./var/lib/apt -o -path ./var/lib/dpkg -o -path ./var/log \) -prune -o -print | sort)
}

trap 'rm -rf --one-file-system "$work"' EXIT
needed=(lintian)
[[ -n "${STG_BASE:-}" ]] || needed+=(mmdebstrap)
for tool in "${needed[@]}"; do
  if ! command -v "$tool" >/dev/null; then
    echo "check_debian: there is no $tool here; apt-get install $tool" >&2
    exit 1
  fi
done
if ! lintian --fail-on error --tag-display-limit 0 "$index"/*.changes >"$work/lintian" 2>&1; then
  grep '^E:' "$work/lintian" >&2
  say "lintian found errors"
  exit 1
fi
say "lintian: no errors, $(grep -c '^W:' "$work/lintian" || true) warnings"

sources=("deb $mirror bookworm main" "deb $mirror bookworm-updates main"
  "deb ${mirror%/debian}/debian-security bookworm-security main")
mkdir -p "$new"
if [[ -n "${STG_BASE:-}" ]]; then
  timed "a new Debian 12 ($STG_BASE)" tar -xf "$STG_BASE" -C "$new"
  printf '%s\n' "${sources[@]}" >"$new/etc/apt/sources.list"
else
  timed "a new Debian 12 (mmdebstrap; downloads)" mmdebstrap --variant=apt bookworm "$new" "${sources[@]}"
fi
mkdir -p "$new/srv/stg"
echo "127.0.0.1 localhost $(hostname)" >"$new/etc/hosts"
cp /etc/resolv.conf "$new/etc/resolv.conf" 2>/dev/null || true
for settings in /etc/apt/apt.conf.d/*proxy*; do
  [[ ! -e "$settings" ]] || cp "$settings" "$new/etc/apt/apt.conf.d/"
done
echo 'deb [trusted=yes] file:/srv/stg ./' >"$new/etc/apt/sources.list.d/stg.list"
files >"$work/before"

install="apt-get install -y --no-install-recommends -o Acquire::Retries=3 stg-swarm"
WITH_NET=1 timed "apt-get update (downloads)" inside apt-get update
WITH_NET=1 timed "packages of Debian (downloads)" inside "$install --download-only"
timed "apt-get install" inside "$install"
timed "roslaunch stg_bringup medium.launch, one episode" inside \
  roslaunch stg_bringup medium.launch episodes:=1 real_time_factor:=0 summary_file:=/root/summary.yaml
[[ -s "$new/root/summary.yaml" ]]
inside "! which cc gcc g++ c++ clang make ninja"
# The launcher refuses an instruction set that the processor does not have.
sets=(baseline)
! STG_INSTRUCTION_SET=x86-64-v3 inside "rosrun marl_trainer evaluate --help" >/dev/null 2>&1 || sets+=(x86-64-v3)
for set in "${sets[@]}"; do
  STG_INSTRUCTION_SET=$set inside \
    "rosrun marl_trainer evaluate --policy $policy --scenario medium --episodes 10 --seed 3000" 2>/dev/null | tail -n 1 >"$work/$set.json"
  say "return on $set: $(python3 -c 'import json, sys; print(repr(json.load(sys.stdin)["return"]))' <"$work/$set.json")"
  cp "$work/$set.json" "$root/dist/evaluate-$set.json"
done
# Recommended packages are not installed. So this finds programs that import a module without a dependency.
# shellcheck disable=SC2016
timed "the help of every command line" inside 'cd /usr/lib && for program in acoustic_channel/*.py acoustic_channel/simulate \
  auv_dynamics/c[hr]*_* marl_trainer/* stg_bringup/* stg_monitor/*report.py stg_monitor/view.py; do
    case $program in *_node) continue ;; esac
    timeout 60 $program --help </dev/null >/dev/null || { echo "$program --help fails"; exit 1; }
  done'
timed "python3 -m stg.examples.random_actions" inside python3 -m stg.examples.random_actions
timed "an episode in the field, recorded, and its report" inside "roslaunch stg_bringup field.launch episodes:=1 \
  real_time_factor:=0 record:=true bag:=/root/field.bag overrides:='[time.episode_steps=60,time.tail_steps=10]' && \
  rosrun stg_monitor report.py /root/field.bag --out /root/field.html"
[[ -s "$new/root/field.html" ]]
timed "twelve seconds over emulated modems" inside "roslaunch stg_bringup sea.launch episodes:=1 \
  summary_file:=/root/sea.json overrides:='[time.episode_steps=12,time.tail_steps=4]'"
[[ -s "$new/root/sea.json" ]]
timed "a search, flown by the graph" inside "roslaunch stg_bringup field.launch task:=search episodes:=1 \
  real_time_factor:=0 overrides:='[time.episode_steps=60,time.tail_steps=10]'"
timed "an episode over bathymetry" inside "rosrun marl_trainer evaluate --policy encircle --scenario field20 --episodes 1 \
  --set time.episode_steps=20 --set time.tail_steps=10"
timed "training" inside "rosrun marl_trainer train --scenario medium_separated --steps 20000 --out /root/run"
timed "the acoustic network alone" inside \
  "rosrun acoustic_channel simulate /usr/share/acoustic_channel/networks/survey.yaml --out /root/network"

# A user's library, compiled with the installed headers, for the instruction set of the programs here.
compiler="apt-get install -y --no-install-recommends -o Acquire::Retries=3 stg-dev g++ pkg-config"
march=
[[ "${sets[*]}" != *x86-64-v3 ]] || march=-march=x86-64-v3
WITH_NET=1 timed "a compiler (downloads)" inside "$compiler --download-only"
timed "apt-get install stg-dev and a compiler" inside "$compiler"
timed "a plugin, compiled and flown" inside "g++ -std=c++17 -O2 -ffp-contract=off -fno-tree-slp-vectorize $march -fPIC -shared -o liborbit.so \
  /usr/share/stg_bringup/examples/controller/orbit.cpp \$(pkg-config --cflags --libs stg_env) && \
  rosrun marl_trainer evaluate --plugin ./liborbit.so --policy orbit --scenario medium --episodes 1"

next=$(<"$root/VERSION")+next
repeat_as "$next"
index=$work/next
# apt shall read only our packages, because there is no network.
timed "apt-get upgrade to $next" inside "apt-get -o Dir::Etc::SourceList=/dev/null update && apt-get -y upgrade"
inside "dpkg-query -W -f '\${Package} \${Version}\n'" | grep -E '^(stg-|python3-stg)' >"$work/versions"
[[ "$(grep -c "$next\$" "$work/versions")" == "$(wc -l <"$work/versions")" ]] || { cat "$work/versions" "$work/log"; exit 1; }
timed "an episode after the upgrade" inside roslaunch stg_bringup medium.launch episodes:=1 real_time_factor:=0
timed "apt-get purge" inside "apt-get purge -y --autoremove '^stg-' python3-stg g++ pkg-config"
files >"$work/after"
left=$(comm -13 "$work/before" "$work/after" | grep -E 'stg|auv_|acoustic_|marl_' || true)
[[ -z "$left" ]] || { say "left behind: $left"; exit 1; }
say "no file of ours is left; files left by Debian's packages: $(comm -13 "$work/before" "$work/after" | wc -l)"
