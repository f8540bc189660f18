#!/usr/bin/env bash
# scripts/check_tidy.sh [FILE.cc...]     clang-tidy with .clang-tidy; all of the program and its
#                                        libraries by default. Exit code 1 when it finds anything.
#
# Takes the compile commands of build/release, which must have been built. A file that passed is not
# looked at again as long as it, the headers of ours that it includes, its compile command,
# .clang-tidy and clang-tidy are the same: build/tidy/ remembers that by a hash.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/release
passed=build/tidy
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) ||
  { echo "clang-tidy is missing; scripts/setup.sh installs it" >&2; exit 1; }
[ -f $build/compile_commands.json ] || { echo "$build is missing; build the release first" >&2; exit 1; }

if [ $# -eq 0 ]; then
  mapfile -t files < <(find colmap_seapoint feature densify -name '*.cc' | LC_ALL=C sort)
else
  files=("$@")
fi
mkdir -p $passed
version=$("$tidy" --version | cat - .clang-tidy | sha256sum)
# Headers of ours by source, as the compiler found them: "source<TAB>header" a line.
includes=$passed/includes.tsv
ninja -C $build -t deps | sed "s#^    \($PWD\|[.][.]/[.][.]\)/##" | awk '
  /^[^ ].*: #deps/ { source = ""; next }
  /^ / || /^$/ { next }
  source == "" { source = $0; next }
  { print source "\t" $0 }' >$includes

# Prints a file's key; nothing when it was never compiled.
key_of() {  # FILE
  local headers
  headers=$(awk -F '\t' -v file="$1" '$1 == file { print $2 }' $includes | LC_ALL=C sort -u)
  [ -n "$headers" ] || return 0
  # shellcheck disable=SC2086  # names of ours hold no blank
  { echo "$version"; grep -F -- "-c $PWD/$1\"" $build/compile_commands.json; cat "$1" $headers; } |
    sha256sum | cut -d ' ' -f 1
}

check() {  # FILE
  local key
  key=$(key_of "$1")
  [ -z "$key" ] || [ ! -f "$passed/$key" ] || return 0
  "$tidy" -p $build --quiet "$1" 2> >(grep -v ' warnings\? generated\.$' >&2) || return 1
  [ -z "$key" ] || touch "$passed/$key"
}
export -f check key_of
export build passed tidy version includes

printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -I {} bash -c 'check "$1"' _ {}
