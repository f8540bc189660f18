#!/usr/bin/env bash
# scripts/benchmark_second_dive.sh [--output DIR] [WORLD]...
#
# Closes the loop: completeness_reporter says where the gaps of a demo survey with planted ones are
# (blurred, lost and removed pictures, a smooth and a moving patch), and how to close them; demo_survey
# photographs these passes; both dives are densified together, with exact poses. Says how much of what
# was truly missing in the reported gaps, and of all true gaps, is covered then, by the exact truth.
# On the second dive the smooth patch has its sand's texture again, and what moved is gone.
#   --output DIR   surveys, clouds and reports, default benchmark_second_dive/ in this checkout
# WORLD: strips, flat, low. Without one: all. Run it again to resume.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
worlds=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output) [ $# -ge 2 ] || { usage; exit 2; }; output=$2; shift 2 ;;
    strips | flat | low) worlds+=("$1"); shift ;;
    *) usage; echo "unknown option or world $1" >&2; exit 2 ;;
  esac
done
[ ${#worlds[@]} -gt 0 ] || worlds=(strips flat low)

choose_options() {  # WORLD: the surveys of benchmark_completeness.sh, half as long
  options=(--width 1152 --height 864 --num_strips 3 --images_per_strip 8)
  case $1 in
    strips) options+=(--seed 1) ;;
    flat) options+=(--seed 21 --relief 0.3 --turbidity 0.1) ;;
    low) options+=(--seed 24 --altitude 1.2 --forward_overlap 0.7) ;;
  esac
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_second_dive
build demo_survey colmap_seapoint completeness_benchmark second_dive

densify() {  # IMAGES MODEL CLOUD
  [ ! -s "$3/fused.ply" ] || return 0
  "$bin/colmap_seapoint" partial_densifier --image_path "$1" --input_path "$2" --output_path "$3" \
    --log_level 1 || [ $? -eq 3 ]
}

report() {  # IMAGES MODEL CLOUD REPORT
  [ ! -f "$4/completeness.json" ] || return 0
  "$bin/colmap_seapoint" completeness_reporter --image_path "$1" --input_path "$2" \
    --cloud_path "$3/fused.ply" --output_path "$4" --log_level 1 || [ $? -eq 3 ]
}

for world in "${worlds[@]}"; do
  choose_options "$world"
  make_survey "$world" "${options[@]}" >&2
  survey=$output/surveys/$world work=$output/dives/$world
  first=$work/first both=$work/both
  [ -f "$first/planted.json" ] ||
    "$bin/completeness_benchmark" plant --survey_path "$survey" --output_path "$first" --num_strips 3
  densify "$first/images" "$first/sparse" "$work/first_cloud"
  report "$first/images" "$first/sparse" "$work/first_cloud" "$work/first_report" >&2
  if [ ! -d "$both/sparse" ]; then
    "$bin/demo_survey" generate --output_path "$work/dive" "${options[@]}" \
      --passes_path "$work/first_report/gaps.geojson" >&2
    mkdir -p "$both/images"
    cp "$first/images/"* "$work/dive/images/"* "$both/images"
    "$bin/second_dive" join --first_path "$first/sparse" --survey_path "$work/dive" \
      --output_path "$both/sparse" >&2
  fi
  densify "$both/images" "$both/sparse" "$work/both_cloud"
  report "$both/images" "$both/sparse" "$work/both_cloud" "$work/both_report" >&2
  echo "$world:"
  "$bin/second_dive" closed --survey_path "$survey" --planted_path "$first" \
    --report_path "$work/first_report" --before_path "$work/first_cloud/fused.ply" \
    --cloud_path "$work/both_cloud/fused.ply"
done
