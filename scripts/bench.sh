#!/usr/bin/env bash
# Runs the benchmarks of a built and sourced workspace; called by `./stg bench`.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
exec /usr/bin/python3 "$here/bench.py" "$@"
