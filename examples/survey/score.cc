#include "examples/survey/score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/alignment.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr double kLimitGsd = 64;  // larger distances are not told apart
constexpr int kSampleStep = 2;    // lattice cells (about GSDs) between the samples of the surface

std::vector<float> Distances(const HeightField& surface, const std::vector<Eigen::Vector3f>& points,
                             double limit, int num_threads) {
  std::vector<float> distances(points.size());
  constexpr size_t kChunk = 4096;
  const size_t num_chunks = (points.size() + kChunk - 1) / kChunk;
  ParallelFor(num_threads, static_cast<int64_t>(num_chunks), [&](int64_t chunk) {
    const size_t begin = static_cast<size_t>(chunk) * kChunk;
    for (size_t i = begin; i < std::min(points.size(), begin + kChunk); ++i) {
      distances[i] = static_cast<float>(surface.Distance(points[i].cast<double>(), limit));
    }
  });
  return distances;
}

void SummariseDistances(std::vector<float> distances, double gsd, SurveyScore* score) {
  const double n = static_cast<double>(distances.size());
  const auto share = [&](double limit) {
    return static_cast<double>(std::count_if(distances.begin(), distances.end(),
                                             [&](float d) { return d <= limit * gsd; })) /
           n;
  };
  score->share_1gsd = share(1);
  score->share_2gsd = share(2);
  score->share_4gsd = share(4);
  for (float d : distances) score->mean_gsd += d / gsd / n;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  score->median_gsd = *middle / gsd;
}

// Points by square of the ground plan, for "is there one within `cell`?".
class PointBins {
 public:
  PointBins(const HeightField& surface, const std::vector<Eigen::Vector3f>& points, double cell)
      : points_(points),
        cell_(cell),
        min_x_(surface.Grid().MinX() - cell),
        min_y_(surface.Grid().MinY() - cell) {
    nx_ = static_cast<int>((surface.Grid().MaxX() - min_x_) / cell) + 2;
    ny_ = static_cast<int>((surface.Grid().MaxY() - min_y_) / cell) + 2;
    begin_.assign(static_cast<size_t>(nx_) * static_cast<size_t>(ny_) + 1, 0);
    for (const Eigen::Vector3f& p : points) {
      const int64_t bin = Bin(p.x(), p.y());
      if (bin >= 0) ++begin_[static_cast<size_t>(bin) + 1];
    }
    for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    order_.resize(begin_.back());
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (size_t i = 0; i < points.size(); ++i) {
      const int64_t bin = Bin(points[i].x(), points[i].y());
      if (bin >= 0) order_[next[static_cast<size_t>(bin)]++] = static_cast<uint32_t>(i);
    }
  }

  // Distance to the nearest point, when that is at most the cell size; else infinity. Stops early
  // at any point within `enough`.
  double Nearest(const Eigen::Vector3d& place, double enough) const {
    double best = cell_ * cell_ * (1 + 1e-9);
    bool found = false;
    const int cx = static_cast<int>((place.x() - min_x_) / cell_);
    const int cy = static_cast<int>((place.y() - min_y_) / cell_);
    for (int y = std::max(0, cy - 1); y <= std::min(ny_ - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(nx_ - 1, cx + 1); ++x) {
        const size_t bin =
            static_cast<size_t>(y) * static_cast<size_t>(nx_) + static_cast<size_t>(x);
        for (uint32_t k = begin_[bin]; k < begin_[bin + 1]; ++k) {
          const double d = (points_[order_[k]].cast<double>() - place).squaredNorm();
          if (d > best) continue;
          best = d;
          found = true;
          if (d <= enough * enough) return std::sqrt(d);
        }
      }
    }
    return found ? std::sqrt(best) : std::numeric_limits<double>::infinity();
  }

 private:
  int64_t Bin(double x, double y) const {
    const double bx = std::floor((x - min_x_) / cell_), by = std::floor((y - min_y_) / cell_);
    if (!(bx >= 0 && by >= 0 && bx < nx_ && by < ny_)) return -1;
    return static_cast<int64_t>(by) * nx_ + static_cast<int64_t>(bx);
  }

  const std::vector<Eigen::Vector3f>& points_;
  double cell_, min_x_, min_y_;
  int nx_ = 0, ny_ = 0;
  std::vector<uint32_t> begin_, order_;
};

enum SampleState : uint8_t { kNotTwiceSeen = 0, kBare, kCovered4, kCovered2 };

// The surface in squares of kSampleStep cells: which are seen twice, which have a point nearby.
struct SurfaceSamples {
  int nx = 0, ny = 0;
  std::vector<uint8_t> state;
  double area[4] = {0, 0, 0, 0};  // by state, m^2
};

