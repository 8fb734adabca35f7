#!/usr/bin/env bash
# Builds the workspace for the processor's baseline, for packages: build_baseline.sh [TARGET ...]
# (default: all). What ./stg build makes is the other half of a package, for the instruction set that
# it was built for.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
base=${STG_BUILD_ROOT:-$root}
export PATH="/usr/bin:$PATH"
build=$base/build-package

options=(
  -G Ninja
  -DCMAKE_BUILD_TYPE=Release
  # Where Debian's catkin puts libraries below the name of the architecture.
  -DCMAKE_INSTALL_PREFIX=/usr
  -DCMAKE_SKIP_INSTALL_RPATH=ON
  "-DCATKIN_DEVEL_PREFIX=$build/devel"
  -DCATKIN_ENABLE_TESTING=OFF
  -DPYTHON_EXECUTABLE=/usr/bin/python3
  -DPython3_EXECUTABLE=/usr/bin/python3
  -DSTG_MARCH=none
)
if command -v ccache >/dev/null; then
  options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
fi
mkdir -p "$build"
if ! cmake -S "$root/src" -B "$build" "${options[@]}" >"$build/configure.log" 2>&1; then
  tail -n 40 "$build/configure.log" >&2
  exit 1
fi
ninja -C "$build" "$@" | sed -u '/genmsg_check_deps/d'
