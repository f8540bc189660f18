#!/usr/bin/env bash
# scripts/run_mission.sh [--quality Q] [--hours H | --deadline HH:MM] [--pause_on_battery PERCENT]
#                        [--binary FILE] [--jobs N] MISSION_DIR
#
# All dives of a mission, one after another, each from its pictures to cloud, map and report; and
# MISSION_DIR/results/mission.html, a card a dive. Start it again at any time, after a power cut too:
# what is done stays, by what the files hold and not by their dates. New dives may be put in while it
# runs. A dive that fails never stops the others; it is tried again the next time.
#   MISSION_DIR/<dive>/    a dive: its images/, its video/, or else the pictures or clips themselves
#   MISSION_DIR/<dive>/project.ini    options of automatic_reconstructor for that dive alone
#   MISSION_DIR/results/   all that comes out: <dive>/workspace, <dive>/log.txt, mission.html
#   --quality Q            of all dives: field, survey or archive [survey]
#   --hours H, --deadline HH:MM    when it has to be over. Every dive gets a coarse answer first, from
#                          smaller pictures; then, the shortest first, its full one. What runs when the
#                          time is over is stopped, and goes on from there the next time
#   --pause_on_battery P   work waits while the battery is discharged and holds no more than P per cent
#   --binary FILE          colmap_seapoint [this checkout's own, built when missing]
#   --jobs N               so many dives at a time: each takes memory, and most of them one core [1]
# Exit code: 0 all dives are whole; 3 some are not, or coarse, each named with its reason; 1 none came
# out.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
quality=survey
binary=
jobs=1
pause_on_battery=
deadline_option=
deadline_value=
mission=
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --quality | --binary | --jobs | --hours | --deadline | --pause_on_battery)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --quality)
          [[ $2 =~ ^(field|survey|archive)$ ]] ||
            { echo "--quality $2: give field, survey or archive" >&2; exit 2; }
          quality=$2 ;;
        --jobs)
          [[ $2 =~ ^[1-9][0-9]*$ ]] || { echo "--jobs $2: give a number of dives" >&2; exit 2; }
          jobs=$2 ;;
        --hours | --deadline)
          [ "$1" = --deadline ] || [[ $2 =~ ^[0-9]*\.?[0-9]+$ ]] ||
            { echo "--hours $2: give a number of hours" >&2; exit 2; }
          [ -z "$deadline_option" ] || { echo "one of --hours and --deadline" >&2; exit 2; }
          deadline_option=$1 deadline_value=$2 ;;
        --pause_on_battery)
          [[ $2 =~ ^(100|[0-9]{1,2})$ ]] ||
            { echo "--pause_on_battery $2: give per cent, 0 to 100" >&2; exit 2; }
          pause_on_battery=$2 ;;
        --binary) take_binary "$2" ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *)
      [ -z "$mission" ] || { usage; echo "$1: one mission at a time" >&2; exit 2; }
      mission=$1; shift ;;
  esac
done
[ -n "$mission" ] || { usage; exit 2; }
case $mission in /*) ;; *) mission=$called_from/$mission ;; esac
[ -d "$mission" ] ||
  { echo "$mission: no such folder; give the one that holds a folder a dive" >&2; exit 1; }

cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts=$PWD/scripts/mission
export PYTHONDONTWRITEBYTECODE=1
# Debian's own, which knows Debian's packages.
py() {  # SCRIPT [ARGUMENT...]
  local script=$1
  shift
  /usr/bin/python3 "$scripts/$script.py" "$@"
}
deadline=never
if [ -n "$deadline_option" ]; then
  deadline=$(py plan deadline "$deadline_option" "$deadline_value") || exit 2
fi
install_packages snakemake python3-pil
if [ -z "$binary" ]; then
  build colmap_seapoint
  binary=$bin/colmap_seapoint
fi
results=$mission/results
mkdir -p "$results"
exec 9>"$results/lock"
flock --nonblock 9 ||
  { echo "$results: another run_mission.sh is at work here; wait for it, or stop it" >&2; exit 1; }

# Ctrl-C and a shutdown end the dive that runs, which goes on from there the next time.
engine=
follower=
stop() {
  [ -z "$follower" ] || kill "$follower" 2>/dev/null || true
  [ -z "$engine" ] || kill -TERM -- "-$engine" 2>/dev/null || true
  wait || true
  echo "Stopped. The same command goes on from here." >&2
  exit 130
}
trap stop INT TERM HUP
trap '[ -z "$follower" ] || kill "$follower" 2>/dev/null || true' EXIT

run_engine() {  # STEP
  set -m
  SEAPOINT_STEP=$1 SEAPOINT_MISSION=$mission SEAPOINT_BINARY=$binary SEAPOINT_QUALITY=$quality \
    SEAPOINT_SCRIPTS=$scripts SEAPOINT_DEADLINE=$deadline \
    SEAPOINT_PAUSE_ON_BATTERY=$pause_on_battery \
    snakemake --snakefile "$scripts/Snakefile" --directory "$results" --cores "$jobs" \
    --nolock --keep-going --rerun-incomplete --rerun-triggers params --quiet all \
    9>&- >"$results/engine.txt" 2>&1 &
  engine=$!
  set +m
  wait "$engine" && return 0
  engine=
  [ -f "$results/engine.txt" ] || {
    kill "$follower" 2>/dev/null || true
    echo "$mission: is no longer there. Put its disk back; the same command then goes on from here." >&2
    return 1
  }
  echo "$results/engine.txt: the engine failed; what it says there is the reason:" >&2
  tail -n 5 "$results/engine.txt" >&2
  return 1
}

py dives forget_failed "$mission"
before=
dives=$(py dives list "$mission")
[ -n "$dives" ] ||
  { echo "$mission: holds no dive; put each dive's pictures into a folder of its own" >&2; exit 1; }
/usr/bin/python3 "$scripts/dives.py" follow "$mission" 9>&- &
follower=$!
py plan tell "$mission" "$binary" "$quality" "$deadline"
# Once more where something came in meanwhile.
while [ "$before" != "$dives" ]; do
  before=$dives
  [ "$deadline" = never ] || run_engine coarse
  py plan must_stop "$deadline" || run_engine full
  ! py plan must_stop "$deadline" || break
  dives=$(py dives list "$mission")
done
kill "$follower"
wait "$follower" || true
py dives summary "$mission"
