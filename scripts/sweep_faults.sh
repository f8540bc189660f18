#!/usr/bin/env bash
# scripts/sweep_faults.sh [STRIDE]    a fault at every system call of six commands, or at every
#                                     STRIDE-th; an hour on two cores, for before a release
#
# Runs on the release build (tests/faults/fault_sweep.h says what is checked); the suite itself
# takes a part of the calls. One command a core at a time; ends with a line of figures a command,
# and with exit code 1 when anything did not hold.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
stride=${1:-1}
commands=(automatic_reconstructor feature_extractor partial_densifier cloud_comparer model_scaler
  exhaustive_matcher)
logs=build/fault_sweep

cmake --preset release >/dev/null
cmake --build --preset release --target fault_sweep
mkdir -p $logs
export stride logs
status=0
printf '%s\n' "${commands[@]}" | xargs -P "$(nproc)" -I {} bash -c '
  build/release/bin/fault_sweep "$1" "$stride" >"$logs/$1.log" 2>&1' _ {} || status=1
for command in "${commands[@]}"; do
  grep '^  ' "$logs/$command.log" || true
  tail -n 1 "$logs/$command.log"
done
exit $status
