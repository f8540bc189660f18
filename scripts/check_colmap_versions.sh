#!/usr/bin/env bash
# scripts/check_colmap_versions.sh [--binary FILE] [--pictures DIR]... [WORK_DIR]
#
# One program of ours against the COLMAPs that people have: the one of this machine (Debian 12: 3.8)
# and those of Debian 13 (3.10) and sid (4.x), each in a chroot below WORK_DIR that is made from
# Debian's archive when it is not there (0.7 to 1 GB each). Nothing of ours is built again for
# them: the COLMAP of a chroot is called by a wrapper, WORK_DIR/bin/SUITE/colmap, which can also be
# given to any other run (--colmap_path).
#   --binary FILE    colmap_seapoint to test [this checkout's own]
#   --pictures DIR   pictures of yours for the chain, beside the demo survey; may be repeated
#   WORK_DIR         chroots, workspaces, chain.csv and versions.md [build/colmap_versions]
# Runs the chain (automatic_reconstructor, field and survey) on the demo survey and on your pictures
# with each COLMAP; on a small survey has each open our database and ours open its database and
# models; maps one workspace with one COLMAP after the other; and runs the suite's own tests of
# COLMAP's tools with each. Rows that are in chain.csv already are kept. Ends with 1 when something
# did not hold. Needs root, for chroot. Half an hour on two cores, half of it downloads.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/benchmark_common.sh"

called_from=$PWD
output=
binary=
pictures=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --binary | --pictures)
      [ $# -ge 2 ] || { usage; echo "$1 needs a value" >&2; exit 2; }
      [ -e "$2" ] || { echo "$2: there is no such thing; $1 takes a path" >&2; exit 1; }
      case $1 in
        --binary) binary=$(realpath "$2") ;;
        --pictures) pictures+=("$(realpath "$2")") ;;
      esac
      shift 2 ;;
    -*) usage; echo "unknown option $1" >&2; exit 2 ;;
    *) output=$1; shift ;;
  esac
done
[ "$(id -u)" -eq 0 ] || { echo "chroot needs root: run this with sudo" >&2; exit 1; }

cd "$(dirname "${BASH_SOURCE[0]}")/.."
make_output build/colmap_versions
install_packages time debootstrap
build demo_survey colmap_seapoint io_test e2e_test
binary=${binary:-$bin/colmap_seapoint}
export QT_QPA_PLATFORM=offscreen
versions=(host trixie sid)
csv=$output/chain.csv
md=$output/versions.md
num_failed=0

# ---- The COLMAPs

