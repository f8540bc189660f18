#include "feature/matching/sift_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "feature/kernels/sift_kernels.h"
#include "feature/matching/mutual_nearest.h"

namespace colmap_seapoint {

namespace {

constexpr double kSquaredLength = 512.0 * 512.0;

double Angle(int dot) { return std::acos(std::min(1.0, dot / kSquaredLength)); }

// From here on the kernel's distance, an inner product with its sign turned, does not matter: it is
// too large for a match, and as a second nearest it lets every nearest within max_distance pass.
// (No inner product is negative, whatever the options: the cap is 1 at most.)
int DistanceCap(const SiftMatcherOptions& options) {
  const double largest_angle = std::min(options.max_distance / options.max_ratio, M_PI / 2);
  return 1 - static_cast<int>(std::floor(kSquaredLength * std::cos(largest_angle)));
}

}  // namespace

double SiftDistance(const SiftDescriptor& a, const SiftDescriptor& b) {
  int dot = 0;
  for (size_t i = 0; i < a.size(); ++i) dot += static_cast<int>(a[i]) * static_cast<int>(b[i]);
  return Angle(dot);
}

FeatureMatches MatchSift(const std::vector<SiftDescriptor>& descriptors1,
                         const std::vector<SiftDescriptor>& descriptors2,
                         const SiftMatcherOptions& options) {
  const int cap = DistanceCap(options);
  const NearestLimits limits = {options.max_distance, options.max_ratio};
  const NearestNeighbors nearest =
      sift::FindNearest(descriptors1, descriptors2, cap, limits.NeedSecond());
  return MatchMutualNearest(nearest, limits, [&](int distance) {
    return distance < cap ? Angle(-distance) : std::numeric_limits<double>::infinity();
  });
}

}  // namespace colmap_seapoint
