#!/usr/bin/env bash
# scripts/setup.sh          installs what the build, the tests and the demo need
# scripts/setup.sh --gate   and the tools of scripts/test.sh: formatter, clang-tidy, ctags, snakemake, pillow
#
# From Debian's packages only. Does nothing when all of it is there. As root, or with sudo.
set -euo pipefail

packages=(
  build-essential cmake ninja-build
  colmap
  libopencv-dev libeigen3-dev libceres-dev libsqlite3-dev libboost-program-options-dev
  libjpeg-dev libpng-dev libtiff-dev libwebp-dev libheif-dev libraw-dev libexiv2-dev liblensfun-dev liblensfun-data-v1
  libavformat-dev libavcodec-dev libavutil-dev libswscale-dev nlohmann-json3-dev libnanoflann-dev libproj-dev libgdal-dev
  libapriltag-dev libhpdf-dev poppler-utils
  libhwy-dev libxxhash-dev ccache pkg-config libgtest-dev sqlite3 file
)
case ${1:-} in
  '') ;;
  --gate) packages+=(clang-format-14 clang-tidy-14 universal-ctags snakemake python3-pil) ;;
  *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2; exit 2 ;;
esac

is_installed() {
  [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

if ! command -v apt-get >/dev/null; then
  echo "scripts/setup.sh: no apt-get here; install what matches these Debian packages by hand:" \
    "${missing[*]}" >&2
  exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "scripts/setup.sh: packages are missing (${missing[*]}); run it as root" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
