#!/usr/bin/env bash
# scripts/demo.sh             installs what is missing, builds, makes the demo survey (a synthetic
#                             seabed with exact truth), reconstructs it and scores the cloud
# scripts/demo.sh IMAGE_DIR   the same on your own pictures, which are only read
#
# Results go to demo_workspace/ in this checkout, or to $SEAPOINT_DEMO_DIR. Run it again to resume.
set -euo pipefail

if [ $# -gt 1 ] || [ "${1:-}" = -h ] || [ "${1:-}" = --help ]; then
  sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  [ $# -eq 1 ] && exit 0 || exit 2
fi
pictures=
if [ $# -eq 1 ]; then
  [ -d "$1" ] || { echo "$1: no such folder; give the folder that holds your pictures" >&2; exit 1; }
  pictures=$(cd "$1" && pwd)
fi

cd "$(dirname "${BASH_SOURCE[0]}")/.."
results=${SEAPOINT_DEMO_DIR:-$PWD/demo_workspace}
scripts/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target colmap_seapoint demo_survey
bin=$PWD/build/release/bin

survey=
name=
if [ -z "$pictures" ]; then
  name=demo
  survey=$results/survey
  if [ ! -f "$survey/complete" ]; then
    echo "Making the demo survey ..." >&2
    "$bin/demo_survey" generate --output_path "$survey"
    touch "$survey/complete"
  fi
  pictures=$survey/images
else
  name=$(basename "$pictures")-$(printf '%s' "$pictures" | cksum | cut -d ' ' -f 1)
fi
workspace=$results/$name

status=0
"$bin/colmap_seapoint" automatic_reconstructor \
  --image_path "$pictures" --workspace_path "$workspace" || status=$?
# 3: done, but some pictures were left out, each named above.
if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then exit "$status"; fi

for dense in "$workspace"/dense/*/; do
  [ -f "$dense/fused.ply" ] || continue
  rm -f "$dense/fused.png"
  "$bin/colmap_seapoint" render_cloud --input_path "$dense/fused.ply" \
    --output_path "$dense/fused.png" --model_path "$workspace/sparse/$(basename "$dense")"
  if [ -n "$survey" ]; then
    echo
    echo "Score against the survey's exact truth:"
    "$bin/demo_survey" score --survey_path "$survey" \
      --input_path "$workspace/sparse/$(basename "$dense")" --cloud_path "$dense/fused.ply" \
      --output_path "$workspace/report/score_$(basename "$dense").json"
  fi
  echo
  echo "cloud:   ${dense}fused.ply   (open it in CloudCompare or MeshLab)"
  echo "picture: ${dense}fused.png   (seen from above: colours, and heights)"
done
echo "report:  $workspace/report/index.html   (open it in a browser)"
exit "$status"
