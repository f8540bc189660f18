#!/usr/bin/env bash
# scripts/sweep_kills.sh [--kills N] [--seed N] [--output DIR] [--binary FILE] [run_mission options]
#
# A small mission of seven dives (two demo surveys, clear and murky, a longer one, AUV strips, a video,
# an empty folder, rubbish) is run by run_mission.sh undisturbed; then from nothing again and again,
# killed with all its processes (SIGKILL) at random moments and started anew until it ends. Each must
# leave the exit code and the bytes of the undisturbed one, and make nothing again that was finished
# before a kill: records of stages and dives stay untouched. What tells of the run itself (times,
# estimates, memory) is left out of account. For before a release.
#   --kills N       so many in all [100]
#   --seed N        of the moments [1]
#   --output DIR    mission, undisturbed results and log.txt [sweep_kills/ in this checkout]
#   --binary FILE   colmap_seapoint to test, default this checkout's own
# AUV strips and video are real ones where the evaluation data is there (SEAPOINT_DATA, default
# ../shared/data), else demo surveys. Ends with exit code 1 when anything did not hold.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
kills=100 seed=1 output= binary= options=(--quality field)
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --*)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --kills) kills=$2 ;;
        --seed) seed=$2 ;;
        --output) output=$2 ;;
        --binary) take_binary "$2" ;;
        *) options+=("$1" "$2") ;;
      esac
      shift 2 ;;
    *) usage; echo "$1: no option" >&2; exit 2 ;;
  esac
done
cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output sweep_kills
install_packages snakemake python3-pil ffmpeg
if [ -n "$binary" ]; then bin=$(dirname "$binary"); else build colmap_seapoint demo_survey; fi
binary=${binary:-$bin/colmap_seapoint}
data=${SEAPOINT_DATA:-$PWD/../shared/data}

folders=()
small=(--width 480 --height 360)
make_survey clear --num_strips 1 --images_per_strip 5 "${small[@]}"
make_survey murky --num_strips 1 --images_per_strip 5 --turbidity 1 --marine_snow 1 "${small[@]}"
make_survey long --num_strips 2 --images_per_strip 5 "${small[@]}"

mission=$output/mission
rm -rf "$mission"
mkdir -p "$mission"/{clear,murky,long,strips,video,empty,rubbish}
for dive in clear murky long; do
  cp -r "$output/surveys/$dive/images" "$mission/$dive/images"
done
if [ -d "$data" ]; then
  mkdir "$mission/strips/images"
  cp "$data/auv_strips/t1/images"/[1-3].tif "$mission/strips/images"
  ffmpeg -loglevel error -i "$data/reef_video/reef_clip.mp4" -t 2 -vf scale=640:-2 \
    "$mission/video/dive.mp4"
else
  make_survey strips --num_strips 2 --images_per_strip 3 "${small[@]}"
  make_survey film --num_strips 1 --images_per_strip 40 --forward_overlap 0.96 "${small[@]}"
  cp -r "$output/surveys/strips/images" "$mission/strips/images"
  ffmpeg -loglevel error -framerate 10 -pattern_type glob -i "$output/surveys/film/images/*" \
    "$mission/video/dive.mp4"
fi
head -c 2000 "$binary" >"$mission/rubbish/dive.jpg"
head -c 9000 "$(ls "$mission/clear/images"/* | head -n 1)" >"$mission/rubbish/torn.jpg"
echo "no picture" >"$mission/rubbish/notes.txt"

# A history of its own: estimates go by what other runs took.
export XDG_CACHE_HOME=$output/cache PYTHONDONTWRITEBYTECODE=1
exec /usr/bin/python3 scripts/mission/sweep_kills.py "$mission" "$output" "$kills" "$seed" \
  "$PWD/scripts/run_mission.sh" --binary "$binary" "${options[@]}" "$mission"
