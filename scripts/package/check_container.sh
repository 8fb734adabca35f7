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
summary=$(mktemp -d)
trap 'rm -rf "$summary"' EXIT

start=$SECONDS
# Steps in a mere chroot: no registers of processes or networks are needed for apt and a compiler.
"${podman[@]}" build --isolation chroot --network host "${from[@]}" -t stg "$root"
echo "check_container: $((SECONDS - start)) s for the image"
start=$SECONDS
"${podman[@]}" run --rm "${running[@]}" -v "$summary:/out" stg \
  run medium episodes:=1 real_time_factor:=0 gui:=false summary_file:=/out/summary.yaml
[[ -s "$summary/summary.yaml" ]]
echo "check_container: $((SECONDS - start)) s for an episode"
