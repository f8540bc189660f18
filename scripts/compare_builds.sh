#!/usr/bin/env bash
# scripts/compare_builds.sh [--sets NAME,NAME...] [--output_path DIR] OLD_BUILD NEW_BUILD
#
# Whether two builds of this project give the same bytes. Each *_BUILD is a build folder with
# bin/colmap_seapoint. Runs both on the same sets, one after the other, and compares clouds
# (fused.ply, fused.ply.vis), models, depth and normal maps, pairs.csv without its seconds, and the
# database's rows without its hashes and fingerprints. Prints a line a set with the CPU seconds of
# both; exits 1 at the first difference of any set. What the old build gave is kept in DIR and not
# computed again. Sets: demo, hybrid, rig, 12mp, and, where the evaluation data is there
# (SEAPOINT_DATA, default ../shared/data), t3 and fountain.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sets=demo,hybrid,rig,12mp,t3,fountain
output=$PWD/build/compare_builds
while [ $# -gt 2 ]; do
  case $1 in
    --sets) sets=$2; shift 2 ;;
    --output_path) output=$2; shift 2 ;;
    *) break ;;
  esac
done
if [ $# -ne 2 ]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2
  exit 2
fi
absolute() { case $1 in /*) echo "$1" ;; *) echo "$called_from/$1" ;; esac; }
old=$(absolute "$1")
new=$(absolute "$2")
output=$(absolute "$output")
data=${SEAPOINT_DATA:-$PWD/../shared/data}
mkdir -p "$output/sets"

survey() {  # NAME OPTION...: makes a demo survey, prints its folder
  local folder=$output/sets/$1
  shift
  if [ ! -f "$folder/complete" ]; then
    "$old/bin/demo_survey" generate --output_path "$folder" "$@" >&2
    touch "$folder/complete"
  fi
  echo "$folder"
}

# A set's pictures as if each second one had been taken by the right camera of a rig.
rig_pictures() {  # IMAGES FOLDER
  local i=0 picture
  mkdir -p "$2/left" "$2/right"
  for picture in "$1"/*; do
    if [ $((i % 2)) -eq 0 ]; then cp "$picture" "$2/left/$(printf %04d.jpg $((i / 2)))"
    else cp "$picture" "$2/right/$(printf %04d.jpg $((i / 2)))"; fi
    i=$((i + 1))
  done
}

reconstruct() {  # BUILD IMAGES WORKSPACE OPTION...
  local build=$1 images=$2 workspace=$3 status=0
  shift 3
  "$build/bin/colmap_seapoint" automatic_reconstructor --log_level 1 --image_path "$images" \
    --workspace_path "$workspace" "$@" >/dev/null || status=$?
  [ "$status" -eq 0 ] || [ "$status" -eq 3 ]
}

make_set() {  # NAME
  case $1 in
    demo) survey demo ;;
    12mp) survey 12mp --num_strips 1 --width 4096 --height 3072 ;;
    rig) [ -d "$output/sets/rig" ] || rig_pictures "$(survey demo)/images" "$output/sets/rig" ;;
    hybrid)
      survey demo_large --width 2720 --height 2048 --num_strips 1
      survey demo_small --num_strips 1 ;;
  esac >/dev/null
}

run_set() {  # NAME BUILD WORKSPACE
  local surveys=$output/sets
  case $1 in
    demo) reconstruct "$2" "$surveys/demo/images" "$3" --PartialDensification.write_maps 1 ;;
    t3) reconstruct "$2" "$data/auv_strips/t3/images" "$3" ;;
    fountain) reconstruct "$2" "$data/fountain_p11/images" "$3" ;;
    12mp) reconstruct "$2" "$surveys/12mp/images" "$3" ;;
    rig) reconstruct "$2" "$surveys/rig" "$3" --rig left,right ;;
    hybrid)
      reconstruct "$2" "$surveys/demo_small/images" "$3"
      "$2/bin/colmap_seapoint" partial_densifier --log_level 1 --image_path "$surveys/demo_large/images" \
        --input_path "$3/sparse/0" --database_path "$3/database.db" --output_path "$3/hybrid" \
        --PartialDensification.mode complete --PartialDensification.redundancy sequential ;;
    *) echo "no set is called $1" >&2; exit 2 ;;
  esac
}

failed=0
for name in ${sets//,/ }; do
  case $name in
    t3 | fountain) [ -d "$data" ] || { echo "$name: skipped, no folder $data"; continue; } ;;
  esac
  make_set "$name"
  for side in old new; do
    workspace=$output/$side/$name
    [ "$side" = old ] && [ -f "$workspace.sums" ] && continue
    rm -rf "$workspace"
    mkdir -p "$workspace"
    TIMEFORMAT='%U %S'
    { time run_set "$name" "${!side}" "$workspace" 2>"$workspace.log"; } 2>"$workspace.seconds" ||
      { cat "$workspace.log" >&2; echo "$name: the $side build failed" >&2; exit 1; }
    workspace_sums "$workspace" >"$workspace.sums"
  done
  seconds=$(paste -d ' ' "$output/old/$name.seconds" "$output/new/$name.seconds" |
    awk '{printf "%.1f -> %.1f CPU s", $1 + $2, $3 + $4}')
  if diff "$output/old/$name.sums" "$output/new/$name.sums" >"$output/$name.diff"; then
    echo "$name: same bytes, $(wc -l <"$output/new/$name.sums") files and tables, $seconds"
  else
    echo "$name: DIFFERS, see $output/$name.diff, $seconds"
    failed=1
  fi
done
exit $failed
