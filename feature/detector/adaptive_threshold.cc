#include "feature/detector/adaptive_threshold.h"

#include <array>
#include <cmath>

namespace colmap_seapoint {

namespace {

constexpr int kNumBins = 256;

// Bins of [low, high]: value low falls into bin 0, value high into bin 255.
int BinOf(float value, float low, float high) {
  const double position = (static_cast<double>(value) - low) / (static_cast<double>(high) - low);
  return std::min(kNumBins - 1, static_cast<int>(position * kNumBins));
}

struct Bin {
  int count = 0;
  float low = 0, high = 0;  // extremes of the measures in it
};

}  // namespace

AdaptiveThreshold FindAdaptiveThreshold(const std::vector<float>& measures, int min_count,
                                        int max_count) {
  AdaptiveThreshold result;
  if (measures.empty()) return result;

  float low = 0.0f, high = 255.0f;  // range of the histogram under exploration
  int count_above = 0;              // measures above that range: all of them are kept
  float threshold_above = 0.0f;     // the smallest of them
  while (true) {
    std::array<Bin, kNumBins> histogram{};
    for (const float measure : measures) {
      if (measure < low || measure > high) continue;
      Bin& bin = histogram[static_cast<size_t>(BinOf(measure, low, high))];
      bin.low = bin.count == 0 ? measure : std::min(bin.low, measure);
      bin.high = bin.count == 0 ? measure : std::max(bin.high, measure);
      ++bin.count;
    }
    ++result.num_rounds;

    int bin_idx = kNumBins - 1;
    for (; bin_idx >= 0; --bin_idx) {
      const Bin& bin = histogram[static_cast<size_t>(bin_idx)];
      if (bin.count == 0) continue;
      if (count_above + bin.count > max_count) break;
      count_above += bin.count;
      threshold_above = bin.low;
      if (count_above >= min_count) break;
    }
    result.threshold = threshold_above;
    result.count = count_above;
    if (count_above >= min_count) {
      result.status = ThresholdStatus::kConverged;
      return result;
    }
    if (bin_idx < 0) {
      result.status = ThresholdStatus::kTooFew;
      return result;
    }
    // This bin takes the sum from below the minimum to beyond the maximum: explode it.
    const Bin& crowded = histogram[static_cast<size_t>(bin_idx)];
    if (!(crowded.low < crowded.high)) {
      result.status = ThresholdStatus::kTied;
      return result;
    }
    low = crowded.low;
    high = crowded.high;
  }
}

}  // namespace colmap_seapoint
