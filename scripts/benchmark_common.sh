# What the benchmarks, the checks and run_mission.sh share; they source it. No program of its own.

# The comment at the head of the script that was started.
usage() {
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2
}

# Sets $binary to the colmap_seapoint that --binary names.
take_binary() {  # FILE
  [ -x "$1" ] || { echo "$1: no such program; give colmap_seapoint" >&2; exit 1; }
  binary=$(realpath "$1")
}

# "$output" as an absolute path; `$called_from` is where the script was started, its default the
# folder DEFAULT in this checkout. Makes it and its sets/.
make_output() {  # DEFAULT
  [ -n "$output" ] || output=$PWD/$1
  case $output in /*) ;; *) output=$called_from/$output ;; esac
  mkdir -p "$output/sets"
}

install_packages() {  # PACKAGE...
  local package as_root=() missing=()
  for package in "$@"; do
    [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "${missing[*]} missing; run this as root" >&2; exit 1; }
    as_root=(sudo)
  fi
  echo "Installing: ${missing[*]}" >&2
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# Installs what the build needs and builds; sets $bin.
build() {  # TARGET...
  scripts/setup.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target "$@"
  bin=$PWD/build/release/bin
}

# Adds a demo survey to $folders; made when it is not complete.
make_survey() {  # NAME OPTION...
  local survey=$output/surveys/$1
  folders+=("$survey")
  [ ! -f "$survey/complete" ] || return 0
  echo "Making the survey $1 ..." >&2
  shift
  "$bin/demo_survey" generate --output_path "$survey" "$@"
  touch "$survey/complete"
}

# Sets $name to the text as part of a file name, different from all before.
declare -A taken=()
name_set() {  # TEXT
  name=$(printf '%s' "$1" | tr -c 'A-Za-z0-9._\n-' _)
  while [ -n "${taken[$name]:-}" ]; do name=${name}_; done
  taken[$name]=1
}

# The pictures that a workspace was made from: what its own report says.
workspace_images() {  # WORKSPACE
  local report
  for report in "$1"/dense/*/run.json "$1"/*.run.json; do
    [ -f "$report" ] || continue
    sed -n 's/^ *"image_path": "\(.*\)",\{0,1\}$/\1/p' "$report" | head -n 1
    return
  done
}

# Everything of a workspace that must not change, one hash a line.
workspace_sums() (  # WORKSPACE
  cd "$1"
  find . -type f \( -name 'fused.ply*' -o -name '*.bin' -o -name '*.cfg' \) | LC_ALL=C sort |
    xargs sha256sum
  find . -name pairs.csv | LC_ALL=C sort | while read -r file; do
    cut -d , -f 1-11,15- "$file" | sha256sum | sed "s|-|$file|"
  done
  for table in $(sqlite3 database.db "SELECT name FROM sqlite_master WHERE type = 'table'
      AND name NOT LIKE 'sqlite_%' ORDER BY name"); do
    columns=$(sqlite3 database.db "SELECT group_concat('quote(' || name || ')') FROM
      pragma_table_info('$table') WHERE name NOT LIKE '%hash%' AND name NOT LIKE '%fingerprint%'")
    sqlite3 database.db "SELECT $columns FROM $table ORDER BY 1" | sha256sum | sed "s|-|$table|"
  done
)

# Runs a command, its output into LOG. Sets wall_s, cpu_s (user + system, children included) and
# peak_mb (the largest process; empty without GNU time), and returns what the command returned.
measure_command() {  # LOG COMMAND...
  local log=$1 figures status=0
  shift
  figures=$(mktemp)
  if [ -x /usr/bin/time ]; then
    /usr/bin/time -q -o "$figures" -f '%e %U %S %M' "$@" >"$log" 2>&1 || status=$?
  else
    { TIMEFORMAT='%R %U %S'; time "$@" >"$log" 2>&1; } 2>"$figures" || status=$?
  fi
  read -r wall_s cpu_s peak_mb < <(tail -n 1 "$figures" |
    awk '{ printf "%.2f %.2f %s\n", $1, $2 + $3, (NF > 3) ? sprintf("%.0f", $4 / 1024) : "" }')
  rm -f "$figures"
  return $status
}

# "Intel(R) Xeon(R) @ 2.3 GHz; 2 cores; 24 GB"; nothing that a CSV takes for a separator.
machine_name() {
  local model
  model=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1 | tr ',"' '  ' | tr -s ' ')
  printf '%s; %s cores; %s GB' "${model:-$(uname -m)}" "$(nproc)" \
    "$(awk '/^MemTotal/ { printf "%.0f", $2 / 1048576 }' /proc/meminfo)"
}

# CPU seconds of the stages of those names, in all their runs.
stage_cpu() {  # RUN_JSON NAME...
  awk -v names=" ${*:2} " '
    /"name":/ { name = $2; gsub(/[",]/, "", name); found = index(names, " " name " ") > 0 }
    /"cpu_seconds":/ && found { sub(",", "", $2); sum += $2; found = 0 }
    END { printf "%.1f", sum }' "$1"
}

# "--Group.option value" under the first of the names that this COLMAP's command knows; nothing
# where it knows none: names change between versions.
colmap_option() {  # COLMAP COMMAND VALUE NAME...
  local help name
  help=$("$1" "$2" -h 2>&1)
  for name in "${@:4}"; do
    if grep -q -e "--$name " <<<"$help"; then
      echo "--$name $3"
      return
    fi
  done
}

# What a model_analyzer's output says under that name; the words are the same in every version.
analyzed() {  # OUTPUT TEXT
  sed -n "s/.*$2[^:]*: *\([0-9.]*\).*/\1/p" <<<"$1" | tail -n 1
}

# The figure of demo_survey score in the line that begins so, without its unit.
score_figure() {  # OUTPUT TEXT
  awk -v text="$2" 'index($0, text) == 1 { print $(NF - 1); exit }' <<<"$1"
}
