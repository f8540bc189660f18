#!/usr/bin/env bash
# scripts/benchmark_densify.sh [--output DIR] [options] [SURVEY_DIR | WORKSPACE_DIR]...
#
# Partial against complete densification of the same pairs (paper 3, Table 2 and the incremental
# rows of Table 3): seconds, CPU, density, completeness, redundancy, points, and what of the saving
# is area. On folders of demo_survey generate (exact cameras and truth) and on workspaces of
# automatic_reconstructor (its models; sparse points held out are the witnesses). Without a folder:
# on four demo surveys, which are made in DIR/surveys first.
#   --output DIR             results (densify.csv, densify.md, *.png), default benchmark_densify/
#                            in this checkout; what it holds of other folders stays in the tables
#   --image_path DIR         pictures of the workspaces that follow; else what their run.json names
#   --num_repeats N          of every timing [3]
#   --num_threads N          of densification [-1 = all]
#   --PartialDensification.* as partial_densifier takes them
# Run it again to resume: surveys that are complete are kept; measurements are made again.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
image_path=
num_repeats=3
measure_options=()
densify_options=()
folders=()
declare -A images_of=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --image_path | --num_repeats | --num_threads | --PartialDensification.*)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --image_path)
          [ -d "$2" ] || { echo "$2: no such folder; give the pictures" >&2; exit 1; }
          image_path=$(cd "$2" && pwd) ;;
        --num_repeats) num_repeats=$2 ;;
        --num_threads) measure_options+=("$1" "$2") ;;
        *) densify_options+=("$1" "$2") ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *)
      [ -d "$1" ] || { echo "$1: no such folder; give a demo survey or a workspace" >&2; exit 1; }
      folder=$(cd "$1" && pwd)
      if [ ! -f "$folder/truth/survey.json" ] && [ ! -d "$folder/sparse" ]; then
        echo "$1: neither a demo survey (truth/survey.json) nor a workspace (sparse/)" >&2
        exit 1
      fi
      folders+=("$folder")
      images_of[$folder]=$image_path
      shift ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_densify
build densify_benchmark demo_survey colmap_seapoint

if [ ${#folders[@]} -eq 0 ]; then
  size=(--width 1600 --height 1200)
  make_survey strip "${size[@]}" --turbidity 0.1 --num_strips 1 --images_per_strip 10
  make_survey strips "${size[@]}" --turbidity 0.1 --num_strips 3 --images_per_strip 8
  make_survey turbid "${size[@]}" --num_strips 2 --images_per_strip 8 --revisit 5 \
    --turbidity 0.7 --caustics 0.5 --marine_snow 0.5
  make_survey mp12 --width 4000 --height 3000 --turbidity 0.1 --num_strips 2 --images_per_strip 5
fi

measure() {  # NAME SET_OPTION...
  local name=$1
  shift
  "$bin/densify_benchmark" measure "$@" --set_name "$name" --num_repeats "$num_repeats" \
    ${measure_options[@]+"${measure_options[@]}"} ${densify_options[@]+"${densify_options[@]}"} \
    --output_path "$output/sets/$name.measure.csv" >/dev/null
  "$bin/densify_benchmark" program "$@" --set_name "$name" --num_repeats "$num_repeats" \
    --binary "$bin/colmap_seapoint" ${densify_options[@]+"${densify_options[@]}"} \
    --output_path "$output/sets/$name.program.csv" >/dev/null
  "$bin/densify_benchmark" holdout "$@" --set_name "$name" \
    ${measure_options[@]+"${measure_options[@]}"} ${densify_options[@]+"${densify_options[@]}"} \
    --output_path "$output/sets/$name.holdout.csv" >/dev/null
}

for folder in "${folders[@]}"; do
  name_set "$(basename "$folder")"
  if [ -f "$folder/truth/survey.json" ]; then
    measure "$name" --survey_path "$folder"
    continue
  fi
  images=${images_of[$folder]}
  [ -n "$images" ] || images=$(workspace_images "$folder")
  if [ ! -d "$images" ]; then
    echo "$folder: where are its pictures? Give --image_path before it." >&2
    exit 1
  fi
  for model in "$folder"/sparse/*/; do
    measure "${name}_$(basename "$model")" --input_path "${model%/}" --image_path "$images" \
      --database_path "$folder/database.db"
  done
done
"$bin/densify_benchmark" tables --input_path "$output/sets" --output_path "$output"
cat "$output/densify.md"
echo
echo "table: $output/densify.md   rows: $output/densify.csv"
if command -v gnuplot >/dev/null; then
  (cd "$output" && gnuplot "$OLDPWD/scripts/plots/densify_plots.gp")
  echo "plots: $output/densify_cpu.png $output/densify_cover.png"
else
  echo "no plots: gnuplot is missing (apt-get install gnuplot-nox)"
fi
