#include "examples/survey/score_coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/compare/point_index.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr int kBlock = 64;  // squares of a row that are asked for at once
constexpr size_t kMaxIndexed = size_t{1}
                               << 23;  // points of a flat ground that are searched at once
constexpr double kMarginGsd = 64;      // nothing is covered from farther away

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

class SurfaceSampler {
 public:
  explicit SurfaceSampler(const SurveyTruth& truth) : truth_(truth), visibility_(truth) {}

  // Adds to the areas, and sets the states of as many samples.
  void Add(const PointIndex& index, const std::vector<Sample>& samples, uint8_t* states,
           Areas* areas) const {
    std::vector<Eigen::Vector3d> places;
    for (const Sample& sample : samples) places.push_back(sample.place);
    const std::vector<size_t> pictures = visibility_.PicturesAround(places);
    for (const Sample& sample : samples) *states++ = Add(index, sample, pictures, areas);
  }

 private:
  SampleState Add(const PointIndex& index, const Sample& sample,
                  const std::vector<size_t>& pictures, Areas* areas) const {
    const auto sightings = visibility_.Sightings(sample.place, sample.normal, pictures);
    if (sightings.size() < 2) return kNotSeen;
    double squared = kBeyond;
    index.Nearest(sample.place, NearestOf::kAnyPoint, &squared);
    const double nearest = std::sqrt(squared);
    const SampleState state = StateOf(nearest, truth_.gsd);
    areas->twice_seen[state] += sample.area;
    if (const auto own_gsd = BestPairGsd(sightings)) {
      areas->parallax[StateOf(nearest, *own_gsd)] += sample.area;
    }
    return state;
  }

  const SurveyTruth& truth_;
  SurfaceVisibility visibility_;
};

// The points that may cover squares of rows [begin, end) of the ground.
PointVector PointsOfRows(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                         int64_t begin, int64_t end) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  const double side = kSampleStep * grid.step, margin = kMarginGsd * truth.gsd;
  const double low = grid.MinY() + static_cast<double>(begin) * side - margin;
  const double high = grid.MinY() + static_cast<double>(end) * side + margin;
  PointVector places;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d place = p.cast<double>();
    const double y = truth.surface.InGround(place).y();
    if (y >= low && y <= high) places.push_back(place);
  }
  return places;
}

void AddAreas(const std::vector<Areas>& rows, SurfaceSamples* samples) {
  for (const Areas& row : rows) {
    for (size_t s = 0; s < kNumSampleStates; ++s) {
      samples->twice_seen[s] += row.twice_seen[s];
      samples->parallax[s] += row.parallax[s];
    }
  }
}

// In bands of rows, so that only the points around them are indexed.
void SampleGround(const SurveyTruth& truth, const SurfaceSampler& sampler,
                  const std::vector<Eigen::Vector3f>& points, int num_threads,
                  SurfaceSamples* samples) {
  const int64_t num_bands = static_cast<int64_t>(points.size() / kMaxIndexed) + 1;
  std::vector<Areas> rows(static_cast<size_t>(samples->ny));
  for (int64_t band = 0; band < num_bands; ++band) {
    const int64_t begin = samples->ny * band / num_bands;
    const int64_t end = samples->ny * (band + 1) / num_bands;
    const PointVector places = PointsOfRows(truth, points, begin, end);
    const PointIndex index(places);
    ParallelFor(num_threads, end - begin, [&](int64_t k) {
      const int64_t j = begin + k;
      for (int i = 0; i < samples->nx; i += kBlock) {
        std::vector<Sample> block;
        for (int m = i; m < std::min(i + kBlock, samples->nx); ++m) {
          block.push_back(GroundSample(truth.surface, m, j));
        }
        sampler.Add(index, block, &samples->ground[static_cast<size_t>(j * samples->nx + i)],
                    &rows[static_cast<size_t>(j)]);
      }
    });
  }
  AddAreas(rows, samples);
}

void SampleObject(const Sheet& object, const SurfaceSampler& sampler,
                  const std::vector<Eigen::Vector3f>& points, int num_threads,
                  SurfaceSamples* samples) {
  if (object.Empty()) return;
  PointVector places;
  for (const Eigen::Vector3f& p : points) places.push_back(p.cast<double>());
  const PointIndex index(places);
  std::vector<Areas> rows(static_cast<size_t>((object.NumY() - 1) / kSampleStep));
  ParallelFor(num_threads, static_cast<int64_t>(rows.size()), [&](int64_t j) {
    std::vector<Sample> row;
    for (int i = 0; i < (object.NumX() - 1) / kSampleStep; ++i) {
      row.push_back(ObjectSample(object, i, j));
    }
    std::vector<uint8_t> states(row.size());
    sampler.Add(index, row, states.data(), &rows[static_cast<size_t>(j)]);
  });
  AddAreas(rows, samples);
}

}  // namespace

SurfaceSamples SampleSurface(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                             int num_threads) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  const SurfaceSampler sampler(truth);
  SurfaceSamples samples;
  samples.nx = (grid.nx - 1) / kSampleStep;
  samples.ny = (grid.ny - 1) / kSampleStep;
  samples.ground.assign(static_cast<size_t>(samples.nx) * static_cast<size_t>(samples.ny),
                        kNotSeen);
  SampleGround(truth, sampler, points, num_threads, &samples);
  SampleObject(truth.surface.Object(), sampler, points, num_threads, &samples);
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
