// The pyramid levels that SeaPoints were found on, as a picture's list of SeaPoints holds them:
// finest first (extract_features.h).
#pragma once

#include <cstddef>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// Between neighbouring levels (paper 4).
inline constexpr double kLevelScale = 1.4142135623730951;

// How many SeaPoints of the finest level stand first; all of them where there is one level.
size_t NumFinest(const Features& features);

// Where the coarsest levels begin that follow each other without a gap: 0 for a picture whose
// levels are all neighbours, of one level or of many.
size_t CoarsestRunBegin(const Features& features);

// SeaPoints `begin` to `end` (not included), with their descriptors.
Features Slice(const Features& features, size_t begin, size_t end);

// Appends `more`. Both have SIFT, or none has; without points of its own, `features` takes what
// `more` has.
void AppendFeatures(const Features& more, Features* features);

}  // namespace colmap_seapoint
