#!/usr/bin/env bash
# scripts/benchmark_poses.sh [--output DIR] [--qualities LIST] [SURVEY_DIR | IMAGE_DIR]...
#
# What posing costs (paper 3, Table 3, first rows): automatic_reconstructor in each quality against
# COLMAP's own chain with its defaults on the same pictures (feature_extractor with SIFT,
# exhaustive_matcher, mapper; CPU). User + system seconds, pictures registered in the largest model,
# its mean reprojection error and, on folders of demo_survey generate, the error of the camera
# centres after alignment with the truth. Without a folder: on the demo survey, made first.
#   --output DIR       results (poses.csv, poses.md) [benchmark_poses/ in this checkout]; rows that
#                      are there already are kept
#   --qualities LIST   of field, survey, archive; separated by commas [field,survey,archive]
#   --no_sift          leave COLMAP's chain out: on 20 pictures of 2 megapixels it takes 5 minutes
set -euo pipefail

usage() {
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2
}

output=
qualities=field,survey,archive
with_sift=1
folders=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --qualities)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      [ "$1" = --output ] && output=$(realpath -m "$2") || qualities=$2
      shift 2 ;;
    --no_sift) with_sift=0; shift ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *)
      [ -d "$1" ] || { echo "$1: no such folder; give pictures or a demo survey" >&2; exit 1; }
      folders+=("$(cd "$1" && pwd)"); shift ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ -n "$output" ] || output=$PWD/benchmark_poses
scripts/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target colmap_seapoint demo_survey
bin=$PWD/build/release/bin
export QT_QPA_PLATFORM=offscreen
mkdir -p "$output"
csv=$output/poses.csv
[ -f "$csv" ] || echo "set,chain,pictures,registered,features_cpu_s,matching_cpu_s,mapping_cpu_s,reprojection_px,centres_mm" >"$csv"

if [ ${#folders[@]} -eq 0 ]; then
  folders=("$output/survey")
  [ -f "$output/survey/complete" ] || "$bin/demo_survey" generate --output_path "$output/survey"
  touch "$output/survey/complete"
fi

# CPU seconds of a command, user + system; its output goes to a log.
cpu_of() {  # LOG COMMAND...
  local log=$1 times
  shift
  TIMEFORMAT='%U %S'
  times=$( { time "$@" >"$log" 2>&1; } 2>&1) || { echo "$*: failed; see $log" >&2; return 1; }
  awk '{ printf "%.1f", $1 + $2 }' <<<"$times"
}

# "registered error" of the largest model below a folder.
largest_model() {
  local model
  for model in "$1"/*/; do
    colmap model_analyzer --path "$model" 2>&1 | awk -v path="${model%/}" '
      /Registered images/ || /Registered frames/ { n = $NF }
      /Mean reprojection error/ { e = $NF; sub("px", "", e) }
      END { print n + 0, e + 0, path }'
  done | sort -k1,1nr -k2,2n | head -1
}

# RMS error of the camera centres, mm; a dash where there is no truth.
centres_of() {  # SET_FOLDER MODEL
  if [ ! -f "$1/truth/survey.json" ]; then echo -; return; fi
  colmap model_converter --input_path "$2" --output_path "$2/points.ply" --output_type PLY \
    >/dev/null 2>&1
  "$bin/demo_survey" score --survey_path "$1" --input_path "$2" --cloud_path "$2/points.ply" |
    awk '/camera centres, RMS error/ { print $(NF - 1) }'
}

add_row() {  # NAME CHAIN PICTURES FOLDER SPARSE FEATURES MATCHING MAPPING
  local registered error model
  read -r registered error model <<<"$(largest_model "$5")"
  echo "$1,$2,$3,$registered,$6,$7,$8,$error,$(centres_of "$4" "$model")" >>"$csv"
  tail -1 "$csv" >&2
}

stage_cpu() {  # RUN_JSON NAME: summed over its runs
  awk -v name="\"$2" '
    /"name":/ { found = index($2, name) == 1 }
    /"cpu_seconds":/ && found { sub(",", "", $2); sum += $2 }
    END { printf "%.1f", sum }' "$1"
}

for folder in "${folders[@]}"; do
  images=$folder
  [ -f "$folder/truth/survey.json" ] && images=$folder/images
  name=$(basename "$folder")
  [ "$name" = images ] && name=$(basename "$(dirname "$folder")")
  count=$(find "$images" -type f | wc -l)
  for quality in ${qualities//,/ }; do
    grep -q "^$name,$quality," "$csv" && continue
    workspace=$output/work/$name/$quality
    rm -rf "$workspace"
    mkdir -p "$workspace"
    status=0
    "$bin/colmap_seapoint" automatic_reconstructor --image_path "$images" \
      --workspace_path "$workspace" --quality "$quality" >"$workspace/log" 2>&1 || status=$?
    if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then
      echo "$name,$quality,$count,0,-,-,-,-,-" >>"$csv"
      echo "$name, $quality: failed; see $workspace/log" >&2
      continue
    fi
    report=$workspace/report/run.json
    add_row "$name" "$quality" "$count" "$folder" "$workspace/sparse" \
      "$(stage_cpu "$report" feature_extractor)" \
      "$(awk -v a="$(stage_cpu "$report" exhaustive_matcher)" \
        -v b="$(stage_cpu "$report" sequential_matcher)" 'BEGIN { print a + b }')" \
      "$(stage_cpu "$report" mapper)"
  done
  if [ "$with_sift" = 0 ] || grep -q "^$name,sift," "$csv"; then continue; fi
  work=$output/work/$name/sift
  rm -rf "$work"
  mkdir -p "$work/sparse"
  features=$(cpu_of "$work/features.log" colmap feature_extractor --database_path "$work/db" \
    --image_path "$images" --SiftExtraction.use_gpu 0)
  matching=$(cpu_of "$work/matching.log" colmap exhaustive_matcher --database_path "$work/db" \
    --SiftMatching.use_gpu 0)
  if mapping=$(cpu_of "$work/mapping.log" colmap mapper --database_path "$work/db" \
    --image_path "$images" --output_path "$work/sparse") && [ -d "$work/sparse/0" ]; then
    add_row "$name" sift "$count" "$folder" "$work/sparse" "$features" "$matching" "$mapping"
  else
    echo "$name,sift,$count,0,$features,$matching,${mapping:--},-,-" >>"$csv"
  fi
done

awk -F, '
  function total(row) { split(row, f, ","); return f[5] + f[6] + f[7] }
  NR > 1 { row[$1 "," $2] = $0; if (!($1 in seen)) { seen[$1]; order[++n] = $1 } }
  END {
    print "| set | chain | registered | features, CPU s | matching | mapping | all | COLMAP SIFT / this | reprojection, px | centres, mm |"
    print "|---|---|---|---|---|---|---|---|---|---|"
    split("field,survey,archive,sift", chains, ",")
    for (i = 1; i <= n; ++i) for (c = 1; c <= 4; ++c) {
      key = order[i] "," chains[c]
      if (!(key in row)) continue
      sift = (order[i] ",sift") in row ? total(row[order[i] ",sift"]) : 0
      all = total(row[key])
      split(row[key], f, ",")
      printf "| %s | %s | %s of %s | %s | %s | %s | %.1f | %s | %s | %s |\n", f[1], \
        f[2] == "sift" ? "COLMAP, SIFT" : f[2], f[4], f[3], f[5], f[6], f[7], all, \
        sift > 0 && all > 0 ? sprintf("%.1f", sift / all) : "–", f[8], f[9]
    }
  }' "$csv" >"$output/poses.md"
cat "$output/poses.md"
