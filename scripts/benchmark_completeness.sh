#!/usr/bin/env bash
# scripts/benchmark_completeness.sh [--output DIR] [WORLD]...
#
# What completeness_reporter says of demo surveys, against their exact truth: what is covered, and
# the gaps. Poses are exact. Into strips gaps are planted (a smooth and a moving patch, blurred, lost
# and removed pictures); dives that look ahead have those that they have. A row a world: the share
# covered as said and as it is; recall and precision of the gaps by area, and the share of what was
# found whose cause is right (gaps above (10 spacings)^2); how many gaps are listed; CPU seconds.
# Then m^2 of these gaps that are called covered: by the report, by a map of footprints as of
# drone-tm, by the views of points as of ODM.
#   --output DIR   surveys, clouds, reports and the table (completeness.md), default
#                  benchmark_completeness/ in this checkout
# WORLD: strips, flat, rough, murky, low, caustics, swim_gaps (with planted gaps); swim, swim35,
# circle, wall, descent.
# Without one: all. Run it again to resume: surveys and clouds are kept, reports are made again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
worlds=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output) [ $# -ge 2 ] || { usage; exit 2; }; output=$2; shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) worlds+=("$1"); shift ;;
  esac
done
[ ${#worlds[@]} -gt 0 ] || worlds=(strips flat rough murky low caustics swim_gaps swim swim35 circle wall descent)

# Sets $options to those of demo_survey generate, $seed to that of the planted gaps (empty: none), and
# $num_strips to what they are planted in.
choose_options() {  # WORLD
  local size=(--width 800 --height 600)
  local strips=("${size[@]}" --num_strips 4 --images_per_strip 10)
  seed= num_strips=4
  options=("${size[@]}" --num_strips 2 --images_per_strip 7)
  case $1 in
    strips) options=("${strips[@]}" --seed 1) seed=1 ;;
    flat) options=("${strips[@]}" --seed 21 --relief 0.3 --turbidity 0.1) seed=2 ;;
    rough) options=("${strips[@]}" --seed 22 --relief 1.4 --altitude 3) seed=3 ;;
    murky) options=("${strips[@]}" --seed 23 --turbidity 0.7 --marine_snow 0.3) seed=4 ;;
    low) options=("${strips[@]}" --seed 24 --altitude 1.2 --forward_overlap 0.7) seed=5 ;;
    caustics) options=("${strips[@]}" --seed 77 --relief 1.1 --altitude 2.5 --turbidity 0.4
      --caustics 0.5) seed=17 ;;
    swim_gaps) options=("${size[@]}" --num_strips 3 --images_per_strip 10 --path swim --pitch 40
      --seed 31) seed=6 num_strips=3 ;;
    swim) options+=(--path swim) ;;
    swim35) options+=(--path swim --pitch 35) ;;
    circle) options=("${size[@]}" --path circle --num_strips 1 --images_per_strip 16) ;;
    wall | descent) options+=(--path "$1") ;;
    *) usage; echo "unknown world $1" >&2; exit 2 ;;
  esac
}
for world in "${worlds[@]}"; do choose_options "$world"; done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_completeness
build demo_survey colmap_seapoint completeness_benchmark

# Sets $pictures and $model to what is densified and reported on.
plant() {  # WORLD
  local survey=$output/surveys/$1 planted=$output/planted/$1
  pictures=$survey/images model=$survey/truth/sparse score=(--survey_path "$survey")
  [ -n "$seed" ] || return 0
  pictures=$planted/images model=$planted/sparse score+=(--planted_path "$planted")
  [ ! -f "$planted/complete" ] || return 0
  "$bin/completeness_benchmark" plant --survey_path "$survey" --output_path "$planted" --seed "$seed" \
    --num_strips "$num_strips"
  touch "$planted/complete"
}

densify() {  # WORLD
  local cloud=$output/clouds/$1
  [ ! -s "$cloud/fused.ply" ] || return 0
  "$bin/colmap_seapoint" partial_densifier --image_path "$pictures" --input_path "$model" \
    --output_path "$cloud" --log_level 1 || [ $? -eq 3 ]
}

measure_world() {  # WORLD
  local cloud=$output/clouds/$1/fused.ply report=$output/reports/$1
  rm -rf "$report"
  measure_command "$output/sets/$1.log" "$bin/colmap_seapoint" completeness_reporter \
    --image_path "$pictures" --input_path "$model" --cloud_path "$cloud" --output_path "$report" \
    --log_level 1
  "$bin/completeness_benchmark" score "${score[@]}" --cloud_path "$cloud" --report_path "$report" \
    --picture_path "$output/sets/$1.png" >"$output/sets/$1.txt"
  awk -v world="$1" -v gaps="$(grep -c '"id":' "$report/completeness.json")" -v cpu="$cpu_s" '
    /^all / { recall = $6; precision = $11; cause = $14 }
    /^covered share/ { said = $4; is = $9 }
    /^falsely covered/ { falsely = $4 " / " $7 " / " $12 }
    END { printf "| %s | %s / %s | %s | %s | %s | %s | %d | %s |\n", world, said, is, recall,
      precision, cause, falsely, gaps, cpu }' "$output/sets/$1.txt"
}

folders=()
{
  echo "| world | % covered, said / is | recall, % | precision, % | cause, % |" \
    "falsely covered, m2: ours / footprints / views | gaps | CPU s |"
  echo "|---|--:|--:|--:|--:|--:|--:|--:|"
  for world in "${worlds[@]}"; do
    choose_options "$world"
    make_survey "$world" "${options[@]}"
    plant "$world"
    densify "$world"
    measure_world "$world"
  done
} | tee "$output/completeness.md"
echo "table: $output/completeness.md   scores and pictures: $output/sets"
