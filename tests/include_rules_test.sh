#!/usr/bin/env bash
# Data flows one way. Each line of `rooms` says which other rooms the sources of one room may
# include from; whatever is not named is forbidden, and so is a room that no line names. Then, which
# libraries and system calls a room may touch. Prints every breach.
#   include_rules_test.sh SOURCE_FOLDER
set -uf  # -f: the stars below are patterns of rooms, not of files
cd "$1" || exit 1

read -r -d '' rooms <<'END'
colmap_seapoint/base            colmap_seapoint/base/hold
colmap_seapoint/base/hold
colmap_seapoint/system          colmap_seapoint/base colmap_seapoint/base/hold
colmap_seapoint/io/files        colmap_seapoint/base colmap_seapoint/base/hold colmap_seapoint/system
colmap_seapoint/io/navigation   colmap_seapoint/base colmap_seapoint/io/files
colmap_seapoint/io/outputs      colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files
colmap_seapoint/io/image        colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files
colmap_seapoint/io/video        colmap_seapoint/base colmap_seapoint/io/files
colmap_seapoint/io/gis          colmap_seapoint/base colmap_seapoint/io/files
colmap_seapoint/io/pdf          colmap_seapoint/base colmap_seapoint/io/files
colmap_seapoint/io/cloud        colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files
colmap_seapoint/io/raster       colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files colmap_seapoint/io/image
colmap_seapoint/io/las          colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/cloud
colmap_seapoint/io/colmap       colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files colmap_seapoint/io/image
feature/kernels                 colmap_seapoint/base
feature/detector                colmap_seapoint/base feature/kernels
feature/descriptor              colmap_seapoint/base feature/kernels
feature/matching                colmap_seapoint/base feature/kernels feature/descriptor
feature/retrieval               colmap_seapoint/base feature/kernels feature/descriptor
feature/remeasuring             colmap_seapoint/base feature/kernels
feature                         colmap_seapoint/base feature/*
densify/kernels                 colmap_seapoint/base
densify/match                   colmap_seapoint/base densify/kernels
densify/overlap                 colmap_seapoint/base densify/match
densify/cloud                   colmap_seapoint/base densify/match densify/overlap
densify/sequence                colmap_seapoint/base densify/match densify/overlap densify/cloud
densify/maps                    colmap_seapoint/base densify/match densify/cloud
densify/completeness/surface    colmap_seapoint/base
densify/completeness/sight      colmap_seapoint/base densify/completeness/surface
densify/completeness/gaps       colmap_seapoint/base densify/completeness/surface
densify/completeness            colmap_seapoint/base densify/match densify/completeness/*
densify/self_check              colmap_seapoint/base densify/completeness densify/completeness/*
densify                         colmap_seapoint/base densify/*
colmap_seapoint/estimate        colmap_seapoint/base colmap_seapoint/base/hold colmap_seapoint/system colmap_seapoint/io/files
colmap_seapoint/markers         colmap_seapoint/base
colmap_seapoint/georeference    colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/navigation colmap_seapoint/markers
colmap_seapoint/navigation      colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/navigation colmap_seapoint/georeference colmap_seapoint/pictures
colmap_seapoint/compare         colmap_seapoint/base colmap_seapoint/io/cloud
colmap_seapoint/orthomosaic/ground colmap_seapoint/base colmap_seapoint/io/files
colmap_seapoint/orthomosaic/relief colmap_seapoint/base colmap_seapoint/io/cloud colmap_seapoint/orthomosaic/ground
colmap_seapoint/orthomosaic/sources colmap_seapoint/base colmap_seapoint/water colmap_seapoint/orthomosaic/ground colmap_seapoint/orthomosaic/relief
colmap_seapoint/orthomosaic     colmap_seapoint/base colmap_seapoint/water colmap_seapoint/io/files colmap_seapoint/orthomosaic/*
colmap_seapoint/tracks          colmap_seapoint/base colmap_seapoint/io/colmap
colmap_seapoint/adjustment/equations colmap_seapoint/base
colmap_seapoint/adjustment      colmap_seapoint/base colmap_seapoint/adjustment/equations
colmap_seapoint/joining         colmap_seapoint/base colmap_seapoint/adjustment colmap_seapoint/adjustment/equations colmap_seapoint/io/colmap
colmap_seapoint/lens            colmap_seapoint/base colmap_seapoint/adjustment colmap_seapoint/adjustment/equations
colmap_seapoint/reposing        colmap_seapoint/base colmap_seapoint/io/colmap
colmap_seapoint/mapping         colmap_seapoint/base colmap_seapoint/system colmap_seapoint/tracks colmap_seapoint/joining colmap_seapoint/reposing colmap_seapoint/lens colmap_seapoint/adjustment colmap_seapoint/adjustment/equations colmap_seapoint/remeasuring feature/remeasuring colmap_seapoint/io/files colmap_seapoint/io/colmap colmap_seapoint/io/image
colmap_seapoint/cameras         colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/image
colmap_seapoint/pictures        colmap_seapoint/base colmap_seapoint/system colmap_seapoint/cameras colmap_seapoint/markers colmap_seapoint/io/* feature feature/* densify densify/*
colmap_seapoint/frames          colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/image colmap_seapoint/io/video feature feature/*
colmap_seapoint/pairing         colmap_seapoint/base colmap_seapoint/io/* feature feature/*
colmap_seapoint/remeasuring     colmap_seapoint/base feature/remeasuring
colmap_seapoint/report          colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/markers colmap_seapoint/compare colmap_seapoint/georeference densify densify/*
colmap_seapoint/water           colmap_seapoint/base
colmap_seapoint/gaps            colmap_seapoint/base colmap_seapoint/io/files densify/completeness densify/completeness/*
colmap_seapoint/page            colmap_seapoint/base colmap_seapoint/io/files colmap_seapoint/io/image colmap_seapoint/gaps colmap_seapoint/report densify/completeness densify/completeness/*
colmap_seapoint/workspace       colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/pictures
colmap_seapoint/disk            colmap_seapoint/base colmap_seapoint/base/hold colmap_seapoint/system colmap_seapoint/estimate colmap_seapoint/workspace
colmap_seapoint/pipeline/intake colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/pictures colmap_seapoint/frames colmap_seapoint/workspace
colmap_seapoint/pipeline        colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/* colmap_seapoint/markers colmap_seapoint/compare colmap_seapoint/estimate colmap_seapoint/georeference colmap_seapoint/navigation colmap_seapoint/mapping colmap_seapoint/cameras colmap_seapoint/pictures colmap_seapoint/frames colmap_seapoint/pairing colmap_seapoint/report colmap_seapoint/gaps colmap_seapoint/workspace colmap_seapoint/disk colmap_seapoint/pipeline/intake colmap_seapoint/pipeline/completeness colmap_seapoint/pipeline/orthomosaic colmap_seapoint/pipeline/page colmap_seapoint/orthomosaic colmap_seapoint/orthomosaic/ground feature feature/* densify densify/*
colmap_seapoint/pipeline/orthomosaic colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/* colmap_seapoint/orthomosaic colmap_seapoint/orthomosaic/ground colmap_seapoint/pictures colmap_seapoint/report colmap_seapoint/workspace
colmap_seapoint/pipeline/completeness colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/gaps colmap_seapoint/orthomosaic/ground colmap_seapoint/pictures colmap_seapoint/pipeline/page colmap_seapoint/workspace densify/completeness densify/completeness/* densify/self_check
colmap_seapoint/pipeline/page   colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/gaps colmap_seapoint/page colmap_seapoint/report colmap_seapoint/workspace densify/completeness densify/completeness/*
colmap_seapoint/pipeline/markers colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/markers colmap_seapoint/pictures colmap_seapoint/report colmap_seapoint/workspace
colmap_seapoint/rendering       colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/compare colmap_seapoint/workspace
colmap_seapoint/watch           colmap_seapoint/base colmap_seapoint/base/hold colmap_seapoint/system colmap_seapoint/io/files colmap_seapoint/io/image colmap_seapoint/frames colmap_seapoint/pipeline
colmap_seapoint/merging         colmap_seapoint/base colmap_seapoint/io/* colmap_seapoint/compare colmap_seapoint/workspace
colmap_seapoint/cli             colmap_seapoint/base colmap_seapoint/system colmap_seapoint/io/files colmap_seapoint/pipeline colmap_seapoint/pipeline/completeness colmap_seapoint/pipeline/markers colmap_seapoint/pipeline/orthomosaic colmap_seapoint/rendering colmap_seapoint/merging colmap_seapoint/watch
colmap_seapoint                 colmap_seapoint/base colmap_seapoint/system colmap_seapoint/cli
END

failed=0
declare -A allowed=()
while read -r room others; do allowed[$room]=$others; done <<<"$rooms"

# Prints FILE ROOM for every included header of ours.
while read -r file header; do
  room=${file%/*} of=${header%/*}
  [ "$room" = "$of" ] && continue
  if [ -z "${allowed[$room]+x}" ]; then
    echo "$file: the room $room is not in the list of tests/include_rules_test.sh"
    failed=1
    continue
  fi
  ok=
  for other in ${allowed[$room]}; do
    # shellcheck disable=SC2053  # a pattern
    [[ $of == $other ]] && ok=1
  done
  [ -n "$ok" ] || { echo "$file must not include $header"; failed=1; }
done < <(grep -rnoE '^#include "[^"]+"' colmap_seapoint feature densify --include='*.h' --include='*.cc' |
  sed -nE 's|^([^:]+):[0-9]+:#include "((colmap_seapoint\|feature\|densify\|examples\|tests)/.*)"$|\1 \2|p')

# WHAT may be touched by ROOMS only: an extended regular expression, and where it is allowed.
only_in() {  # WHAT REGEX ALLOWED_PATHS_REGEX
  local found
  found=$(grep -rnE "$2" colmap_seapoint feature densify --include='*.h' --include='*.cc' |
    grep -vE "^($3)")
  [ -z "$found" ] || { echo "$1:"; echo "$found"; failed=1; }
}
only_in "Ceres solves in georeference and two-view verification only" '#include <ceres/' \
  'colmap_seapoint/georeference/|feature/matching/'
only_in "children are started by mapping only" 'RunSubprocess\(|io/files/subprocess\.h' \
  'colmap_seapoint/(mapping|io/files)/'
only_in "SQLite is io's" '#include <sqlite3\.h>|io/files/sqlite\.h' 'colmap_seapoint/io/(files|colmap)/'
only_in "Videos are io/video's" '#include <lib(av|sw)' 'colmap_seapoint/io/video/'
only_in "GDAL is io/raster's" '#include <(gdal|ogr_|cpl_)' 'colmap_seapoint/io/raster/'
only_in "OpenCV's decoders are io/image's" '#include <opencv2/imgcodecs' 'colmap_seapoint/io/image/'
only_in "only cli prints results, only base/progress prints the log" \
  'std::(cout|cerr|clog)|[^sn]printf\(|(^|[^a-z_])puts\(' \
  'colmap_seapoint/(cli/|base/progress|system/process_setup)'
only_in "files are io's, and the pipeline's records and locks (base/parallel and system ask /proc)" \
  'std::[io]?fstream|[^a-zA-Z_]f?open\(|#include <fstream>' \
  'colmap_seapoint/(io/|system/|base/parallel\.cc)'
exit $failed
