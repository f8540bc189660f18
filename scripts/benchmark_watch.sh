#!/usr/bin/env bash
# scripts/benchmark_watch.sh [--output DIR] [--binary FILE] [--interval S] [generate options]
#
# How long pictures are on their way into the map with `automatic_reconstructor --watch 1`: those of a
# demo survey come one every S seconds [2], written in pieces as by a slow card. Prints what the watch
# said of each round, its times, and the score of its cloud and of a run of all pictures.
#   --output DIR     survey, workspaces and watch.log [benchmark_watch/ in this checkout]
#   --binary FILE    colmap_seapoint to test, default this checkout's own
# All other options are demo_survey generate's (--num_strips, --images_per_strip, --width, --height).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
binary=
interval=2
generate=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --*)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --binary) take_binary "$2" ;;
        --interval) interval=$2 ;;
        *) generate+=("$1" "$2") ;;
      esac
      shift 2 ;;
    *) usage; echo "$1: no option" >&2; exit 2 ;;
  esac
done
cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_watch
if [ -n "$binary" ]; then bin=$(dirname "$binary"); else build colmap_seapoint demo_survey; fi
binary=${binary:-$bin/colmap_seapoint}
folders=()
make_survey "watched_$(printf '%s' "${generate[*]:-}" | tr -c 'A-Za-z0-9' _)" ${generate[@]+"${generate[@]}"}
survey=${folders[0]}
rm -rf "$output/images" "$output/watched" "$output/batch"
mkdir -p "$output/images"

come() {  # PICTURE: its first half, then all of it
  head -c $(($(stat -c %s "$1") / 2)) "$1" >"$output/images/$(basename "$1")"
  sleep 0.2
  cp "$1" "$output/images/"
}
{
  for picture in "$survey"/images/*; do
    sleep "$interval"
    come "$picture"
  done
} &
feeder=$!
trap 'kill "$feeder" 2>/dev/null || true' EXIT
"$binary" automatic_reconstructor --image_path "$output/images" --workspace_path "$output/watched" \
  --watch 1 --watch_idle 15 >"$output/watched.txt" 2>"$output/watch.log"
grep -E '^(Round|warning: .*overlap|No more)' "$output/watch.log"
"$binary" automatic_reconstructor --image_path "$survey/images" --workspace_path "$output/batch" \
  >"$output/batch.txt" 2>"$output/batch.log"
for workspace in watched batch; do
  echo "$workspace:"
  "$bin/demo_survey" score --survey_path "$survey" --input_path "$output/$workspace/sparse/0" \
    --cloud_path "$output/$workspace/dense/0/fused.ply" 2>/dev/null | grep -E 'within|covered'
done
