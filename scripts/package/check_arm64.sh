#!/usr/bin/env bash
# Compiles the cores for arm64 in a new Debian 12 with a cross compiler, and runs their unit tests with
# qemu. Needs root and mmdebstrap.
# Usage: check_arm64.sh [FOLDER [TEST ...]]
# FOLDER keeps the system and the build for the next call (default: a temporary folder). TEST is the name
# of a test program (default: all).
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
folder=${1:-}
if [[ -z "$folder" ]]; then
  folder=$(mktemp -d)
  trap 'rm -rf --one-file-system "$folder"' EXIT
fi
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
tests=("${@:2}")
new=$folder/system
export LC_ALL=C.UTF-8

if [[ ! -e "$folder/complete" ]]; then
  rm -rf --one-file-system "$new"
  libraries=(libblas3 libgeographiclib-dev libgtest-dev libgmock-dev libnetcdf-dev libonnx-dev libopenblas0-pthread
    libprotobuf-dev libyaml-cpp-dev libstdc++-12-dev)
  tools=(ccache cmake crossbuild-essential-arm64 libcli11-dev libeigen3-dev librandom123-dev libxsimd-dev ninja-build
    nlohmann-json3-dev protobuf-compiler qemu-user-static)
  include=$(printf '%s,' "${tools[@]}" "${libraries[@]/%/:arm64}")
  mirror=http://deb.debian.org/debian
  mmdebstrap --variant=apt --architectures=amd64,arm64 --include="${include%,}" bookworm "$new" \
    "deb $mirror bookworm main" "deb $mirror bookworm-updates main" "deb ${mirror%/debian}/debian-security bookworm-security main"
  mkdir -p "$new/source" "$new/build" "$new/cache"
  cat >"$new/arm64.cmake" <<'CMAKE'
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
CMAKE
  touch "$folder/complete"
fi

# inside COMMAND: runs it in the new system, with the repository at /source.
inside() {
  # shellcheck disable=SC2016
  unshare --mount --pid --fork --kill-child bash -c '
    mount --make-rprivate /
    mount -t proc proc "$0/proc" && mount -t devpts devpts "$0/dev/pts" && mount --bind "$1" "$0/source"
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 CCACHE_DIR=/cache \
      STG_SCENARIOS=/source/src/stg_bringup/scenarios chroot "$0" sh -c "$2"' \
    "$new" "$root" "$*"
}

inside "cmake -S /source -B /build -G Ninja -DCMAKE_TOOLCHAIN_FILE=/arm64.cmake -DSTG_PYTHON=OFF \
  -DCMAKE_CXX_COMPILER_LAUNCHER=ccache" >"$folder/configure.log" 2>&1 || { tail -n 30 "$folder/configure.log" >&2; exit 1; }
inside "ninja -C /build ${tests[*]:-all tests}"
# Tests start our programs by name, and the kernel does not start qemu for them. So each program is replaced
# by a shell script that does.
# shellcheck disable=SC2016
inside 'cd /build && find . -type f -perm /111 ! -name "*.so*" ! -name "*_test" ! -name "*.arm64" ! -path "*/CMakeFiles/*" |
  while read -r program; do
    [ "$(head -c 4 "$program" | tail -c 3)" = ELF ] || continue
    mv "$program" "$program.arm64"
    printf "#!/bin/sh\nexec qemu-aarch64-static %s \"\$@\"\n" "/build/$program.arm64" >"$program"
    chmod 755 "$program"
  done'
if ((${#tests[@]} == 0)); then
  mapfile -t tests < <(inside "cd /build && ctest -N" | sed -nE 's/.*gtest_(\w+)$/\1/p')
fi
failed=0
for test in "${tests[@]}"; do
  start=$SECONDS
  if inside "cd /build && qemu-aarch64-static \$(find . -name $test -type f -perm /111) --gtest_brief=1" >"$folder/$test.log" 2>&1; then
    state=passes
  else
    state="fails (log: $folder/$test.log)"
    failed=1
  fi
  echo "check_arm64: $test $state, $((SECONDS - start)) s; $(grep -E '^\[ +PASSED' "$folder/$test.log" || true)"
done
exit "$failed"
