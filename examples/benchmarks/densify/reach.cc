#include "examples/benchmarks/densify/reach.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "examples/benchmarks/densify/cloud_measures.h"
#include "examples/benchmarks/feature/pair_measures.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNeighbors = 9;  // the point itself among them
constexpr size_t kMaxSamples = 200000;

using Cloud = std::vector<Eigen::Vector3f>;

// The peer's places, which know how far apart they are.
class SpacedPlaces {
 public:
  explicit SpacedPlaces(const Cloud& points) : places_(DistinctPlaces(points)), index_(places_) {}

  size_t NumPlaces() const { return places_.size(); }

  // The local spacing at the place nearest to `point`, and the distance to it.
  struct Found {
    double spacing, distance;
  };
  Found Nearest(const Eigen::Vector3f& point) const {
    const Eigen::Vector3d& nearest =
        places_[index_.NearestPositions(point.cast<double>(), 1).front()];
    std::vector<double> distances;
    for (const uint32_t position : index_.NearestPositions(nearest, kNeighbors)) {
      double squared = kBeyond;
      index_.Nearest(places_[position], NearestOf::kOtherPlace, &squared);
      distances.push_back(std::sqrt(squared));
    }
    return {Median(distances), (point.cast<double>() - nearest).norm()};
  }

 private:
  PointVector places_;
  PointIndex index_;
};

std::vector<double> Ranges(const Cloud& points, const NearestPoint& cameras) {
  std::vector<double> ranges;
  ranges.reserve(points.size());
  for (const Eigen::Vector3f& point : points) ranges.push_back(cameras.Distance(point));
  return ranges;
}

Cloud NearerThan(const Cloud& points, const std::vector<double>& ranges, double limit) {
  Cloud nearer;
  for (size_t i = 0; i < points.size(); ++i) {
    if (ranges[i] <= limit) nearer.push_back(points[i]);
  }
  return nearer;
}

// `visit` gets an even sample of the points; returns their number.
template <typename Visit>
void VisitSample(const Cloud& points, const Visit& visit) {
  const size_t step = std::max<size_t>(1, points.size() / kMaxSamples);
  for (size_t i = 0; i < points.size(); i += step) visit(points[i]);
}

// `distances`: in local spacings.
ReachShares SharesOf(size_t num_points, const std::vector<double>& distances) {
  ReachShares shares;
  shares.num_points = num_points;
  for (const double limit : kReachSpacings) {
    const auto num_within =
        std::count_if(distances.begin(), distances.end(), [&](double d) { return d <= limit; });
    shares.within.push_back(distances.empty() ? std::numeric_limits<double>::quiet_NaN()
                                              : static_cast<double>(num_within) /
                                                    static_cast<double>(distances.size()));
  }
  return shares;
}

}  // namespace

Reach MeasureReach(const Cloud& cloud, const Cloud& peer, const Cloud& centers) {
  const SpacedPlaces places(peer);
  if (places.NumPlaces() < 2) {
    throw Error("the peer's cloud", "has fewer than two places", "choose another one");
  }
  const NearestPoint cameras(centers), ours(cloud);
  const std::vector<double> peer_ranges = Ranges(peer, cameras);
  Reach reach;
  reach.range_limit = Median(peer_ranges);
  std::vector<double> spacings, distances;
  const Cloud near_peer = NearerThan(peer, peer_ranges, reach.range_limit);
  VisitSample(near_peer, [&](const Eigen::Vector3f& point) {
    spacings.push_back(places.Nearest(point).spacing);
    distances.push_back(ours.Distance(point) / spacings.back());
  });
  reach.median_spacing = Median(spacings);
  reach.peer = SharesOf(near_peer.size(), distances);
  distances.clear();
  const Cloud near_cloud = NearerThan(cloud, Ranges(cloud, cameras), reach.range_limit);
  VisitSample(near_cloud, [&](const Eigen::Vector3f& point) {
    const SpacedPlaces::Found found = places.Nearest(point);
    distances.push_back(found.distance / found.spacing);
  });
  reach.cloud = SharesOf(near_cloud.size(), distances);
  return reach;
}

std::string ReachText(const Reach& reach) {
  std::ostringstream text;
  text << "nearer half: up to " << reach.range_limit
       << " from the nearest camera; local spacing of "
       << "the peer there " << reach.median_spacing << " (median)\n"
       << "share with a point of the other cloud within";
  for (const double limit : kReachSpacings) text << ' ' << limit;
  text << " local spacings of the peer:\n" << std::fixed << std::setprecision(4);
  const auto line = [&](const char* what, const ReachShares& shares) {
    text << what << ' ' << shares.num_points << " points:";
    for (const double share : shares.within) text << ' ' << share;
    text << '\n';
  };
  line("the peer's", reach.peer);
  line("the cloud's", reach.cloud);
  return text.str();
}

}  // namespace colmap_seapoint