make_chroot() {  # SUITE
  local root=$output/$1 log=$output/$1.log
  [ ! -x "$root/usr/bin/colmap" ] || return 0
  echo "Making a chroot of Debian $1 with its COLMAP in $root ..." >&2
  rm -rf "$root"
  { debootstrap --variant=minbase "$1" "$root" http://deb.debian.org/debian &&
    chroot "$root" env DEBIAN_FRONTEND=noninteractive sh -c '
      late=-oAcquire::Check-Valid-Until=false  # a mirror that is kept as a snapshot
      apt-get $late update && apt-get $late install -y --no-install-recommends colmap && apt-get clean &&
      rm -rf /var/lib/apt/lists/*'; } >"$log" 2>&1 ||
    { echo "$1: debootstrap failed, see $log" >&2; exit 1; }
}

# Every folder of this machine that holds data is bound into the chroot under its own name, in a
# mount namespace of this one call: paths are the same inside, and no mount is left behind.
write_wrapper() {  # VERSION
  local wrapper=$output/bin/$1/colmap
  mkdir -p "${wrapper%/*}"
  if [ "$1" = host ]; then
    ln -sf "$(command -v colmap)" "$wrapper"
    return
  fi
  cat >"$wrapper" <<WRAPPER
#!/bin/sh
exec unshare --mount sh -c '
  root=\$1
  for dir in /*; do
    case \$dir in
      /bin | /boot | /etc | /lib* | /run | /sbin | /usr | /var | /lost+found) continue ;;
    esac
    [ -d "\$dir" ] || continue
    mkdir -p "\$root\$dir" && mount --rbind "\$dir" "\$root\$dir" || exit 125
  done
  shift
  exec chroot "\$root" env --chdir="\$PWD" /usr/bin/colmap "\$@"' colmap "$output/$1" "\$@"
WRAPPER
  chmod +x "$wrapper"
}

colmap_of() {  # VERSION ARGUMENT...
  "$output/bin/$1/colmap" "${@:2}"
}

# "4.2.1", as the program itself says.
number_of() {  # VERSION
  colmap_of "$1" help 2>&1 | sed -n 's/^COLMAP \([0-9.]*\).*/\1/p' | head -n 1
}

# ---- The chain

# "registered,points,error_px" of each model, joined by " + ".
describe_models() {  # VERSION SPARSE
  local model analysis registered='' points='' error=''
  for model in "$2"/*/; do
    analysis=$(colmap_of "$1" model_analyzer --path "$model" 2>&1) || return 1
    registered+=" + $(analyzed "$analysis" 'Registered images')"
    points+=" + $(analyzed "$analysis" 'Points')"
    error+=" + $(analyzed "$analysis" 'Mean reprojection error')"
  done
  echo "${registered# + },${points# + },${error# + }"
}

# The figures of demo_survey score: centres in mm, within 4 GSD and covered in %; empty elsewhere.
score() {  # SET_FOLDER WORKSPACE
  local text
  [ -d "$1/truth" ] || { echo ",,"; return; }
  text=$("$bin/demo_survey" score --survey_path "$1" --input_path "$2/sparse/0" \
    --cloud_path "$2/dense/0/fused.ply")
  echo "$(score_figure "$text" "camera centres, RMS"),$(score_figure "$text" "points within 4 GSD"),$(score_figure "$text" "of it with a point within 4 GSD")"
}

run_chain() {  # VERSION SET_FOLDER QUALITY
  local set=${2##*/} images=$2 workspace status=0 models report
  [ "$set" != images ] || { set=${2%/images}; set=${set##*/}; }
  [ ! -d "$2/images" ] || images=$2/images
  workspace=$output/work/$1/$set.$3
  ! grep -q "^$(number_of "$1"),$set,$3," "$csv" || return 0
  rm -rf "$workspace"
  mkdir -p "$workspace"
  measure_command "$workspace.log" "$binary" automatic_reconstructor --quality "$3" \
    --colmap_path "$output/bin/$1/colmap" --image_path "$images" --workspace_path "$workspace" ||
    status=$?
  if [ "$status" -ne 0 ] && [ "$status" -ne 3 ]; then
    fail "chain, $set, $3" "$1" "exit code $status: $(tail -n 1 "$workspace.log")"
    return 0
  fi
  report=$workspace/report/run.json
  models=$(describe_models "$1" "$workspace/sparse")
  echo "$(number_of "$1"),$set,$3,$(find "$images" -maxdepth 1 -type f | wc -l),$models,$(stage_cpu "$report" feature_extractor),$(stage_cpu "$report" exhaustive_matcher sequential_matcher),$(stage_cpu "$report" mapper),$(stage_cpu "$report" partial_densifier),$(score "$2" "$workspace")" >>"$csv"
  tail -n 1 "$csv" >&2
}

# ---- Files of one opened by another

fail() {  # CHECK VERSION TEXT
  num_failed=$((num_failed + 1))
  echo "| $1 | $2 | **fails**: ${3//|/ } |" | tee -a "$md" >&2
}

holds() {  # CHECK VERSION TEXT
  echo "| $1 | $2 | $3 |" | tee -a "$md" >&2
}

# Runs a command that must end with that code; its output is in $log.
log=
must_end() {  # CODE CHECK VERSION COMMAND...
  local wanted=$1 check=$2 version=$3 code=0
  log=$output/work/log
  timeout 600 "${@:4}" >"$log" 2>&1 || code=$?
  [ "$code" -ne "$wanted" ] || return 0
  cp "$log" "$output/work/failed_$((num_failed + 1)).log"
  fail "$check" "$version" "exit code $code: $(grep -v '^$' "$log" | tail -n 1)"
  return 1
}

rows() {  # DATABASE TABLE
  sqlite3 "$1" "SELECT count(*) FROM $2"
}

num_registered() {  # VERSION SPARSE
  analyzed "$(colmap_of "$1" model_analyzer --path "$2/0" 2>&1)" 'Registered images'
}

# Maps a copy of DATABASE with a version and reports how many pictures it registered.
map_copy() {  # CHECK VERSION DATABASE IMAGES
  local folder=$output/work/map registered
  rm -rf "$folder"
  mkdir -p "$folder/sparse"
  cp "$3" "$folder/database.db"
  must_end 0 "$1" "$2" "$output/bin/$2/colmap" mapper --database_path "$folder/database.db" \
    --image_path "$4" --output_path "$folder/sparse" --Mapper.min_model_size 3 \
    --Mapper.init_min_tri_angle 4 || return 0
  registered=$(num_registered "$2" "$folder/sparse")
  [ "${registered:-0}" -ge 3 ] || { fail "$1" "$2" "registers ${registered:-no} pictures"; return 0; }
  holds "$1" "$2" "$registered pictures registered"
}

# A project of COLMAP's own: SIFT of the small survey, matches, a model, also as text.
make_sift_project() {  # VERSION
  local folder=$output/work/$1/sift gpu
  rm -rf "$folder"
  mkdir -p "$folder/sparse" "$folder/text"
  gpu=$(colmap_option "$output/bin/$1/colmap" feature_extractor 0 SiftExtraction.use_gpu FeatureExtraction.use_gpu)
  # shellcheck disable=SC2086 # two words
  must_end 0 "SIFT project" "$1" "$output/bin/$1/colmap" feature_extractor \
    --database_path "$folder/database.db" --image_path "$small/images" \
    --ImageReader.single_camera 1 --SiftExtraction.max_num_features 1500 $gpu || return 1
  gpu=$(colmap_option "$output/bin/$1/colmap" exhaustive_matcher 0 SiftMatching.use_gpu FeatureMatching.use_gpu)
  # shellcheck disable=SC2086
  must_end 0 "SIFT project" "$1" "$output/bin/$1/colmap" exhaustive_matcher \
    --database_path "$folder/database.db" $gpu || return 1
  must_end 0 "SIFT project" "$1" "$output/bin/$1/colmap" mapper --database_path "$folder/database.db" \
    --image_path "$small/images" --output_path "$folder/sparse" --Mapper.min_model_size 3 \
    --Mapper.init_min_tri_angle 4 || return 1
  must_end 0 "SIFT project" "$1" "$output/bin/$1/colmap" model_converter --input_path "$folder/sparse/0" \
    --output_path "$folder/text" --output_type TXT || return 1
}

# Their database takes in pictures of ours, loses nothing, and is mapped by them afterwards.
extend_database() {  # VERSION
  local check="our pictures into its database" folder=$output/work/extend table before=() i=0
  local tables=(cameras images keypoints descriptors matches two_view_geometries)
  rm -rf "$folder"
  mkdir -p "$folder"
  cp "$output/work/$1/sift/database.db" "$folder/database.db"
  for table in "${tables[@]}"; do before+=("$(rows "$folder/database.db" "$table")"); done
  must_end 0 "$check" "$1" "$binary" feature_extractor --database_path "$folder/database.db" \
    --image_path "$second/images" || return 0
  must_end 3 "$check" "$1" "$binary" exhaustive_matcher --database_path "$folder/database.db" ||
    return 0  # 3: theirs have no SeaPoints
  for table in "${tables[@]}"; do
    if [ "$(rows "$folder/database.db" "$table")" -le "${before[$i]}" ]; then
      fail "$check" "$1" "no row was added to $table"
      return 0
    fi
    i=$((i + 1))
  done
  if [ "$(sqlite3 "$folder/database.db" 'PRAGMA integrity_check; PRAGMA foreign_key_check')" != ok ]; then
    fail "$check" "$1" "the database is not sound"
    return 0
  fi
  map_copy "$check" "$1" "$folder/database.db" "$small/images"
}

# Our database, written by our matchers, in a version's tools.
open_ours() {  # VERSION
  local folder=$output/work/ours_of_$1 database=$output/work/ours/database.db
  map_copy "our database mapped" "$1" "$database" "$small/images"
  rm -rf "$folder"
  mkdir -p "$folder"
  cp "$database" "$folder/a.db"
  cp "$output/work/$1/sift/database.db" "$folder/b.db"
  sqlite3 "$folder/b.db" "UPDATE images SET name = 'theirs/' || name"
  if must_end 0 "our database merged with its own" "$1" "$output/bin/$1/colmap" database_merger \
    --database_path1 "$folder/a.db" --database_path2 "$folder/b.db" \
    --merged_database_path "$folder/merged.db"; then
    holds "our database merged with its own" "$1" "$(rows "$folder/merged.db" images) pictures, $(rows "$folder/merged.db" "two_view_geometries WHERE rows > 0") pairs"
  fi
  if must_end 0 "its cleaner on our database" "$1" "$output/bin/$1/colmap" database_cleaner \
    --database_path "$folder/a.db" --type all; then
    holds "its cleaner on our database" "$1" "$(rows "$folder/a.db" images) pictures, $(rows "$folder/a.db" seapoint_descriptors) descriptors of ours left"
  fi
}

num_points() {  # CLOUD
  sed -n 's/^element vertex //p;/^end_header/q' "$1" | head -n 1
}

# Its model, binary and text, densified by us, scaled by us and read again by it.
read_models() {  # VERSION
  local folder=$output/work/$1/models sift=$output/work/$1/sift form source binary_points='' points
  rm -rf "$folder"
  mkdir -p "$folder"
  for form in binary text; do
    source=$sift/text
    [ "$form" = text ] || source=$sift/sparse/0
    must_end 0 "its $form model densified" "$1" "$binary" partial_densifier \
      --image_path "$small/images" --input_path "$source" --output_path "$folder/$form" \
      --PartialDensification.write_maps 1 || continue
    points=$(num_points "$folder/$form/fused.ply")
    if [ "$points" -lt 10000 ] || [ "$points" != "${binary_points:-$points}" ]; then
      fail "its $form model densified" "$1" "$points points"
      continue
    fi
    binary_points=$points
    holds "its $form model densified" "$1" "$points points, files $(cd "$source" && echo *)"
    must_end 0 "its $form model scaled" "$1" "$binary" model_scaler --input_path "$source" \
      --output_path "$folder/scaled_$form" --positions_path "$output/work/positions.csv" || continue
    must_end 0 "its $form model scaled" "$1" "$output/bin/$1/colmap" model_analyzer \
      --path "$folder/scaled_$form" || continue
    holds "its $form model scaled" "$1" "read again: $(analyzed "$(cat "$log")" 'Registered images') pictures, error $(analyzed "$(cat "$log")" 'Mean reprojection error')"
  done
  must_end 0 "our depth maps fused by it" "$1" "$output/bin/$1/colmap" stereo_fusion \
    --workspace_path "$folder/binary" --StereoFusion.min_num_pixels 2 \
    --output_path "$folder/fused_by_colmap.ply" || return 0
  holds "our depth maps fused by it" "$1" "$(num_points "$folder/fused_by_colmap.ply") points"
}

# The suite's tests that call "colmap", with this one on PATH.
run_suite() {  # VERSION
  local check="tests of its tools" test
  for test in 'io_test ColmapBinary.*' 'e2e_test InstalledColmap.*'; do
    must_end 0 "$check" "$1" env PATH="$output/bin/$1:$PATH" "$bin/${test% *}" \
      --gtest_filter="${test#* }" || continue
    holds "$check" "$1" "${test% *}: $(sed -n 's/^\[  PASSED  \] //p' "$log")"
  done
}

# A workspace that one version has mapped is mapped anew by another, and by the first again.
change_colmap() {
  local folder=$output/work/changed version
  rm -rf "$folder"
  mkdir -p "$folder"
  for version in host sid trixie host; do
    must_end 0 "one workspace after the other COLMAP" "$version" "$binary" automatic_reconstructor \
      --colmap_path "$output/bin/$version/colmap" --image_path "$small/images" \
      --workspace_path "$folder" || continue
    holds "one workspace after the other COLMAP" "$version" \
      "$(num_registered "$version" "$folder/sparse") pictures"
  done
}

# The table of --positions_path: -R^T t of a survey's true poses.
true_positions() {  # SURVEY
  echo "image,x,y,z"
  awk '/^#/ { next } NF == 10 && $10 ~ /[.]jpg$/ {
    w = $2; x = $3; y = $4; z = $5
    printf "%s,%.9g,%.9g,%.9g\n", $10,
      -(1 - 2 * (y * y + z * z)) * $6 - 2 * (x * y + w * z) * $7 - 2 * (x * z - w * y) * $8,
      -2 * (x * y - w * z) * $6 - (1 - 2 * (x * x + z * z)) * $7 - 2 * (y * z + w * x) * $8,
      -2 * (x * z + w * y) * $6 - 2 * (y * z - w * x) * $7 - (1 - 2 * (x * x + y * y)) * $8
  }' "$1/truth/sparse/images.txt"
}

# ---- All of it

for version in "${versions[@]}"; do
  [ "$version" = host ] || make_chroot "$version"
  write_wrapper "$version"
done
mkdir -p "$output/work"
small=$output/surveys/small
second=$output/surveys/second
make_survey demo
make_survey small --num_strips 1 --images_per_strip 6 --width 680 --height 512
make_survey second --num_strips 1 --images_per_strip 4 --width 680 --height 512 --seed 2
# Names of its own, so that both surveys fit into one database.
for picture in "$second"/images/seabed_*; do
  [ ! -f "$picture" ] || mv "$picture" "${picture/seabed_/second_}"
done

{
  echo "| check | COLMAP | outcome |"
  echo "|---|---|---|"
} >"$md"
[ -f "$csv" ] ||
  echo "colmap,set,quality,pictures,registered,points,error_px,features_s,matching_s,mapper_s,dense_s,centres_mm,within_4_gsd_pct,covered_pct" >"$csv"

rm -rf "$output/work/ours"
mkdir -p "$output/work/ours"
for command in feature_extractor exhaustive_matcher; do
  images=()
  [ "$command" != feature_extractor ] || images=(--image_path "$small/images")
  must_end 0 "our database" ours "$binary" "$command" \
    --database_path "$output/work/ours/database.db" "${images[@]}"
done
true_positions "$small" >"$output/work/positions.csv"

for version in "${versions[@]}"; do
  make_sift_project "$version" || continue
  extend_database "$version"
  open_ours "$version"
  read_models "$version"
  run_suite "$version"
done
change_colmap
for version in "${versions[@]}"; do
  for set in "$output/surveys/demo" ${pictures[@]+"${pictures[@]}"}; do
    for quality in field survey; do run_chain "$version" "$set" "$quality"; done
  done
done

{
  echo
  awk -F, '
    NR == 1 {
      print "| COLMAP | pictures of | quality | registered | points | error, px | CPU s: features | matching | mapper | dense | centres, mm | within 4 GSD, % | covered, % |"
      print "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
      next
    }
    { printf "| %s | %s | %s | %s of %s |", $1, $2, $3, $5, $4
      for (i = 6; i <= 14; ++i) printf " %s |", $i == "" ? "–" : $i
      print "" }' "$csv"
} >>"$md"
cat "$md"
[ "$num_failed" -eq 0 ] || { echo "$num_failed checks failed; outputs in $output/work/failed_*.log" >&2; exit 1; }
