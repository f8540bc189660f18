// The threshold that always finds the wanted number of points (paper 2.3, Figures 4 and 5).
#pragma once

#include <vector>

namespace colmap_seapoint {

enum class ThresholdStatus {
  kConverged,  // the count lies in the target interval
  kTooFew,     // fewer local maxima than the minimum: all of them are kept
  kTied,       // equal measures straddle the interval (a synthetic or saturated picture): the
               // strongest whole groups are kept, fewer than the minimum
  kFlat,       // no local maximum at all: a picture without texture
};

struct AdaptiveThreshold {
  ThresholdStatus status = ThresholdStatus::kFlat;
  float threshold = 0;  // keep measures >= threshold
  int count = 0;        // how many of them
  int num_rounds = 0;   // histograms explored
};

// `measures`: the surviving local maxima, remapped to [0, 255]. The histogram of 256 bins is walked
// down from the top bin until the sum reaches `min_count`; a bin that takes it beyond `max_count`
// is exploded into a new histogram of its own range, recursively. O(rounds * n).
AdaptiveThreshold FindAdaptiveThreshold(const std::vector<float>& measures, int min_count,
                                        int max_count);

}  // namespace colmap_seapoint
