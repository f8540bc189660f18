#!/usr/bin/env bash
# scripts/benchmark_mvs.sh [--output DIR] [options] [SURVEY_DIR | WORKSPACE_DIR | MODEL_DIR]...
#
# Densification against multi-view stereo on the same model, in one sitting (paper 3, Table 3): ours,
# partial and complete; COLMAP's and OpenMVS's where they run (scripts/mvs_timings.sh), and figures
# from elsewhere. User + system seconds, wall seconds, peak memory, points, density; every cloud
# against every other one (cloud_comparer); on demo surveys each against the exact truth. What could
# not run is in the tables with the reason. Folders: workspaces of automatic_reconstructor (each of
# their models), COLMAP models, or folders of demo_survey generate (their exact model). Without a
# folder: on a demo survey of 2-megapixel pictures, made first.
#   --output DIR             results (mvs.csv, pairs.csv, mvs.md, *.png), default benchmark_mvs/ in
#                            this checkout; what it holds of other folders stays in the tables
#   --image_path DIR         pictures of the folders that follow; else what their run.json names
#   --survey_path DIR        the demo survey whose pictures the folders that follow are of, or "none"
#   --import CSV             rows for the folder that follows, as mvs_timings.sh writes them:
#                            method,wall_s,cpu_s,gpu,machine,peak_mb,cloud_path,note
#   --distances a,b,c        of the comparisons; else 1, 2 and 4 times our partial cloud's spacing
#   --max_image_size N       for the other programs [-1 = in full]
#   --num_threads N          of ours [-1 = all]
#   --PartialDensification.* as partial_densifier takes them
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
image_path=
survey_path=
imports=
distances=
max_image_size=-1
our_options=()
folders=()
declare -A images_of=() survey_of=() imports_of=()
absolute() { (cd "$1" 2>/dev/null && pwd) || { echo "$1: no such folder" >&2; exit 1; }; }
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --image_path | --survey_path | --import | --distances | --max_image_size | \
      --num_threads | --PartialDensification.*)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --image_path) image_path=$(absolute "$2") ;;
        --survey_path) if [ "$2" = none ]; then survey_path=; else survey_path=$(absolute "$2"); fi ;;
        --import)
          [ -f "$2" ] || { echo "$2: no such file; give what mvs_timings.sh wrote" >&2; exit 1; }
          imports+=$(realpath "$2")$'\n' ;;
        --distances) distances=$2 ;;
        --max_image_size) max_image_size=$2 ;;
        *) our_options+=("$1" "$2") ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *)
      folder=$(absolute "$1")
      folders+=("$folder")
      images_of[$folder]=$image_path
      survey_of[$folder]=$survey_path
      imports_of[$folder]=$imports
      imports=
      shift ;;
  esac
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output benchmark_mvs
build colmap_seapoint demo_survey
install_packages time gnuplot-nox
if [ ${#folders[@]} -eq 0 ]; then
  make_survey survey_2mp --width 1600 --height 1200 --turbidity 0.1 --num_strips 2 \
    --images_per_strip 10 --forward_overlap 0.8 --side_overlap 0.5
fi
machine=$(machine_name)

# Pictures and their megapixels in all.
model_size() {  # MODEL
  local text=$work/model_text
  mkdir -p "$text"
  QT_QPA_PLATFORM=offscreen colmap model_converter --input_path "$1" --output_path "$text" \
    --output_type TXT >/dev/null 2>&1
  awk '/^#/ { next }
    FILENAME ~ /cameras/ { size[$1] = $3 * $4 / 1e6; next }
    FNR > 1 && ++line % 2 { ++n; sum += size[$9] }
    END { print n, sum }' "$text/cameras.txt" <(printf '#\n'; grep -v '^#' "$text/images.txt")
}

# Appends a row of mvs.csv. Empty figures are explained by the note.
row() {  # METHOD WALL CPU GPU MACHINE PEAK CLOUD NOTE
  printf '%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s\n' \
    "$name" "$1" "$num_pictures" "$megapixels" "$2" "$3" "$4" "$5" "$6" "$7" "$8" >>"$work/rows.csv"
}

run_ours() {  # MODE MODEL IMAGES DATABASE
  local out=$work/$1 database=()
  [ ! -f "$4" ] || database=(--database_path "$4")
  echo "$name: ours, $1 ..." >&2
  # 3: some pictures were left out, each named in the log.
  local status=0
  measure_command "$work/$1.log" "$bin/colmap_seapoint" partial_densifier --image_path "$3" \
    --input_path "$2" --output_path "$out" ${database[@]+"${database[@]}"} \
    ${our_options[@]+"${our_options[@]}"} --PartialDensification.mode "$1" || status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then
    row "ours $1" "" "" none "$machine" "" "" "not run: $(tail -n 1 "$work/$1.log" | tr ',' ';')"
    return
  fi
  row "ours $1" "$wall_s" "$cpu_s" none "$machine" "$peak_mb" "$out/fused.ply" ""
}

# Rows of a CSV of mvs_timings.sh; its cloud paths count from its folder.
import_rows() {  # CSV SUFFIX
  local here method wall cpu gpu where peak cloud note
  here=$(dirname "$1")
  while IFS=, read -r method wall cpu gpu where peak cloud note; do
    [ -n "$method" ] || continue
    case $cloud in '' | /*) ;; *) cloud=$here/$cloud ;; esac
    if [ -n "$cloud" ] && [ ! -f "$cloud" ]; then
      note="${note:+$note; }its cloud is not here: $(basename "$cloud")"
      cloud=
    fi
    [ -n "$wall$cpu" ] || [ -n "$note" ] || note="no timing in $(basename "$1")"
    row "$method$2" "$wall" "$cpu" "${gpu:-none}" "$where" "$peak" "$cloud" "$note"
  done < <(tail -n +2 "$1" | tr -d '\r')
}

# Every cloud against every other one, in the same cells and distances.
compare_clouds() {
  local methods=() clouds=() i j out method cloud lengths=()
  while IFS=, read -r _ method _ _ _ _ _ _ _ cloud _; do
    [ -n "$cloud" ] || continue
    methods+=("$method")
    clouds+=("$cloud")
  done <"$work/rows.csv"
  [ -z "$distances" ] || lengths=(--distances "$distances")
  rm -f "$work"/pair_*
  for ((i = 0; i < ${#clouds[@]}; ++i)); do
    for ((j = 0; j < ${#clouds[@]}; ++j)); do
      # The earlier one is the reference; a lone cloud is compared with itself, for its density.
      [ "$i" -gt "$j" ] || [ ${#clouds[@]} -eq 1 ] || continue
      out=$work/pair_${i}_$j
      echo "$name: ${methods[i]} against ${methods[j]} ..." >&2
      "$bin/colmap_seapoint" cloud_comparer --log_level 1 --input_path "${clouds[i]}" \
        --reference_path "${clouds[j]}" --output_path "$out.json" \
        ${lengths[@]+"${lengths[@]}"} >"$out.txt"
      printf '%s,%s\n' "${methods[i]}" "${methods[j]}" >"$out.names"
      # The first pair, ours, settles them for all.
      lengths=(--distances "$(awk '/^Tanks/ { on = 1; sub("Tanks and Temples", "") }
          NF == 0 { on = 0 } on { printf "%s%s", sep, $1; sep = "," }' "$out.txt")"
        --cell_size "$(sed -n 's/^ *"cell_size": \([0-9.e+-]*\),$/\1/p' "$out.json")"
        --area_cell_size "$(sed -n 's/^ *"area_cell_size": \([0-9.e+-]*\),$/\1/p' "$out.json")")
    done
  done
}

score_truth() {  # SURVEY MODEL
  local cloud method
  rm -f "$work"/score_*
  [ -n "$1" ] || return 0
  while IFS=, read -r _ method _ _ _ _ _ _ _ cloud _; do
    [ -n "$cloud" ] || continue
    echo "$name: $method against the truth ..." >&2
    "$bin/demo_survey" score --survey_path "$1" --input_path "$2" --cloud_path "$cloud" |
      sed "s/^/$method,/" >>"$work/score_truth.txt"
  done <"$work/rows.csv"
}

measure_model() {  # SET MODEL IMAGES DATABASE SURVEY IMPORTS WORKSPACE
  local csv size
  name_set "$1"
  work=$output/sets/$name
  mkdir -p "$work"
  : >"$work/rows.csv"
  size=$(model_size "$2")
  read -r num_pictures megapixels <<<"$size"
  run_ours partial "$2" "$3" "$4"
  run_ours complete "$2" "$3" "$4"
  scripts/mvs_timings.sh --image_path "$3" --input_path "$2" --output "$work/mvs" \
    --max_image_size "$max_image_size"
  import_rows "$work/mvs/timings.csv" ""
  while read -r csv; do
    [ -z "$csv" ] || import_rows "$csv" " (imported)"
  done <<<"$6"
  compare_clouds
  score_truth "$5" "$2"
  : >"$work/poses.txt"
  [ ! -f "$7/report/run.json" ] || awk '
    /"name": "(feature_extractor|.*_matcher|mapper)"/ { on = 1 }
    /"wall_seconds"/ && on { gsub(/[^0-9.e-]/, "", $2); sum += $2; on = 0 }
    END { if (sum > 0) printf "%.1f\n", sum }' "$7/report/run.json" >"$work/poses.txt"
}

for folder in "${folders[@]}"; do
  images=${images_of[$folder]:-}
  survey=${survey_of[$folder]:-}
  set_name=$(basename "$folder")
  if [ -f "$folder/truth/survey.json" ]; then
    measure_model "$set_name" "$folder/truth/sparse" "$folder/images" "" "$folder" \
      "${imports_of[$folder]:-}" ""
    continue
  fi
  workspace=
  models=("$folder")
  if [ -d "$folder/sparse" ]; then
    workspace=$folder
    models=("$folder"/sparse/*/)
  fi
  [ -n "$images" ] || images=$(workspace_images "$folder")
  [ -d "$images" ] || { echo "$folder: where are its pictures? Give --image_path before it." >&2; exit 1; }
  for model in "${models[@]}"; do
    model=${model%/}
    [ -f "$model/cameras.bin" ] || [ -f "$model/cameras.txt" ] ||
      { echo "$folder: neither a survey, nor a workspace, nor a COLMAP model" >&2; exit 1; }
    [ ${#models[@]} -eq 1 ] || set_name=$(basename "$folder")_$(basename "$model")
    [ -z "$survey" ] || set_name=$(basename "$survey")_$set_name
    measure_model "$set_name" "$model" "$images" "$folder/database.db" "$survey" \
      "${imports_of[$folder]:-}" "$workspace"
  done
done

awk -v output="$output" -f scripts/plots/mvs_tables.awk "$output"/sets/*/rows.csv
cat "$output/mvs.md"
echo
echo "table: $output/mvs.md   rows: $output/mvs.csv $output/pairs.csv"
(cd "$output" && gnuplot "$OLDPWD/scripts/plots/mvs_plots.gp")
echo "plots: $output/mvs_cpu.png $output/mvs_f_score.png"
