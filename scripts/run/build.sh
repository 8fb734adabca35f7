#!/usr/bin/env bash
# Configures the workspace if necessary and builds the given targets (default: all). If STG_SANITIZE is set,
# it builds only the cores, with plain CMake and in a folder of their own.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
base=${STG_BUILD_ROOT:-$root}
sanitize=${STG_SANITIZE:-}
# The name of the folder must not contain a comma: it would split an argument for the linker.
build=$base/build${sanitize:+-${sanitize//,/-}}

# Catkin and ROS need Debian's Python, even if another one comes first on the PATH.
export PATH="/usr/bin:$PATH"

options=(
  -G Ninja
  -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
  -DSTG_WERROR=ON
)
if [[ -n "$sanitize" ]]; then
  source=$root
  options+=("-DSTG_SANITIZE=$sanitize")
  if [[ "$sanitize" == fuzz ]]; then
    # clang warns about other things than GCC, so its warnings are no errors.
    options+=(-DCMAKE_CXX_COMPILER=clang++-14 -DSTG_TESTS=OFF -DSTG_PYTHON=OFF -DSTG_WERROR=OFF)
  fi
else
  source=$root/src
  options+=(
    "-DCATKIN_DEVEL_PREFIX=$base/devel"
    "-DCMAKE_INSTALL_PREFIX=$base/install"
    -DCATKIN_ENABLE_TESTING=ON
    -DPYTHON_EXECUTABLE=/usr/bin/python3
    -DPython3_EXECUTABLE=/usr/bin/python3
  )
fi
if command -v ccache >/dev/null; then
  options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
fi
if [[ -n "${STG_MARCH:-}" ]]; then
  options+=("-DSTG_MARCH=$STG_MARCH")
fi

if [[ -n "${STG_CMAKE_OPTIONS:-}" ]]; then
  read -ra more <<<"$STG_CMAKE_OPTIONS"
  options+=("${more[@]}")
fi

# Ninja configures again when a CMake file changes, but not when there is a new package or option.
wanted=$(printf '%s\n' "${options[@]}" "$root"/src/*/package.xml)
stamp=$build/stg_configured
if [[ ! -f "$build/build.ninja" || ! -f "$stamp" || "$(<"$stamp")" != "$wanted" ]]; then
  # While it configures, catkin saves the environment of its tests, but only with folders that exist.
  # Without these folders, the tests after the first build would not find our Python messages.
  mkdir -p "$build" "$base/devel/lib/pkgconfig" "$base/devel/lib/python3/dist-packages"
  rm -f "$stamp"
  log=$build/configure.log
  echo "build: configuring (log: $log)"
  if ! cmake -S "$source" -B "$build" "${options[@]}" >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    echo "build: configuring failed" >&2
    exit 1
  fi
  printf '%s\n' "$wanted" >"$stamp"
fi

# One job per core, but at most one per 2 GiB of memory: a source with Torch needs this memory.
memory_kib=$(awk '/^MemTotal:/ { print $2 }' /proc/meminfo)
# nproc would return OMP_NUM_THREADS, which ./stg sets to 1.
jobs=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)
by_memory=$((memory_kib / (2 * 1024 * 1024)))
if ((by_memory < jobs)); then
  jobs=$((by_memory > 1 ? by_memory : 1))
fi
# Every build runs the checks of message dependencies, so these lines are removed.
ninja -C "$build" -j "$jobs" "$@" | sed -u '/genmsg_check_deps/d'
