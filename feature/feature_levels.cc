#include "feature/feature_levels.h"

#include <algorithm>

namespace colmap_seapoint {
namespace {

// Sizes of levels are whole pixels, so that their scales are off by some.
constexpr double kGap = 1.2 * kLevelScale;

template <typename T>
std::vector<T> Slice(const std::vector<T>& all, size_t begin, size_t end) {
  if (all.empty()) return {};
  return std::vector<T>(all.data() + begin, all.data() + end);
}

template <typename T>
void Append(const std::vector<T>& more, std::vector<T>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

}  // namespace

size_t NumFinest(const Features& features) {
  if (features.points.empty()) return 0;
  const auto is_coarse = [finest = features.points[0].scale](const SeaPoint& point) {
    return point.scale > finest;
  };
  return static_cast<size_t>(
      std::find_if(features.points.begin(), features.points.end(), is_coarse) -
      features.points.begin());
}

size_t CoarsestRunBegin(const Features& features) {
  size_t begin = features.points.size();
  while (begin > 0 && (begin == features.points.size() ||
                       features.points[begin - 1].scale * kGap > features.points[begin].scale)) {
    --begin;
  }
  return begin;
}

Features Slice(const Features& features, size_t begin, size_t end) {
  return {Slice(features.points, begin, end), Slice(features.descriptors, begin, end),
          Slice(features.sift_descriptors, begin, end)};
}

void AppendFeatures(const Features& more, Features* features) {
  Append(more.points, &features->points);
  Append(more.descriptors, &features->descriptors);
  Append(more.sift_descriptors, &features->sift_descriptors);
}

}  // namespace colmap_seapoint
