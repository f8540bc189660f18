#!/usr/bin/env bash
# scripts/benchmark_scale.sh [--output DIR] [--binary FILE] [--quality Q] [--colmap SECONDS] [SURVEY]...
#
# What the whole chain costs, and what it reaches, from 100 to 3,000 pictures: demo surveys of small
# pictures with exact truth are made, automatic_reconstructor runs on each. A row a survey: pictures
# in the largest model, CPU seconds (user + system) a picture by stage, wall seconds and peak memory
# of the whole run, camera centres (RMS after alignment, in GSD), cloud within 4 GSD, surface covered.
#   --output DIR    surveys, workspaces, scale.csv, scale.md, scale.png [benchmark_scale/ in this
#                   checkout]; rows that are there already are kept
#   --binary FILE   colmap_seapoint to test [this checkout's own]
#   --quality Q     as automatic_reconstructor takes it [field]
#   --colmap SECONDS  beside each: COLMAP's own chain with its defaults, on the CPU and without its
#                   dense part (feature_extractor, sequential_matcher, mapper), as far as it gets in
#                   SECONDS of wall time; the stage that was cut short is marked with a +
# SURVEY: s100 (2 strips of 50, 0.48 megapixels), s300 (6 x 50), l1000 (10 x 100, 0.24), t1000 (out
# and back, 2 x 500), l3000 (20 x 150). Without one: all. About an hour on two cores, most of it to
# make l3000.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
binary=
quality=field
colmap_s=
surveys=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --binary | --quality | --colmap)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --quality) quality=$2 ;;
        --colmap)
          [[ $2 =~ ^[1-9][0-9]*$ ]] || { echo "--colmap $2: give a number of seconds" >&2; exit 2; }
          colmap_s=$2 ;;
        --binary) take_binary "$2" ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) surveys+=("$1"); shift ;;
  esac
done
[ ${#surveys[@]} -gt 0 ] || surveys=(s100 s300 l1000 t1000 l3000)

# Sets $options to those of demo_survey generate.
choose_options() {  # SURVEY
  case $1 in
    s100) options=(--num_strips 2 --images_per_strip 50 --width 800 --height 600) ;;
    s300) options=(--num_strips 6 --images_per_strip 50 --width 800 --height 600) ;;
    l1000) options=(--num_strips 10 --images_per_strip 100 --width 566 --height 424) ;;
    t1000) options=(--num_strips 2 --images_per_strip 500 --width 566 --height 424) ;;
    l3000) options=(--num_strips 20 --images_per_strip 150 --width 566 --height 424) ;;
    *) usage; echo "unknown survey $1" >&2; exit 2 ;;
  esac
}
for survey in "${surveys[@]}"; do choose_options "$survey"; done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_scale
install_packages time gnuplot-nox
build demo_survey colmap_seapoint
binary=${binary:-$bin/colmap_seapoint}
export QT_QPA_PLATFORM=offscreen
csv=$output/scale.csv
[ -f "$csv" ] ||
  echo "survey,chain,pictures,registered,features_s,matching_s,posing_s,dense_s,wall_s,cpu_s,peak_mb,centres_gsd,within_4_gsd_pct,covered_pct" >"$csv"

