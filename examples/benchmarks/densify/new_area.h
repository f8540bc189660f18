// How much of what a pair sees is truly new: the floor of what a partial reconstruction can save.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "examples/survey/survey.h"

namespace colmap_seapoint {

// Shares of the first picture's area.
struct PairArea {
  double seen = 0;   // both pictures of the pair see it
  double fresh = 0;  // of that, what the earlier pair (or all earlier pairs) did not see twice
};

enum class Against { kPreviousPair, kAllPairs };

// `pairs`: positions in truth.model.images, in processing order. A raster of rays a picture.
std::vector<PairArea> NewAreas(const SurveyTruth& truth,
                               const std::vector<std::array<size_t, 2>>& pairs, Against against,
                               int num_threads);

}  // namespace colmap_seapoint
