#!/usr/bin/env bash
# How well the time left is told, on real folders of pictures: runs automatic_reconstructor on each
# with every line of stderr time-stamped, and prints how many lines, from a tenth of the job on, were
# within 30 % of the time that it really took, and the longest silence.
#   benchmark_eta.sh BIN OUTPUT_FOLDER IMAGE_FOLDER...
set -euo pipefail
bin=$1 out=$2
shift 2
mkdir -p "$out"
for images in "$@"; do
  name=$(basename "$(dirname "$images")")_$(basename "$images")
  rm -rf "${out:?}/$name"
  # The estimate is that of a machine without history.
  XDG_CACHE_HOME="$out/$name.cache" "$bin" automatic_reconstructor --image_path "$images" \
    --workspace_path "$out/$name" ${SEAPOINT_ETA_OPTIONS:-} 2>&1 >/dev/null |
    python3 -uc '
import sys, time
start = time.time()
for line in sys.stdin: print("%.2f\t%s" % (time.time() - start, line.rstrip("\n")), flush=True)
print("%.2f\tend" % (time.time() - start))' >"$out/$name.log" || true
  python3 - "$name" "$out/$name.log" <<'P'
import re, sys
name, path = sys.argv[1:]
lines = [line.rstrip("\n").split("\t", 1) for line in open(path)]
times = [float(t) for t, _ in lines]
total = times[-1]
units = {"h": 3600, "min": 60, "s": 1}
told, shares = [], []
for (_, text), now in zip(lines, times):
    m = re.match(r"(\d+) % of the whole job, about (.*?) left", text)
    if not m: continue
    left = sum(float(v) * units[u] for v, u in re.findall(r"([\d.]+) (h|min|s)", m.group(2)))
    shares.append(int(m.group(1)))
    if now >= 0.1 * total: told.append((now + left) / total)
good = sum(1 for t in told if 0.7 <= t <= 1.3)
silence = max([b - a for a, b in zip([0] + times, times)] or [0])
print("%s: %.0f s, %d of %d lines within 30 %%, predicted/true %.2f to %.2f, share %s, longest silence %.0f s"
      % (name, total, good, len(told), min(told or [0]), max(told or [0]),
         "never back" if shares == sorted(shares) else "RAN BACK", silence))
P
done
