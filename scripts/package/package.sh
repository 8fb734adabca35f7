#!/usr/bin/env bash
# ./stg package: makes the Debian packages in dist/debian and the wheel of stg in dist/ from the same build.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
base=${STG_BUILD_ROOT:-$root}
export PATH="/usr/bin:$PATH"

"$root/scripts/package/make_debian.sh"
engines=()
for build in "$base/build-package/stg-swarm-$(<"$root/VERSION")"/build/*; do
  set=$(basename "$build")
  engines+=("${set/#tmp/baseline}=$(find "$build/stg_python/devel" -name '_core.*.so')")
done
"$root/scripts/package/make_wheel.py" "${engines[@]}"
