#!/usr/bin/env bash
# scripts/check_disks.sh [--moments N] [--seed S] [--output DIR] [--binary FILE] [OPTION...]
#
# Whether a reconstruction outlives its disk: N times the disk is filled up by somebody else, and N
# times it is pulled, at random moments of a run. Pictures and workspace are on a small ext4 of its
# own (a loop device, so as root). Each time the run has to end by itself with a line that says what
# happened and what to do; then room is made, or the disk put back (its journal replayed, what was
# not yet on it lost), and the same command has to end with the bytes of an undisturbed run: clouds,
# models, maps, tables, database rows. Prints a line a moment, exits 1 when any of that did not hold.
#   --moments N    of each kind [10]
#   --seed S       of the moments [1]
#   --output DIR   for the disk's image and the logs [build/check_disks]
#   --binary FILE  colmap_seapoint [this checkout's own, built when missing]
#   OPTION...      of demo_survey generate, in place of a strip of five small pictures
# Every second time that the disk is filled the run does not watch it (--check_disk 0), and meets the
# full disk in the middle of a file.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
moments=10
seed=1
output=
binary=
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --moments | --seed | --output | --binary)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      case $1 in
        --moments) moments=$2 ;;
        --seed) seed=$2 ;;
        --output) output=$2 ;;
        --binary) take_binary "$2" ;;
      esac
      shift 2 ;;
    *) break ;;
  esac
done
[ $# -gt 0 ] || set -- --num_strips 1 --images_per_strip 5 --width 640 --height 480
[ "$(id -u)" -eq 0 ] || { echo "loop devices are root's: run this as root" >&2; exit 1; }
cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output build/check_disks
install_packages sqlite3 e2fsprogs
if [ -z "$binary" ]; then
  build colmap_seapoint
  binary=$bin/colmap_seapoint
fi
build demo_survey
folders=()
make_survey small "$@"
disk=$output/disk
image=$output/disk.img
device=

put_in() {
  device=$(losetup --find --show "$image")
  mount "$device" "$disk"
}
# Where the disk was pulled the mount is of a device that is no more.
take_out() {
  [ -n "$device" ] || return 0
  umount "$disk" 2>/dev/null || umount --lazy "$disk"
  losetup --detach "$device"
  device=
  while losetup --associated "$image" | grep -q .; do sleep 0.1; done
}
# From now on the device has no more than its first block: all reading and writing beyond fails.
pull_out() {
  python3 - "$device" <<'END'
import fcntl, struct, sys
GET, SET, SIZE_LIMIT = 0x4C05, 0x4C04, 32  # of struct loop_info64
with open(sys.argv[1], "rb") as device:
    info = bytearray(232)
    fcntl.ioctl(device, GET, info)
    struct.pack_into("<Q", info, SIZE_LIMIT, 4096)
    fcntl.ioctl(device, SET, info)
END
}
trap 'take_out || true' EXIT

reconstruct() {  # LOG OPTION...
  local log=$1
  shift
  "$binary" automatic_reconstructor --image_path "$disk/images" --workspace_path "$disk/ws" "$@" \
    >"$log" 2>&1
}
sums() {  # FILE
  { workspace_sums "$disk/ws"; cd "$disk/ws"; find map -type f | LC_ALL=C sort |
    grep -v '\.json$' | xargs sha256sum; } >"$1"
}
fresh_disk() {
  take_out
  cp --sparse=always "$output/fresh.img" "$image"
  put_in
}
now() { date +%s.%N; }

mkdir -p "$disk"
umount --lazy "$disk" 2>/dev/null || true
rm -f "$output/fresh.img" "$image"
truncate -s 400M "$image"
mkfs.ext4 -q -F "$image"
put_in
cp -r "$output/surveys/small/images" "$disk/images"
take_out
cp --sparse=always "$image" "$output/fresh.img"
put_in
began=$(now)
reconstruct "$output/undisturbed.log" || { tail -n 3 "$output/undisturbed.log" >&2; exit 1; }
seconds=$(awk "BEGIN { print $(now) - $began }")
(sums "$output/undisturbed.sums")
echo "Undisturbed: $seconds s, $(du -sm "$disk/ws" | cut -f 1) MB," \
  "$(wc -l <"$output/undisturbed.sums") files and tables"

failed=0
RANDOM=$seed
moment() {  # KIND NUMBER [OPTION...]
  local name=$1_$2 kind=$1 status=0 at run verdict last
  shift 2
  at=$(awk "BEGIN { printf \"%.2f\", $seconds * $((RANDOM % 1000)) / 1000 }")
  fresh_disk
  reconstruct "$output/$name.log" "$@" &
  run=$!
  sleep "$at"
  if [ "$kind" = full ]; then dd if=/dev/zero of="$disk/others" bs=64k 2>/dev/null || true
  else pull_out; fi
  wait "$run" || status=$?
  last=$(tail -n 1 "$output/$name.log")
  verdict=
  if [ "$status" -eq 0 ]; then last="came to its end"
  elif [[ $last != error:*\;* || $last == *internal* ]]; then verdict="BAD LINE"; fi
  if [ "$kind" = full ]; then rm -f "$disk/others"
  else take_out; put_in; fi
  if ! reconstruct "$output/$name.again.log"; then
    verdict="DOES NOT GO ON: $(tail -n 1 "$output/$name.again.log")"
  else
    (sums "$output/$name.sums")
    diff "$output/undisturbed.sums" "$output/$name.sums" >"$output/$name.diff" ||
      verdict="OTHER BYTES, see $output/$name.diff"
  fi
  [ -z "$verdict" ] || failed=1
  echo "$name at $at s: ${verdict:-same bytes}; $last"
}
for ((i = 1; i <= moments; ++i)); do
  if ((i % 2)); then moment full "$i"; else moment full "$i" --check_disk 0; fi
done
for ((i = 1; i <= moments; ++i)); do moment pulled "$i"; done
exit $failed
