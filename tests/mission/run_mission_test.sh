#!/usr/bin/env bash
# run_mission_test.sh SOURCE_DIR BINARY DEMO_SURVEY: a mission of two dives, an empty folder and
# rubbish, through the real program: answers, exit codes, what is done again and what is not.
set -euo pipefail
source_dir=$1 binary=$2 demo_survey=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export XDG_CACHE_HOME=$folder/cache QT_QPA_PLATFORM=offscreen

fail() { echo "run_mission: $*" >&2; cat "$folder/out" >&2; exit 1; }
run() {  # EXIT_CODE MISSION [OPTION...]
  local expected=$1 mission=$2 status=0
  shift 2
  "$source_dir/scripts/run_mission.sh" --quality field --binary "$binary" "$@" "$mission" \
    >"$folder/out" 2>&1 || status=$?
  [ "$status" -eq "$expected" ] || fail "exit code $status, not $expected"
}
said() { grep -q -e "$1" "$folder/out" || fail "did not say: $1"; }
ended() { sed -n 's/.*"digest": "\(.*\)",/\1/p; s/.*"seconds": \(.*\),/\1/p' "$mission/results/$1/outcome.json"; stat -c %y "$mission/results/$1/outcome.json"; }

"$demo_survey" generate --output_path "$folder/survey" --num_strips 1 --images_per_strip 5 \
  --width 480 --height 360 >/dev/null 2>&1
mission="$folder/our mission"
mkdir -p "$mission/one/images" "$mission/tw ö" "$mission/empty" "$mission/rubbish"
cp "$folder"/survey/images/* "$mission/one/images"
cp "$folder"/survey/images/* "$mission/tw ö"
head -c 2000 /dev/urandom >"$mission/rubbish/dive.jpg"

run 3 "$mission"
said '^one: 5 of 5 pictures used'
said '^tw ö: 5 of 5 pictures used'
said '^empty: FAILED: .*holds no picture'
said '^rubbish: FAILED: .*none of its 1 pictures can be used'
grep -q '2 of 4 dives came out' "$mission/results/mission.html" || fail "the page is wrong"

# Nothing has changed but dates and what nothing depends on: nothing is done again.
one=$(ended one) two=$(ended 'tw ö')
touch "$mission/one/images"/*
run 3 "$mission"
[ "$(ended one)" = "$one" ] || fail "a dive with new dates was made again"

# One picture less: that dive is, and no other.
rm "$(ls -d "$mission"/one/images/* | tail -n 1)"
run 3 "$mission"
said '^one: 4 of 4 pictures used'
[ "$(ended 'tw ö')" = "$two" ] || fail "a dive was made again for another one's sake"

# A dive of its own options; the last that fails goes, and all is well.
rm -r "$mission/empty" "$mission/rubbish"
printf 'min_confidence=2\n' >"$mission/tw ö/project.ini"
run 3 "$mission"
said '^tw ö: FAILED: .*min_confidence'
rm "$mission/tw ö/project.ini"
run 0 "$mission"

# A battery that runs low makes it wait, and changes nothing else.
mkdir -p "$folder/power/BAT0"
for word in type:Battery capacity:15 status:Discharging; do
  echo "${word#*:}" >"$folder/power/BAT0/${word%:*}"
done
rm "$mission/one/images/$(ls "$mission/one/images" | tail -n 1)"
(until grep -q 'The battery holds 15 %: work pauses' "$mission/results/one/log.txt"; do sleep 0.2; done
  echo Charging >"$folder/power/BAT0/status") 2>/dev/null &
charger=$!
SEAPOINT_POWER_SUPPLY=$folder/power run 0 "$mission" --pause_on_battery 20
! kill "$charger" 2>/dev/null || fail "no pause"
grep -q 'work goes on' "$mission/results/one/log.txt" || fail "it did not go on"
said '^one: 3 of 3 pictures used'

# With time enough a new dive ends as without a deadline, by way of a coarse answer.
cp -r "$mission/one" "$mission/three"
run 0 "$mission" --hours 1
grep -q 'three: coarse done' "$mission/results/log.txt" || fail "no coarse answer came first"
! grep -q 'one: coarse' "$mission/results/log.txt" || fail "what is done got a coarse answer"
said '^three: 3 of 3 pictures used'
[ ! -e "$mission/results/three/coarse" ] || fail "the coarse answer was not cleared away"

# The same model in two blocks, once.
blocks() {  # EXIT_CODE [ARGUMENT...]
  local expected=$1 status=0
  shift
  "$source_dir/scripts/densify_blocks.sh" --blocks 2 --threads 1 --binary "$binary" "$@" \
    >"$folder/out" 2>&1 || status=$?
  [ "$status" -eq "$expected" ] || fail "blocks: exit code $status, not $expected"
}
workspace=$mission/results/one/workspace
of_model=(--image_path "$mission/one/images" --input_path "$workspace/sparse/0")
blocks 0 "$folder/in blocks" "${of_model[@]}" --database_path "$workspace/database.db"
said "^$folder/in blocks/fused.ply"
points_of() { head -c 300 "$1" | sed -n 's/^element vertex *\([0-9]*\).*/\1/p'; }
whole=$(points_of "$workspace/dense/0/fused.ply") joined=$(points_of "$folder/in blocks/fused.ply")
[ $((joined * 10)) -gt $((whole * 9)) ] && [ $((joined * 10)) -lt $((whole * 11)) ] ||
  fail "$joined points in blocks, $whole at once"
made=$(stat -c %y "$folder/in blocks"/*/fused.ply)
blocks 0 "$folder/in blocks" "${of_model[@]}" --database_path "$workspace/database.db"
[ "$(stat -c %y "$folder/in blocks"/*/fused.ply)" = "$made" ] || fail "blocks were made again"
blocks 1 "$folder/no blocks" --image_path "$folder/nowhere" --input_path "$workspace/sparse/0"
blocks 2 "$folder/no blocks" "${of_model[@]}" --block 1/2

# Without anything, and without anything good.
mkdir "$folder/nothing"
run 1 "$folder/nothing"
said 'holds no dive'
mkdir "$folder/nothing/empty"
run 1 "$folder/nothing"
run 2 "$mission" --jobs none
run 2 "$mission" --hours soon
run 2 "$mission" --pause_on_battery 101
run 2 "$mission" --deadline 25:00
run 1 "$folder/elsewhere"
said 'no such folder'
echo "run_mission: all as promised"
