#!/usr/bin/env bash
# Installs missing Debian packages of packages.txt and makes this folder a workspace. If nothing is missing,
# it ends quickly. STG_ANY_RELEASE=1 allows systems other than Debian 12.
set -euo pipefail
export LC_ALL=C

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

die() {
  echo "setup: $*" >&2
  exit 1
}

# Prints the packages of packages.txt that are not installed, one per line.
missing_packages() {
  local wanted installed
  wanted=$(sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$root/packages.txt" | sort -u)
  # dpkg-query fails if it does not know a package. Such a package is not installed.
  # shellcheck disable=SC2086
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $wanted 2>/dev/null |
    awk '$2 == "installed" { print $1 }' | sort -u) || true
  comm -23 <(echo "$wanted") <(echo "$installed")
}

# The name of the system, from os-release. Tests name another file in STG_OS_RELEASE.
# shellcheck disable=SC1090
release=$(. "${STG_OS_RELEASE:-/etc/os-release}" 2>/dev/null && echo "${ID:-unknown} ${VERSION_ID:-system}") || true
if [[ "$release" != "debian 12" && -z "${STG_ANY_RELEASE:-}" ]]; then
  die "this needs Debian 12, but this machine has ${release:-an unknown system}; docs/platforms.md has a" \
    "container for other systems (STG_ANY_RELEASE=1 tries it anyway)"
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
  "${apt[@]}" update || echo "setup: apt-get update failed, trying with the existing lists" >&2
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    die "apt-get could not install all of: ${missing[*]}"
fi

toplevel=/usr/share/catkin/cmake/toplevel.cmake
if [[ "$(readlink "$root/src/CMakeLists.txt" || true)" != "$toplevel" ]]; then
  ln -sfn "$toplevel" "$root/src/CMakeLists.txt"
fi
