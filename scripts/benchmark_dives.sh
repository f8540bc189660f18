#!/usr/bin/env bash
# scripts/benchmark_dives.sh [--output DIR] [options] [DIVE]...
#
# Dense clouds of dives of every kind against their exact truth: a demo survey for each is made,
# its SeaPoints are matched, and partial_densifier runs on its true poses. A row a dive: points,
# share of them within 1 / 2 / 4 GSD of the surface and median distance, share covered of what two
# pictures see 3 degrees apart, points in an occupied cell of 1 GSD (all in the GSD of the best two
# pictures that hold the place), CPU seconds (user + system) of partial_densifier.
#   --output DIR             surveys, clouds, scores and the table (dives.md), default
#                            benchmark_dives/ in this checkout
#   --binary FILE            colmap_seapoint to test, default this checkout's own
#   --num_threads N          of it [-1 = all]
#   --PartialDensification.* as partial_densifier takes them
# DIVE: swim (30 degrees below the horizon), swim35, circle, statue, wall, descent, video (a swim
# at 30 pictures a second), random (strips, file names in random order), roll (every second picture
# rolled by 70 degrees), fisheye (120 degrees, strips), fisheye_swim. Without one: all.
# Run it again to resume: surveys that are complete are kept; clouds are made again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
binary=
densify_options=()
dives=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --binary | --num_threads | --PartialDensification.*)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --binary) take_binary "$2" ;;
        *) densify_options+=("$1" "$2") ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) dives+=("$1"); shift ;;
  esac
done
[ ${#dives[@]} -gt 0 ] ||
  dives=(swim swim35 circle statue wall descent video random roll fisheye fisheye_swim)

# Sets $options to those of demo_survey generate.
choose_options() {  # DIVE
  local fisheye=(--camera_model OPENCV_FISHEYE --field_of_view 120)
  options=(--width 1152 --height 864 --num_strips 2 --images_per_strip 6)
  case $1 in
    swim) options+=(--path swim) ;;
    swim35) options+=(--path swim --pitch 35) ;;
    circle | statue) options=(--width 1152 --height 864 --path "$1" --num_strips 1
      --images_per_strip 16) ;;
    wall | descent | random) options+=(--path "$1") ;;
    # A video's carrier hardly moves from one picture to the next: neither does it shake.
    video) options=(--width 800 --height 600 --path swim --num_strips 1 --images_per_strip 60
      --forward_overlap 0.98 --jitter 0.2) ;;
    roll) options+=(--roll 70) ;;
    fisheye) options=(--width 1152 --height 864 --num_strips 2 --images_per_strip 5
      "${fisheye[@]}") ;;
    fisheye_swim) options+=(--path swim "${fisheye[@]}") ;;
    *) usage; echo "unknown dive $1" >&2; exit 2 ;;
  esac
}
for dive in "${dives[@]}"; do choose_options "$dive"; done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_dives
build demo_survey colmap_seapoint
binary=${binary:-$bin/colmap_seapoint}

json_text() {  # FILE NAME
  sed -n 's/^ *"'"$2"'": "\(.*\)",\{0,1\}$/\1/p' "$1" | head -n 1
}

# SeaPoints and matches of a survey, with its exact lens. By this checkout's program: the same for
# every one that is tested.
match_survey() {  # SURVEY
  [ ! -f "$1/database.db" ] || return 0
  local part=$1/database.part.db json=$1/truth/survey.json
  rm -f "$part"
  "$bin/colmap_seapoint" feature_extractor --database_path "$part" --image_path "$1/images" \
    --ImageReader.single_camera 1 --ImageReader.camera_model "$(json_text "$json" camera_model)" \
    --ImageReader.camera_params "$(json_text "$json" camera_params)" --log_level 1
  "$bin/colmap_seapoint" exhaustive_matcher --database_path "$part" --log_level 1
  mv "$part" "$1/database.db"
}

# A row of the table. The score ends with blocks of accuracies that share their names.
score_row() {  # DIVE SCORE_JSON
  awk -v dive="$1" -v cpu="$cpu_s" -F '[:,]' '
    { gsub(/[ "]/, "", $1); value[block $1] = $2 }
    $2 ~ /{/ { block = $1 "." }
    END {
      printf "| %s | %d | %.1f / %.1f / %.1f | %.2f | %.1f / %.1f | %.2f | %.1f |\n", dive,
        value["num_points"], 100 * value["own_gsd.share_within_1gsd"],
        100 * value["own_gsd.share_within_2gsd"], 100 * value["own_gsd.share_within_4gsd"],
        value["own_gsd.median_gsd"], 100 * value["parallax_coverage_2gsd"],
        100 * value["parallax_coverage_4gsd"], value["own_redundancy"], cpu
    }' "$2"
}

measure_dive() {  # DIVE
  local survey=$output/surveys/$1 cloud=$output/clouds/$1 status=0
  rm -rf "$cloud"
  mkdir -p "$cloud"
  measure_command "$cloud/log" "$binary" partial_densifier --image_path "$survey/images" \
    --input_path "$survey/truth/sparse" --database_path "$survey/database.db" \
    --output_path "$cloud" ${densify_options[@]+"${densify_options[@]}"} || status=$?
  if [ ! -s "$cloud/fused.ply" ]; then
    echo "$1: no cloud (exit code $status); see $cloud/log" >&2
    echo "| $1 | 0 | - | - | 0 / 0 | - | $cpu_s |"
    return 0
  fi
  "$bin/demo_survey" score --truth_poses 1 --survey_path "$survey" \
    --input_path "$survey/truth/sparse" --cloud_path "$cloud/fused.ply" \
    --output_path "$output/sets/$1.json" >"$output/sets/$1.txt"
  score_row "$1" "$output/sets/$1.json"
}

folders=()
for dive in "${dives[@]}"; do
  choose_options "$dive"
  make_survey "$dive" "${options[@]}"
  match_survey "$output/surveys/$dive"
done
{
  echo "| dive | points | % within 1 / 2 / 4 GSD | median, GSD | % covered at 2 / 4 GSD | redundancy | CPU s |"
  echo "|---|--:|--:|--:|--:|--:|--:|"
  for dive in "${dives[@]}"; do measure_dive "$dive"; done
} | tee "$output/dives.md"
echo "table: $output/dives.md   scores: $output/sets"
