#!/usr/bin/env bash
# scripts/house_metrics.sh            the house in figures: longest functions, largest classes, rooms
# scripts/house_metrics.sh --check    only what is over its limit; exit code 1 when anything is
#
# A room is a folder of sources; its floors are the longest chain of its files that include one
# another, where a .cc stands on the floor of its own header or above. Lines of a function count from
# its name to its closing brace. Members and methods are what a class itself declares; a plain struct
# may have any number of fields. Needs Debian's universal-ctags.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

max_lines=60 max_lines_p95=27 max_members=10 max_methods=12 max_files=32 max_floors=4

check=0
case ${1:-} in
  '') ;;
  --check) check=1 ;;
  *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2; exit 2 ;;
esac
sources=$(find colmap_seapoint feature densify examples -name '*.h' -o -name '*.cc' | LC_ALL=C sort)

# function<TAB>lines<TAB>name<TAB>file, and class<TAB>kind<TAB>name<TAB>file<TAB>members<TAB>methods
functions_and_classes() {
  # shellcheck disable=SC2086  # names of ours hold no blank
  ctags -f - --language-force=C++ --kinds-C++=cfmps --fields=+neKs --excmd=number $sources |
    awk -F '\t' -v OFS='\t' '
      /^!/ { next }
      {
        ++n
        name[n] = $1
        file[n] = $2
        for (i = 4; i <= NF; ++i) {
          colon = index($i, ":")
          key = colon ? substr($i, 1, colon - 1) : "kind"
          value = substr($i, colon + 1)
          if (key == "kind") kind[n] = value
          if (key == "line") first[n] = value + 0
          if (key == "end") last[n] = value + 0
          if (key == "class" || key == "struct" || key == "namespace") scope[n] = value
        }
        if (kind[n] == "class" || kind[n] == "struct") {
          classes[file[n], scope[n] == "" ? $1 : scope[n] "::" $1] = n
        }
      }
      END {
        for (i = 1; i <= n; ++i) {
          if (kind[i] == "function" && last[i] > 0) {
            print "function", last[i] - first[i] + 1, name[i], file[i]
          }
          class = classes[file[i], scope[i]]
          # What is defined outside of the class was declared in it, and counted there.
          if (class == "" || first[i] > last[class]) continue
          if (kind[i] == "member") ++members[class]
          if (kind[i] == "prototype" || kind[i] == "function") ++methods[class]
        }
        for (key in classes) {
          c = classes[key]
          print "class", kind[c], name[c], file[c], members[c] + 0, methods[c] + 0
        }
      }'
}

# room<TAB>name<TAB>files<TAB>floors
rooms() {
  # shellcheck disable=SC2086
  grep -HoE '^#include "[^"]+"' $sources | sed 's/:#include "/\t/; s/"$//' |
    awk -F '\t' -v OFS='\t' -v sources="$sources" '
      function room_of(file) { sub(/\/[^\/]*$/, "", file); return file }
      function floor_of(file,    i, n, parts, level, result) {
        if (file in floors) return floors[file]
        floors[file] = 1  # guards against headers that include each other
        result = 1
        n = split(included[file], parts, " ")
        for (i = 1; i <= n; ++i) {
          level = floor_of(parts[i]) + !is_own_header(file, parts[i])
          if (level > result) result = level
        }
        return floors[file] = result
      }
      function is_own_header(file, header) {
        sub(/\.cc$/, ".h", file)
        return file == header
      }
      room_of($1) == room_of($2) { included[$1] = included[$1] " " $2 }
      END {
        n = split(sources, all, "\n")
        for (i = 1; i <= n; ++i) {
          room = room_of(all[i])
          ++files[room]
          level = floor_of(all[i])
          if (level > highest[room]) highest[room] = level
        }
        for (room in files) print "room", room, files[room], highest[room]
      }
    '
}

{ functions_and_classes; rooms; } | LC_ALL=C sort -t $'\t' -k1,1 -k2,2nr -k3 |
  awk -F '\t' -v check="$check" -v max_lines="$max_lines" -v max_lines_p95="$max_lines_p95" \
    -v max_members="$max_members" -v max_methods="$max_methods" -v max_files="$max_files" \
    -v max_floors="$max_floors" '
    function report(is_over, text) {
      failed += is_over
      if (is_over || !check) print (is_over ? "over the limit: " : "") text
    }
    $1 == "function" {  # longest first
      lines[++num_functions] = $2
      if ($2 > max_lines || (!check && num_functions <= 10)) {
        report($2 > max_lines, $3 " (" $4 "): " $2 " lines; at most " max_lines)
      }
    }
    $1 == "class" {
      is_over = $6 > max_methods || ($2 == "class" && $5 > max_members)
      is_near = $6 > max_methods - 3 || ($2 == "class" && $5 > max_members - 3)
      if (is_over || (!check && is_near)) {
        report(is_over, $2 " " $3 " (" $4 "): " $5 " members, " $6 " methods; at most " \
               max_members " and " max_methods)
      }
    }
    $1 == "room" {
      report($3 > max_files || $4 > max_floors, "room " $2 ": " $3 " files, " $4 \
             " floors; at most " max_files " and " max_floors)
    }
    END {
      if (num_functions == 0) { print "no function found: is universal-ctags there?"; exit 1 }
      p95 = lines[int(num_functions * 0.05) + 1]
      p50 = lines[int(num_functions * 0.5) + 1]
      report(p95 > max_lines_p95, num_functions " functions: median " p50 ", 95th percentile " p95 \
             " lines; at most " max_lines_p95)
      exit failed > 0
    }'
