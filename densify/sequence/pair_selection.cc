#include "densify/sequence/pair_selection.h"

#include <cmath>

namespace colmap_seapoint {

namespace {

constexpr double kMinOverlap = 0.1;  // between `first` and the second picture of the next pair

}  // namespace

double MeanMotion(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                  const FeatureMatches& matches, double longer_side) {
  if (matches.empty()) return 0;
  double sum = 0;
  for (const FeatureMatch& match : matches) {
    const SeaPoint& a = points1[match.idx1];
    const SeaPoint& b = points2[match.idx2];
    sum += std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
  }
  return sum / static_cast<double>(matches.size()) / longer_side;
}

int SelectNextFirst(int second, int num_pictures, double max_overlap,
                    const std::function<double(int)>& overlap) {
  const int last = num_pictures - 1;
  if (second >= last) return num_pictures;
  int candidate = second + 1;
  while (candidate < last && overlap(candidate) > max_overlap) ++candidate;
  // The last picture cannot start a pair: it completes the pair of the one before it.
  if (candidate == last) return last - 1;
  return overlap(candidate + 1) < kMinOverlap ? candidate - 1 : candidate;
}

int SelectNextStereoFirst(int first, int num_pictures, double max_overlap,
                          const std::function<double(int)>& overlap) {
  const int last = num_pictures - 1;
  for (int candidate = first + 1; candidate <= last; ++candidate) {
    const double rate = overlap(candidate);
    if (rate > max_overlap && candidate < last) continue;
    return rate < kMinOverlap && candidate > first + 1 ? candidate - 1 : candidate;
  }
  return num_pictures;
}

}  // namespace colmap_seapoint
