#!/usr/bin/env bash
# Runs the benchmarks of a built and sourced workspace; called by `./stg bench`.
set -euo pipefail

rosrun marl_trainer bench_env --scenario medium_release --seconds 3 "$@"
