#!/usr/bin/env bash
# scripts/check_page.sh PAGE.html [OUTPUT_DIR]
#
# Looks at a report's page as a person would, in headless Chromium, from the disk and without a
# network, as wide as a desktop and as a phone: nothing on the console, no request; the first map
# within a second and all within three; the 3D view draws; axe-core finds nothing that keeps anybody
# from reading it, plain and in high contrast; the keyboard moves the map; the slate prints on one
# A4 page. Screenshots and the slate go to OUTPUT_DIR (default: build/page_check).
# Needs Debian's chromium, nodejs, npm and poppler-utils; axe-core and puppeteer-core come from npm,
# of the versions in scripts/page/package-lock.json. No part of the gate.
set -euo pipefail

if [ $# -lt 1 ] || [ $# -gt 2 ] || [ "$1" = -h ] || [ "$1" = --help ]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2
  [ "${1:-}" = -h ] || [ "${1:-}" = --help ] && exit 0 || exit 2
fi
[ -f "$1" ] || { echo "$1: no such page" >&2; exit 1; }
for tool in node npm pdfinfo pdftoppm "${CHROMIUM:=/usr/bin/chromium}"; do
  command -v "$tool" >/dev/null || { echo "scripts/check_page.sh: $tool is missing" >&2; exit 1; }
done
export CHROMIUM
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
output=${2:-$root/build/page_check}
modules=$root/build/page_modules
mkdir -p "$modules"
if ! cmp -s "$root/scripts/page/package-lock.json" "$modules/package-lock.json" ||
  [ ! -d "$modules/node_modules" ]; then
  cp "$root/scripts/page/package.json" "$root/scripts/page/package-lock.json" "$modules"
  (cd "$modules" && npm ci --ignore-scripts --no-audit --no-fund --silent)
fi
exec node "$root/scripts/page/check_page.mjs" "$modules" "$1" "$output"
