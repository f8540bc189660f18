#!/usr/bin/env bash
# scripts/densify_blocks.sh [--blocks N] [--slurm | --jobs N] [--threads N] [--binary FILE]
#                           OUTPUT_DIR --image_path DIR --input_path MODEL [OPTION VALUE]...
#
# partial_densifier in blocks, and one cloud of them: OUTPUT_DIR/fused.ply. What follows OUTPUT_DIR is
# partial_densifier's. Start it again at any time: blocks that are whole are not made again.
#   --blocks N      parts of the track [4]
#   --slurm         each block is a job of the Slurm cluster that this machine submits to; folders and
#                   program must be there on its nodes under the same names
#   --jobs N        without it: so many blocks at a time on this machine [1]
#   --threads N     of a block [all of this machine's]
#   --binary FILE   colmap_seapoint [this checkout's own, built when missing]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
blocks=4
jobs=1
threads=$(nproc)
binary=
output=
where=()
while [ $# -gt 0 ] && [ -z "$output" ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --slurm) where=(--profile "$(realpath "$(dirname "${BASH_SOURCE[0]}")")/mission/slurm"); shift ;;
    --blocks | --jobs | --threads)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || { echo "$1 ${2:-}: give a number" >&2; exit 2; }
      declare "${1#--}=$2"
      shift 2 ;;
    --binary)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      take_binary "$2"
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) output=$1; shift ;;
  esac
done
[ -n "$output" ] && [ $# -gt 0 ] || { usage; exit 2; }
[ ${#where[@]} -gt 0 ] || where=(--cores "$((jobs * threads))")

# Paths are those of the folder that it was started in; the blocks run in another one.
arguments=() digest=
while [ $# -gt 0 ]; do
  case $1 in
    --output_path | --block | --num_threads) echo "$1 is set for each block" >&2; exit 2 ;;
    --*_path)
      [ -e "${2:-}" ] || { echo "$1 ${2:-}: there is no such file or folder" >&2; exit 1; }
      set -- "$1" "$(realpath "$2")" "${@:3}"
      # Names, sizes and dates of all that it holds.
      digest+=$(find -L "$2" -type f -printf '%P %s %T@\n' | LC_ALL=C sort | md5sum) ;;
  esac
  arguments+=("$1" "${2:?$1 needs a value}")
  shift 2
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
install_packages snakemake
if [ -z "$binary" ]; then
  build colmap_seapoint
  binary=$bin/colmap_seapoint
fi
snakefile=$PWD/scripts/mission/blocks.smk
cd "$called_from"
mkdir -p "$output"
export PYTHONDONTWRITEBYTECODE=1 SEAPOINT_BLOCKS=$blocks SEAPOINT_THREADS=$threads SEAPOINT_BINARY=$binary
export SEAPOINT_ARGUMENTS=${arguments[*]@Q}
SEAPOINT_DIGEST=$(printf '%s\n' "$digest" "${arguments[@]}" | cat - "$binary" | md5sum)
export SEAPOINT_DIGEST
snakemake --snakefile "$snakefile" --directory "$output" "${where[@]}" --rerun-incomplete \
  --rerun-triggers params --quiet all >&2
echo "$(realpath "$output")/fused.ply"
