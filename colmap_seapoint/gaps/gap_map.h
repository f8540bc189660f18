// The map of gaps: a layer of the ground in its plan, coloured by cause, gaps numbered.
#pragma once

#include <string>

#include "colmap_seapoint/base/image.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// Grey: covered, shaded by its relief. Colours (safe for the colour-blind): what is missing, by
// cause. Black: not expected. Lines: the passes of the 25 largest gaps, with their numbers. Ahead
// is up. About 1600 pixels along the longer side. Empty image for a layer without cells.
ColorImage DrawGapMap(const CompletenessResult& result, const LayerKey& key,
                      const std::string& unit);

}  // namespace colmap_seapoint
