// The pictures from which a survey's lens is learnt before all of it is posed (ours).
#pragma once

#include <cstdint>
#include <vector>

namespace colmap_seapoint {

// A pair of pictures, counted from zero, with its number of verified matches.
struct TiedPair {
  uint32_t picture_idx1 = 0;
  uint32_t picture_idx2 = 0;
  uint32_t num_matches = 0;
};

// `count` pictures around the one with the strongest pairs: those that are tied to it, then those
// that are tied to these, and so on; of the last ones those with most matches. So neighbouring
// strips come in before the strip's own far ends, and where strips lie side by side a lens shows
// more of itself than along one. Ascending; fewer where fewer hang together. Pairs of fewer than 30
// matches do not count.
std::vector<uint32_t> ChoosePilotPictures(uint32_t num_pictures, const std::vector<TiedPair>& pairs,
                                          uint32_t count);

}  // namespace colmap_seapoint
