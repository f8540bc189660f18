#!/usr/bin/env bash
# scripts/update_three.sh            copies three.js, as its lock file names it, into the report's page
# scripts/update_three.sh --check    says whether what is there is what the lock file names
#
# three.js draws the 3D view of the report's page (colmap_seapoint/page/web/three/) and is built into the
# program, so that neither the build nor the page needs a network. For another version change
# package.json, run `npm install --package-lock-only` there, then this. Needs npm, which checks the hash.
set -euo pipefail

check=
case ${1:-} in
  '') ;;
  --check) check=1 ;;
  *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0" >&2; exit 2 ;;
esac
cd "$(dirname "${BASH_SOURCE[0]}")/../colmap_seapoint/page/web/three"
modules=$(mktemp -d)
trap 'rm -rf "$modules"' EXIT
cp package.json package-lock.json "$modules"
(cd "$modules" && npm ci --ignore-scripts --no-audit --no-fund --silent)
three=$modules/node_modules/three
if [ -z "$check" ]; then
  cp "$three/build/three.module.min.js" "$three/LICENSE" .
  exit
fi
cmp "$three/build/three.module.min.js" three.module.min.js
cmp "$three/LICENSE" LICENSE
echo "three.js is what package-lock.json names."
