#!/usr/bin/env bash
# Installs a finished build into an empty folder and uses it as an outsider would: the program, its
# man page and completion, and both libraries through find_package.
#   install_test.sh BUILD_FOLDER EXAMPLES_FOLDER CXX
set -euo pipefail
build=$1 examples=$2 compiler=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
prefix=$folder/prefix
export LC_ALL=C.UTF-8

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

cmake --install "$build" --prefix "$prefix" >"$folder/install.log" 2>&1 ||
  fail "cmake --install: $(tail -n 5 "$folder/install.log")"
program=$prefix/bin/colmap_seapoint
"$program" version | grep -q '^colmap_seapoint [0-9]' || fail "version"
"$program" help --format man | cmp - "$prefix/share/man/man1/colmap_seapoint.1" ||
  fail "the man page is not what the program says"
"$program" help --format bash |
  cmp - "$prefix/share/bash-completion/completions/colmap_seapoint" ||
  fail "the completion is not what the program says"
[ -s "$prefix/share/doc/colmap-seapoint/copyright" ] || fail "no licence"

# Every public header stands alone, with what find_package gives.
cp -r "$examples" "$folder/user"
include=$prefix/include/colmap_seapoint
(cd "$include" && find . -name '*.h' | sort | sed 's|^\./\(.*\)$|#include "\1"|') \
  >"$folder/user/all_headers.cc"
headers=$(wc -l <"$folder/user/all_headers.cc")
[ "$headers" -ge 25 ] && [ "$headers" -le 32 ] || fail "$headers public headers"
cat >>"$folder/user/CMakeLists.txt" <<'END'
add_library(all_headers OBJECT all_headers.cc)
target_link_libraries(all_headers PRIVATE colmap_seapoint::feature colmap_seapoint::densify
  colmap_seapoint::colmap colmap_seapoint::cloud colmap_seapoint::pipeline)
END
cmake -S "$folder/user" -B "$folder/user_build" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release >"$folder/configure.log" 2>&1 ||
  fail "find_package: $(cat "$folder/configure.log")"
cmake --build "$folder/user_build" --parallel 2 >"$folder/build.log" 2>&1 ||
  fail "build: $(cat "$folder/build.log")"
if grep -rqF "$(cd "$(dirname "$examples")/.." && pwd)" "$prefix/lib" --include='*.cmake'; then
  fail "the installed CMake files lead back into the source folder"
fi

"$build/bin/demo_survey" generate --output_path "$folder/survey" --num_strips 1 \
  --images_per_strip 3 --width 680 --height 512 >/dev/null 2>&1 || fail "demo_survey"
first=$(find "$folder/survey/images" -name '*.jpg' | sort | head -n 1)
"$folder/user_build/show_seapoints" "$first" "$folder/drawn.png" >"$folder/out" || fail "show_seapoints"
grep -Eq '^[0-9]{4} SeaPoints, each with 256 bits' "$folder/out" || fail "$(cat "$folder/out")"
[ -s "$folder/drawn.png" ] || fail "nothing is drawn"
"$folder/user_build/densify_model" "$folder/survey/images" "$folder/survey/truth/sparse" \
  "$folder/cloud.ply" >"$folder/out" || fail "densify_model: $(cat "$folder/out")"
# The program and the library make the same cloud.
"$program" partial_densifier --image_path "$folder/survey/images" --input_path \
  "$folder/survey/truth/sparse" --output_path "$folder/dense" 2>/dev/null || fail "partial_densifier"
"$folder/user_build/reconstruct_folder" "$folder/survey/images" "$folder/workspace" \
  >"$folder/reconstructed" || fail "reconstruct_folder"
grep -q '^3 of 3 pictures used' "$folder/reconstructed" || fail "$(cat "$folder/reconstructed")"
# Each library alone, with what only it needs.
for component in feature densify colmap cloud pipeline; do
  printf 'cmake_minimum_required(VERSION 3.16)\nproject(one LANGUAGES CXX)\n%s\n%s\n%s\n' \
    "find_package(colmap_seapoint REQUIRED COMPONENTS $component)" \
    "file(WRITE \${CMAKE_BINARY_DIR}/one.cc \"int main() {}\")" \
    "add_executable(one \${CMAKE_BINARY_DIR}/one.cc)
target_link_libraries(one PRIVATE colmap_seapoint::$component)" >"$folder/CMakeLists.txt"
  cmake -S "$folder" -B "$folder/one_$component" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_CXX_COMPILER="$compiler" >"$folder/configure.log" 2>&1 &&
    cmake --build "$folder/one_$component" >"$folder/build.log" 2>&1 ||
    fail "$component alone: $(cat "$folder/configure.log" "$folder/build.log")"
done
of_library=$(sed 's/ .*//' "$folder/out")
of_program=$(sed -n 's/^element vertex //p;/^end_header/q' "$folder/dense/fused.ply")
echo "points: library $of_library, program $of_program"
[ "$of_library" -gt 100000 ] || fail "too few points"
difference=$((of_library > of_program ? of_library - of_program : of_program - of_library))
[ $((difference * 1000)) -lt "$of_program" ] || fail "another cloud than the program's"
