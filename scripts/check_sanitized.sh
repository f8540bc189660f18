#!/usr/bin/env bash
# scripts/check_sanitized.sh files   memory and undefined behaviour: the unit tests of what reads
#                                    files, and the parsers on damaged ones; part of scripts/test.sh --all
# scripts/check_sanitized.sh asan    the same and the unit tests of tracks, remeasuring, feature and
#                                    densify; a quarter of an hour, for after a change there and
#                                    before a release
# scripts/check_sanitized.sh tsan    threads: the unit tests of what runs on several; some minutes,
#                                    for once a week
#
# Exit code 1 at the first part that a sanitizer complains of.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-}
tests=() targets=()
case $preset in
  files | asan)
    tests=(base_test system_test io_test)
    [ "$preset" = files ] || tests+=(tracks_test remeasuring_test feature_test densify_test)
    preset=asan
    targets=(parser_fuzz_targets)
    # Whole surveys, whole pairs and golden hashes are for the plain build: here they would take
    # minutes.
    export GTEST_FILTER='-*VersionTest.*:DensifySequenceTest.*:StereoSequenceTest.*:DensifyPairTest.*:TriangulateMatchesTest.*'
    ;;
  tsan)
    tests=(base_test system_test feature_test densify_test adjustment_test remeasuring_test)
    # One pair's survey after the other on one thread has nothing to race.
    export GTEST_FILTER='-*VersionTest.*:*BendBack'
    ;;
  *)
    sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2
    exit 2
    ;;
esac
# Without halt_on_error what is undefined is printed, and the test passes.
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export LSAN_OPTIONS="suppressions=$PWD/tests/library_leaks.supp print_suppressions=0"
export TSAN_OPTIONS="halt_on_error=1 suppressions=$PWD/tests/uninstrumented_libraries.supp"

cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" --target "${tests[@]}" "${targets[@]}"
# Each program in as many parts as there are cores, so that the longest does not run alone.
cores=$(nproc)
for shard in $(seq 0 $((cores - 1))); do printf "$shard %s\n" "${tests[@]}"; done |
  GTEST_TOTAL_SHARDS=$cores xargs -P "$cores" -L 1 bash -c '
    export GTEST_SHARD_INDEX=$1
    build/"$0"/bin/"$2" --gtest_brief=1 || { echo "$2 failed under $0" >&2; exit 1; }' "$preset"
[ ${#targets[@]} -eq 0 ] || ctest --preset "$preset" --label-regex '^parsers$' --parallel "$cores"