# The largest model's number of pictures and folder; "0 -" where there is none.
largest_model() {  # SPARSE
  local model
  { for model in "$1"/*/; do
    [ -d "$model" ] || continue
    printf '%s %s\n' \
      "$(analyzed "$(colmap model_analyzer --path "$model" 2>&1)" 'Registered images')" "${model%/}"
  done; echo "0 -"; } | sort -k1,1nr | head -n 1
}

# Camera centres in GSD, share of the cloud within 4 GSD, share of the surface covered.
score() {  # SURVEY_FOLDER MODEL CLOUD
  local text gsd
  text=$("$bin/demo_survey" score --survey_path "$1" --input_path "$2" --cloud_path "$3")
  gsd=$(awk '/"gsd":/ { sub(",", "", $2); print $2; exit }' "$1/truth/survey.json")
  printf '%s,%s,%s' \
    "$(awk -v mm="$(score_figure "$text" "camera centres, RMS")" -v gsd="$gsd" \
      'BEGIN { printf "%.2f", mm / 1000 / gsd }')" \
    "$(score_figure "$text" "points within 4 GSD")" \
    "$(score_figure "$text" "of it with a point within 4 GSD")"
}

run_chain() {  # SURVEY
  local folder=$output/surveys/$1 workspace=$output/work/$1 status=0 registered model report
  ! grep -q "^$1,ours," "$csv" || return 0
  rm -rf "$workspace"
  mkdir -p "$workspace"
  measure_command "$output/work/$1.log" "$binary" automatic_reconstructor --quality "$quality" \
    --image_path "$folder/images" --workspace_path "$workspace" || status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then
    echo "$1: failed, see $output/work/$1.log" >&2
    return 1
  fi
  report=$workspace/report/run.json
  read -r registered model < <(largest_model "$workspace/sparse")
  echo "$1,ours,$(find "$folder/images" -type f | wc -l),$registered,$(stage_cpu "$report" feature_extractor),$(stage_cpu "$report" exhaustive_matcher sequential_matcher),$(stage_cpu "$report" mapper),$(stage_cpu "$report" partial_densifier),$wall_s,$cpu_s,$peak_mb,$(score "$folder" "$model" "$workspace/dense/$(basename "$model")/fused.ply")" >>"$csv"
  tail -n 1 "$csv" >&2
}

# A stage of COLMAP's chain within what is left of its time; adds to $stages (its CPU seconds), and
# to $chain_wall_s and $chain_cpu_s. Not when it fails or is cut short: $stages then ends with a +.
colmap_stage() {  # LOG COMMAND...
  local left status=0
  left=$(awk -v all="$colmap_s" -v used="$chain_wall_s" 'BEGIN { printf "%.0f", all - used }')
  if [ "$left" -lt 1 ]; then return 1; fi
  measure_command "$1" timeout "$left" colmap "${@:2}" || status=$?
  chain_wall_s=$(awk -v a="$chain_wall_s" -v b="$wall_s" 'BEGIN { print a + b }')
  chain_cpu_s=$(awk -v a="$chain_cpu_s" -v b="$cpu_s" 'BEGIN { print a + b }')
  [ "$peak_mb" -le "$chain_peak_mb" ] || chain_peak_mb=$peak_mb
  [ "$status" -eq 0 ] || cpu_s=$cpu_s+
  stages+=("$cpu_s")
  return "$status"
}

run_colmap() {  # SURVEY
  local folder=$output/surveys/$1 work=$output/work/$1.colmap stages=() registered=0 model=- scored=,,
  local chain_wall_s=0 chain_cpu_s=0 chain_peak_mb=0 no_gpu database=(--database_path)
  ! grep -q "^$1,colmap," "$csv" || return 0
  rm -rf "$work"
  mkdir -p "$work/sparse"
  database+=("$work/database.db")
  no_gpu="$(colmap_option colmap feature_extractor 0 SiftExtraction.use_gpu FeatureExtraction.use_gpu)"
  # shellcheck disable=SC2086 # two words
  if colmap_stage "$work/features.log" feature_extractor "${database[@]}" \
    --image_path "$folder/images" --ImageReader.single_camera 1 $no_gpu &&
    no_gpu="$(colmap_option colmap sequential_matcher 0 SiftMatching.use_gpu FeatureMatching.use_gpu)" &&
    colmap_stage "$work/matching.log" sequential_matcher "${database[@]}" $no_gpu &&
    colmap_stage "$work/mapping.log" mapper "${database[@]}" --image_path "$folder/images" \
      --output_path "$work/sparse"; then
    read -r registered model < <(largest_model "$work/sparse")
  fi
  if [ "$registered" -gt 0 ]; then
    colmap model_converter --input_path "$model" --output_path "$work/points.ply" --output_type PLY \
      >"$work/converter.log" 2>&1
    scored="$(score "$folder" "$model" "$work/points.ply" | cut -d , -f 1),,"
  fi
  echo "$1,colmap,$(find "$folder/images" -type f | wc -l),$registered,${stages[0]:-},${stages[1]:-},${stages[2]:-},,$chain_wall_s,$chain_cpu_s,$chain_peak_mb,$scored" >>"$csv"
  tail -n 1 "$csv" >&2
}

for survey in "${surveys[@]}"; do
  choose_options "$survey"
  make_survey "$survey" "${options[@]}"
  run_chain "$survey"
  [ -z "$colmap_s" ] || run_colmap "$survey"
done

awk -F, '
  NR == 1 {
    print "| survey | chain | registered | CPU s a picture: features | matching | posing | dense | wall / CPU | peak, MB | centres, GSD | within 4 GSD, % | covered, % |"
    print "|---|---|---|---|---|---|---|---|---|---|---|---|"
    next
  }
  function each(v) { return v == "" ? "–" : sprintf("%.3f", v / $3) (v ~ /[+]/ ? "+" : "") }
  function or_none(v) { return v == "" ? "–" : v }
  { printf "| %s | %s | %s of %s | %s | %s | %s | %s | %.2f | %s | %s | %s | %s |\n", $1, $2, $4, $3,
      each($5), each($6), each($7), each($8), $9 / $10, $11, or_none($12),
      or_none($13), or_none($14) }' \
  "$csv" >"$output/scale.md"
awk -F, '
  BEGIN { OFS = "\t"; print "survey", "features", "matching", "posing", "dense" }
  NR > 1 { print $1 ($2 == "ours" ? "" : ", COLMAP" ($5 $6 $7 ~ /[+]/ ? ", cut short" : "")),
             $5 / $3, $6 / $3, $7 / $3, $8 / $3 }' "$csv" >"$output/scale.dat"
(cd "$output" && gnuplot "$OLDPWD/scripts/plots/scale_plots.gp")
cat "$output/scale.md"
