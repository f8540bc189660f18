#include "feature/matching/sift_matcher.h"

#include <algorithm>
#include <cmath>

#include "feature/kernels/sift_kernels.h"

namespace colmap_seapoint {

namespace {

constexpr double kSquaredLength = 512.0 * 512.0;

double Angle(int dot) { return std::acos(std::min(1.0, dot / kSquaredLength)); }

// Up to where an inner product does not matter: neither as the nearest's nor as a second nearest's,
// which every nearest within max_distance passes against. (Below 0 there are none.)
int DotFloor(const SiftMatcherOptions& options) {
  const double largest_angle = std::min(options.max_distance / options.max_ratio, M_PI / 2);
  return static_cast<int>(std::floor(kSquaredLength * std::cos(largest_angle))) - 1;
}

}  // namespace

void SiftMatcherOptions::Bind(OptionTable* table) {
  table->Add("SeaPointMatching.max_sift_distance", &max_distance,
             "largest angle between the SIFT descriptors of a match, radians", "ours", 0, 1.5);
  table->Add("SeaPointMatching.max_sift_ratio", &max_ratio,
             "largest ratio of nearest to second nearest angle; 1 = no test", "ours", 0.1, 1);
}

double SiftDistance(const SiftDescriptor& a, const SiftDescriptor& b) {
  int dot = 0;
  for (size_t i = 0; i < a.size(); ++i) dot += static_cast<int>(a[i]) * static_cast<int>(b[i]);
  return Angle(dot);
}

FeatureMatches MatchSift(const std::vector<SiftDescriptor>& descriptors1,
                         const std::vector<SiftDescriptor>& descriptors2,
                         const SiftMatcherOptions& options) {
  const int floor = DotFloor(options);
  const sift::Nearest none = {floor, floor, 0};
  std::vector<sift::Nearest> nearest1(descriptors1.size(), none);
  std::vector<sift::Nearest> nearest2(descriptors2.size(), none);
  sift::FindNearest(descriptors1, descriptors2, options.max_ratio < 1, &nearest1, &nearest2);
  auto passes = [&](const sift::Nearest& nearest) {
    const double distance = Angle(nearest.dot);
    return nearest.dot > floor && distance <= options.max_distance &&
           (options.max_ratio >= 1 || nearest.second_dot == floor ||
            distance <= options.max_ratio * Angle(nearest.second_dot));
  };
  FeatureMatches matches;
  for (uint32_t i = 0; i < descriptors1.size(); ++i) {
    if (!passes(nearest1[i])) continue;
    const sift::Nearest& back = nearest2[nearest1[i].idx];
    if (back.idx == i && passes(back)) matches.push_back({i, nearest1[i].idx});
  }
  return matches;
}

}  // namespace colmap_seapoint
