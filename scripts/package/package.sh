#!/usr/bin/env bash
# ./stg package: the wheel of stg in dist/.
set -euo pipefail

root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
base=${STG_BUILD_ROOT:-$root}
export PATH="/usr/bin:$PATH"

# engine DEVEL: the Python extension in a devel space.
engine() {
  find "$1/lib/python3/dist-packages/stg" -name '_core.*.so'
}

"$root/scripts/package/build_baseline.sh" stg_python
engines=("baseline=$(engine "$base/build-package/devel")")
if grep -q '^STG_CPU_HAS_X86_64_V3:INTERNAL=TRUE' "$base/build/CMakeCache.txt" 2>/dev/null ||
  [[ "${STG_MARCH:-}" == x86-64-v3 ]]; then
  "$root/scripts/build.sh" stg_python
  engines+=("x86-64-v3=$(engine "$base/devel")")
fi
"$root/scripts/package/make_wheel.py" "${engines[@]}"
