#!/usr/bin/env bash
# Installs the Debian packages of packages.txt that are missing and makes this folder a workspace.
# Does nothing, quickly, when nothing is missing. STG_ANY_RELEASE=1: whatever the system is.
set -euo pipefail
export LC_ALL=C

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

die() {
  echo "setup: $*" >&2
  exit 1
}

# Prints the packages of packages.txt that are not installed, one a line.
missing_packages() {
  local wanted installed
  wanted=$(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$root/packages.txt" | sort -u)
  # dpkg-query fails when it has never heard of a package, which only means "not installed".
  # shellcheck disable=SC2086
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $wanted 2>/dev/null |
    awk '$2 == "installed" { print $1 }' | sort -u) || true
  comm -23 <(echo "$wanted") <(echo "$installed")
}

# The name of the system, from os-release. STG_OS_RELEASE is another such file, for tests.
# shellcheck disable=SC1090
release=$(. "${STG_OS_RELEASE:-/etc/os-release}" 2>/dev/null && echo "${ID:-unknown} ${VERSION_ID:-system}") || true
if [[ "$release" != "debian 12" && -z "${STG_ANY_RELEASE:-}" ]]; then
  die "this needs Debian 12, and here is ${release:-an unknown system}; docs/platforms.md has a" \
    "container for other systems (STG_ANY_RELEASE=1 tries all the same)"
fi
command -v dpkg-query >/dev/null || die "this needs Debian's packages (no dpkg-query here)"
mapfile -t missing < <(missing_packages)

if ((${#missing[@]} > 0)); then
  echo "setup: installing ${#missing[@]} Debian packages: ${missing[*]}"
  if ((EUID == 0)); then
    as_root=(env)
  elif command -v sudo >/dev/null; then
    as_root=(sudo env)
  else
    die "not root and no sudo; as root, run: apt-get install --no-install-recommends ${missing[*]}"
  fi
  apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600
    -o Acquire::Retries=3)
  "${apt[@]}" update || echo "setup: apt-get update failed, trying with the lists at hand" >&2
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    die "apt-get could not install all of: ${missing[*]}"
fi

toplevel=/usr/share/catkin/cmake/toplevel.cmake
if [[ "$(readlink "$root/src/CMakeLists.txt" || true)" != "$toplevel" ]]; then
  ln -sfn "$toplevel" "$root/src/CMakeLists.txt"
fi
