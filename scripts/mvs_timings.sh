#!/usr/bin/env bash
# scripts/mvs_timings.sh --image_path DIR --input_path MODEL --output DIR [options]
#
# What other programs' multi-view stereo costs on a COLMAP model: COLMAP's patch_match_stereo and
# stereo_fusion where this colmap has CUDA, OpenMVS's DensifyPointCloud where it is on PATH (with
# InterfaceCOLMAP). Undistortion by colmap image_undistorter counts with each of them. Writes
# DIR/timings.csv (method,wall_s,cpu_s,gpu,machine,peak_mb,cloud_path,note), the clouds beside it;
# the note says the size of the pictures that it worked on, or why it could not run. Niceness is that
# of this script. On a machine with CUDA it needs this file
# and benchmark_common.sh only; benchmark_mvs.sh --import DIR/timings.csv takes the figures home
# (with DIR, or without: then without the clouds).
#   --output DIR         results
#   --image_path DIR     the pictures of the model
#   --input_path MODEL   COLMAP model, binary or text
#   --max_image_size N   the longer side, for both programs [-1 = in full]
#   --methods LIST       of colmap, openmvs; separated by commas [colmap,openmvs]
#   --colmap_path FILE   [colmap on PATH]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

output=
image_path=
input_path=
max_image_size=-1
methods=colmap,openmvs
colmap=colmap
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --output | --image_path | --input_path | --max_image_size | --methods | --colmap_path)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --output) output=$2 ;;
        --image_path) image_path=$2 ;;
        --input_path) input_path=$2 ;;
        --max_image_size) max_image_size=$2 ;;
        --methods) methods=$2 ;;
        *) colmap=$2 ;;
      esac
      shift 2 ;;
    *) usage; echo "unknown option $1" >&2; exit 2 ;;
  esac
done
if [ -z "$output" ] || [ -z "$image_path" ] || [ -z "$input_path" ]; then
  usage
  echo "--output, --image_path and --input_path are required" >&2
  exit 2
fi
for folder in "$image_path" "$input_path"; do
  [ -d "$folder" ] || { echo "$folder: no such folder" >&2; exit 1; }
done
export QT_QPA_PLATFORM=offscreen
mkdir -p "$output"
output=$(cd "$output" && pwd)
csv=$output/timings.csv
machine=$(machine_name)
gpu=$(nvidia-smi --query-gpu=name --format=csv,noheader 2>/dev/null | head -n 1 | tr ',' ' ') || gpu=
echo "method,wall_s,cpu_s,gpu,machine,peak_mb,cloud_path,note" >"$csv"

cannot() {  # METHOD REASON
  echo "$1: not run: $2" >&2
  printf '%s,,,%s,%s,,,not run: %s\n' "$1" "$gpu" "$machine" "${2//,/;}" >>"$csv"
}

# Runs the steps of a method one after the other and adds up; false when one of them fails.
total_wall=0 total_cpu=0 total_peak=0
start_method() { total_wall=0 total_cpu=0 total_peak=0; }
step() {  # NAME COMMAND...
  local name=$1
  shift
  echo "$name ..." >&2
  measure_command "$output/$name.log" "$@" || return 1
  total_wall=$(awk "BEGIN { printf \"%.2f\", $total_wall + $wall_s }")
  total_cpu=$(awk "BEGIN { printf \"%.2f\", $total_cpu + $cpu_s }")
  [ -z "$peak_mb" ] || [ "$peak_mb" -le "$total_peak" ] || total_peak=$peak_mb
}
finish_method() {  # METHOD GPU CLOUD NOTE
  [ "$total_peak" -gt 0 ] || total_peak=
  [ -s "$3" ] || { cannot "$1" "it ended without a cloud; see $output/*.log"; return; }
  printf '%s,%s,%s,%s,%s,%s,%s,%s\n' \
    "$1" "$total_wall" "$total_cpu" "$2" "$machine" "$total_peak" "$(basename "$3")" "$4" >>"$csv"
}

undistort() {  # FOLDER
  rm -rf "$1"
  mkdir -p "$1"
  step undistort "$colmap" image_undistorter --image_path "$image_path" --input_path "$input_path" \
    --output_path "$1" --max_image_size "$max_image_size"
}

# Sets longer_side: pixels of the largest of the undistorted pictures in FOLDER.
find_longer_side() {  # FOLDER
  mkdir -p "$1/text"
  "$colmap" model_converter --input_path "$1/sparse" --output_path "$1/text" --output_type TXT \
    >"$output/model_converter.log" 2>&1 || return 1
  longer_side=$(awk '!/^#/ { side = $3 > $4 ? $3 : $4; if (side + 0 > max) max = side + 0 }
    END { print max + 0 }' "$1/text/cameras.txt")
  [ "$longer_side" -gt 0 ]
}

# OpenMVS sets its own niceness, 10 when it is not told otherwise: the name that it has for ours.
openmvs_priority() {
  case $(nice) in
    10) echo -1 ;;
    15) echo -2 ;;
    19) echo -3 ;;
    *) echo 0 ;;
  esac
}

run_colmap() {
  local method="COLMAP patch_match_stereo + stereo_fusion" dense=$output/colmap
  if ! command -v "$colmap" >/dev/null; then
    cannot "$method" "no colmap on PATH"
    return
  fi
  if ! "$colmap" help 2>&1 | grep -q "with CUDA"; then
    cannot "$method" "this colmap was built without CUDA"
    return
  fi
  start_method
  if undistort "$dense" && find_longer_side "$dense" &&
    step patch_match_stereo "$colmap" patch_match_stereo --workspace_path "$dense" &&
    step stereo_fusion "$colmap" stereo_fusion --workspace_path "$dense" \
      --output_path "$output/colmap.ply"; then
    finish_method "$method" "${gpu:-unknown}" "$output/colmap.ply" "longer side $longer_side px"
  else
    cannot "$method" "a step failed; see $output/*.log"
  fi
  rm -rf "$dense"
}

run_openmvs() {
  local method="OpenMVS DensifyPointCloud" dense=$output/openmvs program
  for program in "$colmap" InterfaceCOLMAP DensifyPointCloud; do
    command -v "$program" >/dev/null || { cannot "$method" "no $program on PATH"; return; }
  done
  start_method
  # Level 0 alone is not full resolution: what is larger than --max-resolution (2560) is shrunk.
  if undistort "$dense" && find_longer_side "$dense" &&
    step InterfaceCOLMAP InterfaceCOLMAP -w "$dense" -i "$dense" -o "$dense/scene.mvs" \
      --image-folder "$dense/images" --process-priority "$(openmvs_priority)" &&
    step DensifyPointCloud DensifyPointCloud -w "$dense" -i "$dense/scene.mvs" \
      -o "$dense/scene_dense.mvs" --resolution-level 0 --max-resolution "$longer_side" \
      --process-priority "$(openmvs_priority)"; then
    [ ! -f "$dense/scene_dense.ply" ] || mv "$dense/scene_dense.ply" "$output/openmvs.ply"
    finish_method "$method" "" "$output/openmvs.ply" "longer side $longer_side px"
  else
    cannot "$method" "a step failed; see $output/*.log"
  fi
  rm -rf "$dense"
}

case ,$methods, in *,colmap,*) run_colmap ;; esac
case ,$methods, in *,openmvs,*) run_openmvs ;; esac
echo "timings: $csv" >&2
