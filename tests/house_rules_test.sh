#!/usr/bin/env bash
# No function, class or room is larger than the house allows; scripts/house_metrics.sh says how large.
set -u
exec "$1/scripts/house_metrics.sh" --check
