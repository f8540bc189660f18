#include "feature/detector/adaptive_threshold.h"

#include <algorithm>
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

using Histogram = std::array<Bin, kNumBins>;

Histogram Explore(const std::vector<float>& measures, float low, float high) {
  Histogram histogram{};
  for (const float measure : measures) {
    if (measure < low || measure > high) continue;
    Bin& bin = histogram[static_cast<size_t>(BinOf(measure, low, high))];
    bin.low = bin.count == 0 ? measure : std::min(bin.low, measure);
    bin.high = bin.count == 0 ? measure : std::max(bin.high, measure);
    ++bin.count;
  }
  return histogram;
}

// Walks down from the top bin and takes whole bins into `result` until min_count is reached.
// Returns the bin that would take the count from below the minimum to beyond max_count, or nullptr.
const Bin* WalkDown(const Histogram& histogram, int min_count, int max_count,
                    AdaptiveThreshold* result) {
  for (auto bin = histogram.rbegin(); bin != histogram.rend(); ++bin) {
    if (bin->count == 0) continue;
    if (result->count + bin->count > max_count) return &*bin;
    result->count += bin->count;
    result->threshold = bin->low;
    if (result->count >= min_count) return nullptr;
  }
  return nullptr;
}

}  // namespace

AdaptiveThreshold FindAdaptiveThreshold(const std::vector<float>& measures, int min_count,
                                        int max_count) {
  AdaptiveThreshold result;
  if (measures.empty()) return result;
  Bin range = {0, 0.0f, 255.0f};  // under exploration; all measures above it are kept
  while (true) {
    const Histogram histogram = Explore(measures, range.low, range.high);
    ++result.num_rounds;
    const Bin* crowded = WalkDown(histogram, min_count, max_count, &result);
    if (crowded == nullptr) {
      result.status =
          result.count >= min_count ? ThresholdStatus::kConverged : ThresholdStatus::kTooFew;
      return result;
    }
    if (!(crowded->low < crowded->high)) {
      result.status = ThresholdStatus::kTied;
      return result;
    }
    range = *crowded;  // exploded into a histogram of its own
  }
}

}  // namespace colmap_seapoint
