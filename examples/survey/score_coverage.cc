#include "examples/survey/score_coverage.h"

#include <Eigen/Geometry>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/compare/point_index.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

struct Sample {
  Eigen::Vector3d place, normal;
  double area;  // m^2
};

Sample GroundSample(const Surface& surface, int i, int64_t j) {
  const GridSpec& grid = surface.Ground().Grid();
  const double side = kSampleStep * grid.step;
  const double x = grid.MinX() + (i + 0.5) * side;
  const double y = grid.MinY() + (static_cast<double>(j) + 0.5) * side;
  const SurfaceHit hit = surface.GroundAt(x, y);
  return {hit.xyz, hit.normal, side * side / surface.Ground().Normal(x, y).z()};
}

Sample ObjectSample(const Sheet& object, int i, int64_t j) {
  const double half = 0.5 * kSampleStep;
  const Eigen::Vector2d lattice(kSampleStep * i + half,
                                kSampleStep * static_cast<double>(j) + half);
  const Eigen::Vector2d du(half, 0), dv(0, half);
  const Eigen::Vector3d across = object.At(lattice + du) - object.At(lattice - du);
  const Eigen::Vector3d up = object.At(lattice + dv) - object.At(lattice - dv);
  return {object.At(lattice), object.Normal(lattice), across.cross(up).norm()};
}

SampleState StateOf(double nearest, double gsd) {
  return nearest <= 2 * gsd ? kCovered2 : nearest <= 4 * gsd ? kCovered4 : kBare;
}

// What one sample of the surface, or a row of them, adds.
struct Areas {
  StateAreas twice_seen = {}, parallax = {};
};

SampleState AddSample(const SurveyTruth& truth, const SurfaceVisibility& visibility,
                      const PointIndex& index, const Sample& sample, Areas* areas) {
  const std::vector<Sighting> sightings = visibility.Sightings(sample.place, sample.normal);
  if (sightings.size() < 2) return kNotSeen;
  double squared = kBeyond;
  index.Nearest(sample.place, NearestOf::kAnyPoint, &squared);
  const double nearest = std::sqrt(squared);
  const SampleState state = StateOf(nearest, truth.gsd);
  areas->twice_seen[state] += sample.area;
  if (const auto own_gsd = BestPairGsd(sightings)) {
    areas->parallax[StateOf(nearest, *own_gsd)] += sample.area;
  }
  return state;
}

}  // namespace

SurfaceSamples SampleSurface(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                             int num_threads) {
  const Surface& surface = truth.surface;
  const Sheet& object = surface.Object();
  const SurfaceVisibility visibility(truth);
  PointVector places;
  places.reserve(points.size());
  for (const Eigen::Vector3f& p : points) places.push_back(p.cast<double>());
  const PointIndex index(places);
  SurfaceSamples samples;
  samples.nx = (surface.Ground().Grid().nx - 1) / kSampleStep;
  samples.ny = (surface.Ground().Grid().ny - 1) / kSampleStep;
  samples.ground.assign(static_cast<size_t>(samples.nx) * static_cast<size_t>(samples.ny),
                        kNotSeen);
  const int object_nx = object.Empty() ? 0 : (object.NumX() - 1) / kSampleStep;
  const int object_ny = object.Empty() ? 0 : (object.NumY() - 1) / kSampleStep;
  std::vector<Areas> rows(static_cast<size_t>(samples.ny) + static_cast<size_t>(object_ny));
  ParallelFor(num_threads, static_cast<int64_t>(rows.size()), [&](int64_t j) {
    Areas* row = &rows[static_cast<size_t>(j)];
    const bool is_ground = j < samples.ny;
    for (int i = 0; i < (is_ground ? samples.nx : object_nx); ++i) {
      const Sample sample =
          is_ground ? GroundSample(surface, i, j) : ObjectSample(object, i, j - samples.ny);
      const SampleState state = AddSample(truth, visibility, index, sample, row);
      if (is_ground) {
        samples.ground[static_cast<size_t>(j) * static_cast<size_t>(samples.nx) +
                       static_cast<size_t>(i)] = state;
      }
    }
  });
  for (const Areas& row : rows) {
    for (size_t s = 0; s < kNumSampleStates; ++s) {
      samples.twice_seen[s] += row.twice_seen[s];
      samples.parallax[s] += row.parallax[s];
    }
  }
  return samples;
}

double SeenArea(const StateAreas& areas) {
  return areas[kCovered4] + areas[kCovered2] + areas[kBare];
}

double CoveredShare(const StateAreas& areas, SampleState state) {
  const double seen = SeenArea(areas);
  if (seen <= 0) return 0;
  return (state == kCovered2 ? areas[kCovered2] : areas[kCovered4] + areas[kCovered2]) / seen;
}

}  // namespace colmap_seapoint
