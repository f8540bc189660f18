#!/usr/bin/env bash
# scripts/check_tidy.sh [FILE.cc...]     clang-tidy with .clang-tidy; all of the program and its
#                                        libraries by default. Exit code 1 when it finds anything.
#
# Takes the compile commands of build/release, which must have been built. The files are read in
# packs, as if they were one, since most of the time goes into the headers that all of them include. A
# pack that passed is not looked at again as long as its files, the headers of ours that they include,
# their compile commands, .clang-tidy and clang-tidy are the same: build/tidy/ remembers that by a hash.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/release
passed=build/tidy
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) ||
  { echo "clang-tidy is missing; scripts/setup.sh installs it" >&2; exit 1; }
[ -f $build/compile_commands.json ] || { echo "$build is missing; build the release first" >&2; exit 1; }

if [ $# -eq 0 ]; then
  # Those that this machine compiles: what an optional library is missing for is not among them.
  mapfile -t files < <(sed -n "s#^ *\"file\": \"$PWD/\(.*\)\".*#\1#p" $build/compile_commands.json |
    grep -E '^(colmap_seapoint|feature|densify)/' | LC_ALL=C sort -u)
else
  files=("$@")
fi
mkdir -p $passed
# Without the precompiled headers, which are another compiler's.
sed 's/-Winvalid-pch -include [^ ]*//' $build/compile_commands.json >$passed/compile_commands.json
version=$("$tidy" --version | cat - .clang-tidy | sha256sum)
# Headers of ours by source, as the compiler found them: "source<TAB>header" a line.
includes=$passed/includes.tsv
ninja -C $build -t deps | sed "s#^    \($PWD\|[.][.]/[.][.]\)/##" | awk '
  /^[^ ].*: #deps/ { source = ""; next }
  /^ / || /^$/ { next }
  source == "" { source = $0; next }
  { print source "\t" $0 }' >$includes

# A pack a line, file names with blanks between: files whose unnamed namespaces declare no name twice.
# What is compiled once for each vector unit stays alone.
make_packs() {  # FILE...
  awk -v most=12 '
    function names_of(line,   found) {  # what the first line of a declaration declares
      sub(/\/\/.*/, "", line)
      if (line !~ /=/ || line ~ /\(/) sub(/[({].*/, "", line)
      if (line ~ /^using /) sub(/ =.*/, "", line)
      found = ""
      gsub(/ *(=|;|\[|$)/, " @", line)
      while (match(line, /[A-Za-z_][A-Za-z_0-9]* @/)) {
        found = found " " substr(line, RSTART, RLENGTH - 2)
        line = substr(line, RSTART + RLENGTH)
      }
      return found
    }
    FNR == 1 { inside = 0; files[++n] = FILENAME }
    /foreach_target/ { alone[n] = 1 }
    /^namespace [{]/ { inside = 1; next }
    /^[}]/ { if (/namespace/) inside = 0; next }
    inside && (/^[A-Za-z]/ && !/^template/ || /^ +k[A-Z][A-Za-z]* = /) {
      declared[n] = declared[n] names_of($0)
    }
    END {
      for (i = 1; i <= n; ++i) {
        count = split(declared[i], names, " ")
        for (p = 1; p <= packs; ++p) {
          fits = !alone[i] && size[p] < most
          for (k = 1; fits && k <= count; ++k) fits = !((p, names[k]) in taken)
          if (fits) break
        }
        if (p > packs) packs = p
        size[p] = alone[i] ? most : size[p] + 1
        for (k = 1; k <= count; ++k) taken[p, names[k]] = 1
        members[p] = members[p] (members[p] == "" ? "" : " ") files[i]
      }
      for (p = 1; p <= packs; ++p) print members[p]
    }' "$@"
}

# Prints a pack's key; nothing when one of its files was never compiled.
key_of() {  # FILE...
  local file headers
  for file in "$@"; do
    headers=$(awk -F '\t' -v file="$file" '$1 == file { print $2 }' $includes | LC_ALL=C sort -u)
    [ -n "$headers" ] || return 0
    # shellcheck disable=SC2086  # names of ours hold no blank
    { echo "$version"; grep -F -- "-c $PWD/$file\"" $passed/compile_commands.json; cat "$file" $headers; } |
      sha256sum
  done | sha256sum | cut -d ' ' -f 1
}

tidy_one() {  # FILE
  "$tidy" -p $passed --quiet "$1" 2> >(grep -v ' warnings\? generated\.$' >&2)
}

# All files of a pack as one, with what any of them is compiled with.
tidy_as_one() {  # FILE...
  local pack file status=0
  pack=$(mktemp -d "$PWD/$passed/pack_XXXXXX")
  printf "#include \"$PWD/%s\"\n" "$@" >"$pack/all.cc"
  local flags
  flags=$(for file in "$@"; do grep -F -- "-c $PWD/$file\"" $passed/compile_commands.json; done |
    sed 's/^ *"command": "[^ ]*c++ //; s/ -o .*//; s/-isystem /-isystem/g; s/ -Wshadow//' |
    tr ' ' '\n' | awk '!seen[$0]++' | tr '\n' ' ')
  printf '[{"directory": "%s", "file": "%s", "command": "c++ %s -c %s"}]\n' \
    "$PWD/$build" "$pack/all.cc" "$flags" "$pack/all.cc" >"$pack/compile_commands.json"
  "$tidy" -p "$pack" --quiet --config-file=.clang-tidy --checks=-bugprone-suspicious-include \
    --header-filter='/(colmap_seapoint|feature|densify)/[^ ]*\.(h|cc)$' "$pack/all.cc" \
    2>/dev/null || status=1
  rm -rf "$pack"
  return $status
}

# A pack that does not compile as one, or in which something was found, is halved.
check() {  # FILE...
  local key status=0 half=$(($# / 2))
  key=$(key_of "$@")
  [ -z "$key" ] || [ ! -f "$passed/$key" ] || return 0
  if [ $# -eq 1 ]; then
    tidy_one "$1" || status=1
  elif ! tidy_as_one "$@" >/dev/null; then
    check "${@:1:half}" || status=1
    check "${@:half + 1}" || status=1
  fi
  [ $status -ne 0 ] || [ -z "$key" ] || touch "$passed/$key"
  return $status
}
export -f check key_of tidy_one tidy_as_one
export build passed tidy version includes

make_packs "${files[@]}" | xargs -P "$(nproc)" -I {} bash -c 'check $1' _ {}
