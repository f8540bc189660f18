#!/usr/bin/env bash
# Data flows one way: base <- feature, densify, georeference, io <- compare <- commands <- main.
# feature, densify and georeference do not know each other, nor io, nor anything above. Fails on the
# first include against that.
set -u
cd "$1" || exit 1
failed=0

forbid() {  # FOLDER PATTERN WHY
  if [ -z "$(find "$1" -name '*.h' -o -name '*.cc')" ]; then
    echo "$1: no sources found"
    failed=1
  fi
  if grep -rnE "^#include \"($2)" "$1" --include='*.h' --include='*.cc'; then
    echo "$1 must not include that: $3"
    failed=1
  fi
}

forbid colmap_seapoint/base 'feature/|densify/|examples/|colmap_seapoint/(io|compare|commands|georeference)' \
  'base knows nothing but itself'
forbid colmap_seapoint/io 'feature/|densify/|examples/|colmap_seapoint/(compare|commands|georeference)' \
  'io turns files into plain structs and back'
forbid colmap_seapoint/compare 'feature/|densify/|examples/|colmap_seapoint/(commands|georeference)' \
  'compare builds on base and io'
forbid feature 'densify/|examples/|colmap_seapoint/(io|compare|commands|georeference)' 'feature builds on base only'
forbid densify 'feature/|examples/|colmap_seapoint/(io|compare|commands|georeference)' 'densify builds on base only'
forbid colmap_seapoint/georeference 'feature/|densify/|examples/|colmap_seapoint/(io|compare|commands)' \
  'georeference builds on base only'
forbid colmap_seapoint/commands 'examples/' 'commands do not need the examples'

if grep -rnE 'std::(cout|cerr)|printf\(|f?open\(|fstream' feature densify colmap_seapoint/base \
    colmap_seapoint/compare colmap_seapoint/georeference \
    --include='*.cc' --include='*.h' | grep -v '^colmap_seapoint/base/progress'; then
  echo "feature, densify, georeference, compare and base never print and never open a file"
  failed=1
fi
exit $failed
