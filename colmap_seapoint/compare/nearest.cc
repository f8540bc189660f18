#include "colmap_seapoint/compare/nearest.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace colmap_seapoint {
namespace {

constexpr double kRelativeSlack = 1 + 1e-9;  // more than what rounding does to a square

bool LessPlace(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

void RemoveCopies(PointVector* points) {
  std::sort(points->begin(), points->end(), LessPlace);
  points->erase(std::unique(points->begin(), points->end()), points->end());
}

// The points of a tile that may be nearer to one of the queries than `squared` says.
PointVector Candidates(const PointTiles& cloud, int tile, const PointVector& queries,
                       const std::vector<uint32_t>& asking, const std::vector<double>& squared) {
  Eigen::Array3d low = Eigen::Array3d::Constant(kBeyond), high = -low;
  for (const uint32_t i : asking) {
    const double reach = kRelativeSlack * std::sqrt(squared[i]);
    low = low.min(queries[i].array() - reach);
    high = high.max(queries[i].array() + reach);
  }
  PointVector points = cloud.Read(tile);
  points.erase(std::remove_if(points.begin(), points.end(),
                              [&](const Eigen::Vector3d& xyz) {
                                return (xyz.array() < low).any() || (xyz.array() > high).any();
                              }),
               points.end());
  return points;
}

}  // namespace

std::vector<double> NearestSquared(const PointTiles& cloud, int tile, const PointVector& queries,
                                   double max_distance, NearestOf what) {
  // The search looks for what is less than the limit: it lies one step above the largest square
  // that counts.
  const double limit = std::nextafter(max_distance * max_distance, kBeyond);
  std::vector<double> squared(queries.size(), limit);
  auto search = [&](PointVector points, const std::vector<uint32_t>& asking) {
    if (what == NearestOf::kOtherPlace) RemoveCopies(&points);
    const PointIndex index(points);
    for (const uint32_t i : asking) index.Nearest(queries[i], what, &squared[i]);
  };
  std::vector<uint32_t> asking(queries.size());
  for (size_t i = 0; i < asking.size(); ++i) asking[i] = static_cast<uint32_t>(i);
  search(cloud.Read(tile), asking);

  const TilePartition& partition = cloud.Partition();
  std::vector<Eigen::Array2d> places;
  for (const Eigen::Vector3d& query : queries) places.push_back(cloud.PlanOf(query));
  for (const int other : partition.Neighbours(tile, kRelativeSlack * max_distance)) {
    asking.clear();
    for (size_t i = 0; i < queries.size(); ++i) {
      const double distance = partition.Box(other).Distance(places[i]) - 2 * partition.Slack();
      if (distance > 0 && distance * distance > kRelativeSlack * squared[i]) continue;
      asking.push_back(static_cast<uint32_t>(i));
    }
    if (asking.empty() || cloud.NumPoints(other) == 0) continue;
    search(Candidates(cloud, other, queries, asking, squared), asking);
  }
  for (double& value : squared) {
    if (value >= limit) value = kBeyond;
  }
  return squared;
}

}  // namespace colmap_seapoint
