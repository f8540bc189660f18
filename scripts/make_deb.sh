#!/usr/bin/env bash
# Builds the Debian packages: colmap-seapoint (the program) and libcolmap-seapoint-dev.
#   scripts/make_deb.sh [OUTPUT_FOLDER]     default: build/deb
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
output=$(realpath -m "${1:-build/deb}")

scripts/setup.sh
build=build/package
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSEAPOINT_TESTS=OFF >/dev/null
cmake --build "$build"
mkdir -p "$output"
(cd "$build" && cpack -B "$output" >/dev/null)
rm -rf "$output/_CPack_Packages"
ls -1 "$output"/*.deb
