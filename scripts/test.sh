#!/usr/bin/env bash
# scripts/test.sh [CTEST_OPTION...]
#
# The gate: installs what is missing, then checks the formatting, builds the release with warnings as
# errors, runs every test, clang-tidy, and the unit tests of the core under sanitizers. Stops at the
# first part that fails. Prints how long each took.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

part() {  # NAME COMMAND...
  local name=$1 start=$SECONDS
  shift
  echo "== $name" >&2
  "$@" || { echo "== $name: failed" >&2; exit 1; }
  echo "== $name: $((SECONDS - start)) s" >&2
}

check_format() {
  local tool
  tool=$(command -v clang-format-14 || command -v clang-format)
  find colmap_seapoint feature densify examples tests '(' -name '*.cc' -o -name '*.h' ')' -print0 |
    xargs -0 "$tool" --dry-run --Werror
}

build_release() {
  cmake --preset release -DSEAPOINT_WERROR=ON >/dev/null
  cmake --build --preset release
}

run_sanitized() {  # ROOM...
  local tests=("${@/%/_test}")
  cmake --preset asan >/dev/null
  cmake --build --preset asan --target "${tests[@]}"
  # Whole surveys, whole pairs and golden hashes are for the plain build: here they would take minutes.
  export GTEST_FILTER='-*VersionTest.*:DensifySequenceTest.*:StereoSequenceTest.*:DensifyPairTest.*:TriangulateMatchesTest.*'
  # Each program in as many parts as there are cores, so that the longest does not run alone.
  local shards cores
  cores=$(nproc)
  for shards in $(seq 0 $((cores - 1))); do printf "$shards %s\n" "${tests[@]}"; done |
    GTEST_TOTAL_SHARDS=$cores xargs -P "$cores" -L 1 bash -c '
      export GTEST_SHARD_INDEX=$0
      build/asan/bin/"$1" --gtest_brief=1 || { echo "$1 failed under the sanitizers" >&2; exit 1; }'
}

scripts/setup.sh --gate
part "formatting" check_format
part "build, warnings are errors" build_release
part "tests" ctest --preset release --parallel "$(nproc)" "$@"
part "clang-tidy" scripts/check_tidy.sh
part "core under ASan and UBSan" run_sanitized base system io feature densify mapping
echo "== all passed: $SECONDS s" >&2
