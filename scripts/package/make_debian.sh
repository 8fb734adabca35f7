#!/usr/bin/env bash
# Makes the Debian packages in dist/debian, a folder that apt can read. Copies the files that git knows to a
# folder below build-package/ and builds there. The folder is always the same, so that ccache finds its
# results again.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
base=${STG_BUILD_ROOT:-$root}
export PATH="/usr/bin:$PATH"
out=$root/dist/debian
version=$(<"$root/VERSION")
above=$base/build-package
copy=$above/stg-swarm-$version

rm -rf "$copy" "$above"/*.deb "$above"/stg-swarm_*
mkdir -p "$copy" "$out"
touch "$above/CATKIN_IGNORE"
git -C "$root" ls-files -z | (cd "$root" && tar --create --null --files-from=-) |
  tar --extract --directory="$copy"

options=()
if command -v ccache >/dev/null; then
  options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
fi
log=$above/debian.log
echo "package: building for baseline and x86-64-v3 (log: $log)"
# No debug symbols: they would be ten times as large as the rest.
if ! (cd "$copy" && env -u OMP_NUM_THREADS STG_CMAKE_OPTIONS="${options[*]}" \
  DEB_BUILD_OPTIONS="noautodbgsym ${DEB_BUILD_OPTIONS:-}" \
  dpkg-buildpackage --no-sign --build=full) >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "package: dpkg-buildpackage failed" >&2
  exit 1
fi
rm -f "$out"/*
find "$above" -maxdepth 1 -type f \( -name '*.deb' -o -name "stg-swarm_$version*" \) -exec mv -t "$out" {} +
(cd "$out" && apt-ftparchive packages . >Packages && gzip -kn9 Packages &&
  apt-ftparchive -o APT::FTPArchive::Release::Suite=stg release . >Release)
echo "package: $out; to install from it:"
echo "  echo 'deb [trusted=yes] file:$out ./' > /etc/apt/sources.list.d/stg.list"
echo "  apt update && apt install stg-swarm"
