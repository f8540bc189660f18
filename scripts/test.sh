#!/usr/bin/env bash
# scripts/test.sh [--all] [CTEST_OPTION...]
#
# The gate: installs what is missing, then checks the formatting, builds the release with warnings as
# errors and runs every test; with --all also clang-tidy, and the unit tests of what reads files under
# sanitizers. Stops at the first part that fails. Prints how long each took.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

parts=gate
[ "${1:-}" != --all ] || { parts=all; shift; }

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

scripts/setup.sh --gate
part "formatting" check_format
part "build, warnings are errors" build_release
part "tests" ctest --preset release --parallel "$(nproc)" "$@"
if [ $parts = all ]; then
  part "clang-tidy" scripts/check_tidy.sh
  part "files under ASan and UBSan" scripts/check_sanitized.sh files
fi
echo "== all passed: $SECONDS s" >&2