SurfaceSamples SampleSurface(const SurveyTruth& truth, const PointBins& bins, int num_threads) {
  const HeightField& surface = truth.surface;
  const SurfaceVisibility visibility(truth.model, surface);
  SurfaceSamples samples;
  samples.nx = (surface.Grid().nx - 1) / kSampleStep;
  samples.ny = (surface.Grid().ny - 1) / kSampleStep;
  samples.state.assign(static_cast<size_t>(samples.nx) * static_cast<size_t>(samples.ny),
                       kNotTwiceSeen);
  const double side = kSampleStep * surface.Grid().step;
  std::vector<std::array<double, 4>> row_areas(static_cast<size_t>(samples.ny));
  ParallelFor(num_threads, samples.ny, [&](int64_t j) {
    std::array<double, 4>& areas = row_areas[static_cast<size_t>(j)];
    areas.fill(0);
    for (int i = 0; i < samples.nx; ++i) {
      const double x = surface.Grid().MinX() + (i + 0.5) * side;
      const double y = surface.Grid().MinY() + (static_cast<double>(j) + 0.5) * side;
      const Eigen::Vector3d place(x, y, surface.Height(x, y));
      const Eigen::Vector3d normal = surface.Normal(x, y);
      if (visibility.CountViews(place, normal, 2) < 2) continue;
      const double nearest = bins.Nearest(place, 2 * truth.gsd);
      const SampleState state = nearest <= 2 * truth.gsd   ? kCovered2
                                : nearest <= 4 * truth.gsd ? kCovered4
                                                           : kBare;
      samples.state[static_cast<size_t>(j) * static_cast<size_t>(samples.nx) +
                    static_cast<size_t>(i)] = state;
      areas[state] += side * side / normal.z();
    }
  });
  for (const auto& areas : row_areas) {
    for (size_t s = 0; s < 4; ++s) samples.area[s] += areas[s];
  }
  return samples;
}

void SummariseCoverage(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                       const std::vector<float>& distances, const SurfaceSamples& samples,
                       SurveyScore* score) {
  const HeightField& surface = truth.surface;
  const double covered = samples.area[kCovered4] + samples.area[kCovered2];
  score->twice_seen_m2 = covered + samples.area[kBare];
  if (score->twice_seen_m2 > 0) {
    score->coverage_2gsd = samples.area[kCovered2] / score->twice_seen_m2;
    score->coverage_4gsd = covered / score->twice_seen_m2;
  }
  const double side = kSampleStep * surface.Grid().step;
  const size_t cells_x =
      static_cast<size_t>((surface.Grid().MaxX() - surface.Grid().MinX()) / truth.gsd) + 1;
  const size_t cells_y =
      static_cast<size_t>((surface.Grid().MaxY() - surface.Grid().MinY()) / truth.gsd) + 1;
  std::vector<bool> occupied(cells_x * cells_y, false);
  size_t num_near = 0, num_cells = 0, num_on_covered = 0;
  for (size_t k = 0; k < points.size(); ++k) {
    const double x = points[k].x() - surface.Grid().MinX(),
                 y = points[k].y() - surface.Grid().MinY();
    if (distances[k] > 4 * truth.gsd || x < 0 || y < 0) continue;
    const size_t cx = static_cast<size_t>(x / truth.gsd), cy = static_cast<size_t>(y / truth.gsd);
    if (cx >= cells_x || cy >= cells_y) continue;
    ++num_near;
    num_cells += !occupied[cy * cells_x + cx];
    occupied[cy * cells_x + cx] = true;
    const size_t i = static_cast<size_t>(x / side), j = static_cast<size_t>(y / side);
    if (i >= static_cast<size_t>(samples.nx) || j >= static_cast<size_t>(samples.ny)) continue;
    num_on_covered += samples.state[j * static_cast<size_t>(samples.nx) + i] >= kCovered4;
  }
  if (covered > 0) {
    score->points_per_cm2 = static_cast<double>(num_on_covered) / (covered * 1e4);
    score->points_per_gsd2 = static_cast<double>(num_on_covered) / covered * truth.gsd * truth.gsd;
  }
  if (num_cells > 0) {
    score->redundancy = static_cast<double>(num_near) / static_cast<double>(num_cells);
  }
}

}  // namespace

SurveyScore ScoreSurvey(const SurveyTruth& truth, const SparseModel& model,
                        std::vector<Eigen::Vector3f> points, const ScoreOptions& options) {
  if (points.empty()) throw Error("the cloud", "holds no point", "densify the model first");
  SurveyScore score;
  score.gsd = truth.gsd;
  score.refined = options.refine;
  score.num_points = points.size();
  score.num_images = static_cast<int>(truth.model.images.size());
  const CentreAlignment alignment = AlignCentres(truth.model, model, options.truth_poses);
  score.num_registered = alignment.num_registered;
  score.centre_rms = alignment.rms;
  score.centre_max = alignment.max;
  Similarity3d truth_from_model = alignment.truth_from_model;
  if (options.refine) {
    truth_from_model = RefineOnSurface(truth.surface, points, truth_from_model, 40 * truth.gsd);
  }
  score.scale = truth_from_model.scale;
  for (Eigen::Vector3f& p : points) p = (truth_from_model * p.cast<double>()).cast<float>();

  const std::vector<float> distances =
      Distances(truth.surface, points, kLimitGsd * truth.gsd, options.num_threads);
  SummariseDistances(distances, truth.gsd, &score);
  const PointBins bins(truth.surface, points, 4 * truth.gsd);
  const SurfaceSamples samples = SampleSurface(truth, bins, options.num_threads);
  SummariseCoverage(truth, points, distances, samples, &score);
  return score;
}

}  // namespace colmap_seapoint
