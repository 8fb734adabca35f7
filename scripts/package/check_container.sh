#!/usr/bin/env bash
# Builds the image of the Containerfile with podman and runs an episode in it.
# Usage: check_container.sh [BASE]
# BASE is an image that replaces the one named in the Containerfile. Without access to a registry, make one:
# `mmdebstrap --variant=minbase bookworm base.tar && podman import base.tar localhost/debian:12`.
# STG_PODMAN has options of podman, such as --runtime runc; STG_PODMAN_RUN has options of podman run.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
read -ra podman <<<"podman ${STG_PODMAN:-}"
read -ra running <<<"${STG_PODMAN_RUN:-}"
from=()
[[ -z "${1:-}" ]] || from=(--from "$1")

# stop SENTENCE: ends with a sentence on what this machine cannot do.
stop() {
  echo "check_container: $*" >&2
  exit 1
}

command -v podman >/dev/null || stop "there is no podman here"
summary=$(mktemp -d)
trap 'rm -rf "$summary"' EXIT

start=$SECONDS
# The steps run in a chroot: apt and a compiler need no namespaces for processes and networks.
"${podman[@]}" build --isolation chroot --network host "${from[@]}" -t stg "$root" ||
  stop "podman could not build the image here, as it says above"
echo "check_container: $((SECONDS - start)) s for the image"
# Some machines can build images but start no container, e.g. because of mixed control groups or fixed limits.
"${podman[@]}" run --rm "${running[@]}" --entrypoint /bin/true stg ||
  stop "podman can build an image here, but cannot start a container, as it says above; STG_PODMAN='--runtime runc' and STG_PODMAN_RUN may help"
start=$SECONDS
"${podman[@]}" run --rm "${running[@]}" -v "$summary:/out" stg \
  run medium episodes:=1 real_time_factor:=0 gui:=false summary_file:=/out/summary.yaml
[[ -s "$summary/summary.yaml" ]]
echo "check_container: $((SECONDS - start)) s for an episode"
