#!/usr/bin/env bash
# Builds the image of the Containerfile with podman and flies an episode in it: check_container.sh [BASE],
# BASE being an image to build on instead of the Containerfile's (a registry need not be in reach:
# `mmdebstrap --variant=minbase bookworm base.tar && podman import base.tar localhost/debian:12`).
# STG_PODMAN holds options of podman, as --runtime runc; STG_PODMAN_RUN those of podman run.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
read -ra podman <<<"podman ${STG_PODMAN:-}"
read -ra running <<<"${STG_PODMAN_RUN:-}"
from=()
[[ -z "${1:-}" ]] || from=(--from "$1")

# stop SENTENCE: what the machine does not offer.
stop() {
  echo "check_container: $*" >&2
  exit 1
}

command -v podman >/dev/null || stop "there is no podman here"
summary=$(mktemp -d)
trap 'rm -rf "$summary"' EXIT

start=$SECONDS
# Steps in a mere chroot: no registers of processes or networks are needed for apt and a compiler.
"${podman[@]}" build --isolation chroot --network host "${from[@]}" -t stg "$root" ||
  stop "podman could not build the image here, as it says above"
echo "check_container: $((SECONDS - start)) s for the image"
# Some machines build, and start nothing: of control groups of two kinds, or of limits that cannot be raised.
"${podman[@]}" run --rm "${running[@]}" --entrypoint /bin/true stg ||
  stop "podman builds, but starts no container here, as it says above; STG_PODMAN='--runtime runc' and STG_PODMAN_RUN may help"
start=$SECONDS
"${podman[@]}" run --rm "${running[@]}" -v "$summary:/out" stg \
  run medium episodes:=1 real_time_factor:=0 gui:=false summary_file:=/out/summary.yaml
[[ -s "$summary/summary.yaml" ]]
echo "check_container: $((SECONDS - start)) s for an episode"
