#!/usr/bin/env bash
# colmap_seapoint/OPTIONS.md says what the program's option tables say.
#   options_reference_test.sh PROGRAM SOURCE_FOLDER
set -u
if "$1" help --format markdown | diff "$2/colmap_seapoint/OPTIONS.md" -; then exit 0; fi
echo "stale: colmap_seapoint help --format markdown > colmap_seapoint/OPTIONS.md" >&2
exit 1
