#!/usr/bin/env bash
# scripts/benchmark_scale.sh [--output DIR] [--binary FILE] [--quality Q] [--mapper] [SURVEY]...
#
# What the whole chain costs, and what it reaches, from 300 to 3,000 pictures: demo surveys of small
# pictures with exact truth are made, automatic_reconstructor runs on each. A row a survey: pictures
# in the largest model, CPU seconds (user + system) a picture by stage, wall seconds and peak memory
# of the whole run, camera centres (RMS after alignment, in GSD), cloud within 4 GSD, surface covered.
#   --output DIR    surveys, workspaces, scale.csv, scale.md, scale.png [benchmark_scale/ in this
#                   checkout]; rows that are there already are kept
#   --binary FILE   colmap_seapoint to test [this checkout's own]
#   --quality Q     as automatic_reconstructor takes it [field]
#   --mapper        beside each: colmap mapper with its defaults on the same matches, as far as it
#                   gets in an hour
# SURVEY: s300 (6 strips of 50, 0.48 megapixels), l1000 (10 x 100, 0.24), t1000 (out and back, 2 x
# 500), l3000 (20 x 150). Without one: all. About an hour on two cores, most of it to make l3000.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
binary=
quality=field
with_mapper=
surveys=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --binary | --quality)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --quality) quality=$2 ;;
        --binary)
          [ -x "$2" ] || { echo "$2: no such program; give colmap_seapoint" >&2; exit 1; }
          binary=$(realpath "$2") ;;
      esac
      shift 2 ;;
    --mapper) with_mapper=1; shift ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) surveys+=("$1"); shift ;;
  esac
done
[ ${#surveys[@]} -gt 0 ] || surveys=(s300 l1000 t1000 l3000)

# Sets $options to those of demo_survey generate.
choose_options() {  # SURVEY
  case $1 in
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

# CPU seconds of the stages of those names, in all their runs.
stage_cpu() {  # RUN_JSON NAME...
  local report=$1
  shift
  awk -v names=" $* " '
    /"name":/ { name = $2; gsub(/[",]/, "", name); found = index(names, " " name " ") > 0 }
    /"cpu_seconds":/ && found { sub(",", "", $2); sum += $2; found = 0 }
    END { printf "%.1f", sum }' "$report"
}

# The largest model's folder and its number of pictures.
largest_model() {  # SPARSE
  local model
  for model in "$1"/*/; do
    printf '%s %s\n' "$(colmap model_analyzer --path "$model" 2>&1 |
      awk '/Registered (images|frames)/ { print $NF; exit }')" "${model%/}"
  done | sort -k1,1nr | head -n 1
}

# The figure in a line of demo_survey score.
figure() {  # SCORE_FILE TEXT FIELD_FROM_END
  awk -v text="$2" -v back="$3" 'index($0, text) { v = $(NF - back); sub("%", "", v); print v; exit }' "$1"
}

# Centres in GSD, share of the cloud within 4 GSD, share covered; dashes where there is no cloud.
score() {  # SURVEY_FOLDER MODEL CLOUD
  local text gsd
  text=$(mktemp)
  "$bin/demo_survey" score --survey_path "$1" --input_path "$2" --cloud_path "$3" >"$text"
  gsd=$(awk '/"gsd":/ { sub(",", "", $2); print $2; exit }' "$1/truth/survey.json")
  printf '%s,%s,%s' \
    "$(awk -v mm="$(figure "$text" "centres, RMS" 1)" -v gsd="$gsd" 'BEGIN { printf "%.2f", mm / 1000 / gsd }')" \
    "$(figure "$text" "within 4" 1)" "$(figure "$text" "covered" 1)"
  rm -f "$text"
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

run_mapper() {  # SURVEY
  local folder=$output/surveys/$1 work=$output/work/$1.mapper registered model
  ! grep -q "^$1,mapper," "$csv" || return 0
  rm -rf "$work"
  mkdir -p "$work/sparse"
  measure_command "$work/log" timeout 3600 colmap mapper \
    --database_path "$output/work/$1/database.db" --image_path "$folder/images" \
    --output_path "$work/sparse" || true
  read -r registered model < <(largest_model "$work/sparse")
  echo "$1,mapper,$(find "$folder/images" -type f | wc -l),${registered:-0},,,$cpu_s,,$wall_s,$cpu_s,$peak_mb,,," >>"$csv"
  tail -n 1 "$csv" >&2
}

for survey in "${surveys[@]}"; do
  choose_options "$survey"
  make_survey "$survey" "${options[@]}"
  run_chain "$survey"
  [ -z "$with_mapper" ] || run_mapper "$survey"
done

awk -F, '
  NR == 1 {
    print "| survey | chain | registered | CPU s a picture: features | matching | posing | dense | wall / CPU | peak, MB | centres, GSD | within 4 GSD, % | covered, % |"
    print "|---|---|---|---|---|---|---|---|---|---|---|---|"
    next
  }
  function each(v) { return v == "" ? "–" : sprintf("%.3f", v / $3) }
  { printf "| %s | %s | %s of %s | %s | %s | %s | %s | %.2f | %s | %s | %s | %s |\n", $1, $2, $4, $3,
      each($5), each($6), each($7), each($8), $9 / $10, $11, $12, $13, $14 }' \
  "$csv" >"$output/scale.md"
awk -F, '
  BEGIN { OFS = "\t"; print "survey", "features", "matching", "posing", "dense" }
  NR > 1 && $2 == "ours" { print $1, $5 / $3, $6 / $3, $7 / $3, $8 / $3 }' "$csv" >"$output/scale.dat"
(cd "$output" && gnuplot "$OLDPWD/scripts/plots/scale_plots.gp")
cat "$output/scale.md"
