#include "examples/benchmarks/densify/cloud_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxSamples = 200000;

PointVector ToDoubles(const std::vector<Eigen::Vector3f>& points) {
  PointVector doubles;
  for (const Eigen::Vector3f& xyz : points) doubles.push_back(xyz.cast<double>());
  return doubles;
}

}  // namespace

double MeanLayers(const PairedCloud& cloud, double cell) {
  std::vector<std::array<int64_t, 4>> entries;  // x, y, z of the cube, pair
  entries.reserve(cloud.points.size());
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d at = cloud.points[i].cast<double>() / cell;
    entries.push_back({static_cast<int64_t>(std::floor(at.x())),
                       static_cast<int64_t>(std::floor(at.y())),
                       static_cast<int64_t>(std::floor(at.z())), cloud.pair_idx[i]});
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  size_t num_cells = 0;
  for (size_t i = 0; i < entries.size(); ++i) {
    num_cells +=
        i == 0 || !std::equal(entries[i].begin(), entries[i].begin() + 3, entries[i - 1].begin());
  }
  return num_cells == 0 ? std::numeric_limits<double>::quiet_NaN()
                        : static_cast<double>(entries.size()) / static_cast<double>(num_cells);
}

PointVector DistinctPlaces(const std::vector<Eigen::Vector3f>& points) {
  PointVector places = ToDoubles(points);
  std::sort(places.begin(), places.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

NearestPoint::NearestPoint(const std::vector<Eigen::Vector3f>& points)
    : points_(ToDoubles(points)), index_(points_) {}

double NearestPoint::Distance(const Eigen::Vector3f& place) const {
  double squared = kBeyond;
  index_.Nearest(place.cast<double>(), NearestOf::kAnyPoint, &squared);
  return std::sqrt(squared);
}

double ShareNear(const std::vector<Eigen::Vector3f>& reference,
                 const std::vector<Eigen::Vector3f>& cloud, double distance) {
  const NearestPoint nearest(cloud);
  const size_t step = std::max<size_t>(1, reference.size() / kMaxSamples);
  size_t num_samples = 0, num_near = 0;
  for (size_t i = 0; i < reference.size(); i += step) {
    ++num_samples;
    num_near += nearest.Distance(reference[i]) <= distance;
  }
  return num_samples == 0 ? std::numeric_limits<double>::quiet_NaN()
                          : static_cast<double>(num_near) / static_cast<double>(num_samples);
}

}  // namespace colmap_seapoint
