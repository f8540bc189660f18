#include "examples/survey/score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/alignment.h"
#include "examples/survey/score_coverage.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr double kLimitGsd = 64;  // larger distances are not told apart
constexpr size_t kChunk = 4096;   // points a task

// Calls work(begin, end) for chunks of points, which lie close together as the cloud lists them.
template <typename Work>
void ForEachChunk(const std::vector<Eigen::Vector3f>& points, int num_threads, const Work& work) {
  const size_t num_chunks = (points.size() + kChunk - 1) / kChunk;
  ParallelFor(num_threads, static_cast<int64_t>(num_chunks), [&](int64_t chunk) {
    const size_t begin = static_cast<size_t>(chunk) * kChunk;
    work(begin, std::min(points.size(), begin + kChunk));
  });
}

std::vector<float> DistancesToSurface(const SurveyTruth& truth,
                                      const std::vector<Eigen::Vector3f>& points, int num_threads) {
  std::vector<float> distances(points.size());
  ForEachChunk(points, num_threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      distances[i] = static_cast<float>(
          truth.surface.Distance(points[i].cast<double>(), kLimitGsd * truth.gsd));
    }
  });
  return distances;
}

// The best that two pictures that hold the point can do; without two, the best of one.
double OwnGsd(const std::vector<Sighting>& sightings, double mean_gsd) {
  if (const auto pair_gsd = BestPairGsd(sightings)) return *pair_gsd;
  double best = sightings.empty() ? mean_gsd : sightings[0].gsd;
  for (const Sighting& sighting : sightings) best = std::min(best, sighting.gsd);
  return best;
}

std::vector<float> OwnGsds(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                           int num_threads) {
  const SurfaceVisibility visibility(truth);
  std::vector<float> own_gsd(points.size());
  ForEachChunk(points, num_threads, [&](size_t begin, size_t end) {
    std::vector<Eigen::Vector3d> places(end - begin);
    for (size_t i = begin; i < end; ++i) places[i - begin] = points[i].cast<double>();
    const std::vector<size_t> pictures = visibility.PicturesAround(places);
    for (size_t i = begin; i < end; ++i) {
      const auto sightings = visibility.InFrames(places[i - begin], pictures);
      own_gsd[i] = static_cast<float>(OwnGsd(sightings, truth.gsd));
    }
  });
  return own_gsd;
}

AccuracyScore Accuracy(std::vector<float> distances, double gsd) {
  AccuracyScore score;
  const double n = static_cast<double>(distances.size());
  const auto share = [&](double limit) {
    return static_cast<double>(std::count_if(distances.begin(), distances.end(),
                                             [&](float d) { return d <= limit * gsd; })) /
           n;
  };
  score.share_1gsd = share(1);
  score.share_2gsd = share(2);
  score.share_4gsd = share(4);
  for (float d : distances) score.mean_gsd += d / gsd / n;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  score.median_gsd = *middle / gsd;
  return score;
}

std::vector<float> Ratios(const std::vector<float>& distances, const std::vector<float>& gsd) {
  std::vector<float> ratios(distances.size());
  for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = distances[i] / gsd[i];
  return ratios;
}

// The points within 4 GSD of the surface, those of them on covered surface, and the cells of 1 GSD
// that hold any.
struct NearPoints {
  size_t num_near = 0, num_on_covered = 0, num_cells = 0;
};

NearPoints CountOnGround(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                         const std::vector<float>& distances, const SurfaceSamples& samples) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  const double side = kSampleStep * grid.step;
  const size_t cells_x = static_cast<size_t>((grid.MaxX() - grid.MinX()) / truth.gsd) + 1;
  const size_t cells_y = static_cast<size_t>((grid.MaxY() - grid.MinY()) / truth.gsd) + 1;
  std::vector<bool> occupied(cells_x * cells_y, false);
  NearPoints near;
  for (size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d place = truth.surface.InGround(points[k].cast<double>());
    const double x = place.x() - grid.MinX(), y = place.y() - grid.MinY();
    if (distances[k] > 4 * truth.gsd || x < 0 || y < 0) continue;
    const size_t cx = static_cast<size_t>(x / truth.gsd), cy = static_cast<size_t>(y / truth.gsd);
    if (cx >= cells_x || cy >= cells_y) continue;
    ++near.num_near;
    near.num_cells += !occupied[cy * cells_x + cx];
    occupied[cy * cells_x + cx] = true;
    const size_t i = static_cast<size_t>(x / side), j = static_cast<size_t>(y / side);
    if (i >= static_cast<size_t>(samples.nx) || j >= static_cast<size_t>(samples.ny)) continue;
    near.num_on_covered += samples.ground[j * static_cast<size_t>(samples.nx) + i] >= kCovered4;
  }
  return near;
}

NearPoints CountInSpace(const std::vector<Eigen::Vector3f>& points,
                        const std::vector<float>& distances, double gsd) {
  NearPoints near;
  std::vector<std::array<int32_t, 3>> cells;
  for (size_t k = 0; k < points.size(); ++k) {
    if (distances[k] > 4 * gsd) continue;
    const Eigen::Array3d cell = (points[k].cast<double>().array() / gsd).floor();
    cells.push_back({static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
                     static_cast<int32_t>(cell.z())});
  }
  near.num_near = near.num_on_covered = cells.size();
  std::sort(cells.begin(), cells.end());
  near.num_cells = static_cast<size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
  return near;
}

// Mean number of points in an occupied cell of their own GSD, of those within 4 of it. The sizes of
// cells go in steps of a quarter octave: points of one place have one GSD, and share their cells.
double OwnRedundancy(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                     const std::vector<float>& ratios, const std::vector<float>& own_gsd) {
  const bool is_flat = truth.surface.Object().Empty();
  std::vector<std::array<int32_t, 4>> cells;
  for (size_t k = 0; k < points.size(); ++k) {
    if (ratios[k] > 4) continue;
    const double octaves = std::log2(static_cast<double>(own_gsd[k]) / truth.gsd);
    const int32_t level = static_cast<int32_t>(std::lround(4 * octaves));
    const Eigen::Array3d place = truth.surface.InGround(points[k].cast<double>());
    const Eigen::Array3d cell = (place / (truth.gsd * std::exp2(0.25 * level))).floor();
    cells.push_back({level, static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
                     is_flat ? 0 : static_cast<int32_t>(cell.z())});
  }
  if (cells.empty()) return 0;
  std::sort(cells.begin(), cells.end());
  const auto end = std::unique(cells.begin(), cells.end());
  return static_cast<double>(cells.size()) / static_cast<double>(end - cells.begin());
}

void SummariseCoverage(const SurveyTruth& truth, const std::vector<Eigen::Vector3f>& points,
                       const std::vector<float>& distances, const SurfaceSamples& samples,
                       SurveyScore* score) {
  score->twice_seen_m2 = SeenArea(samples.twice_seen);
  score->coverage_2gsd = CoveredShare(samples.twice_seen, kCovered2);
  score->coverage_4gsd = CoveredShare(samples.twice_seen, kCovered4);
  score->parallax_seen_m2 = SeenArea(samples.parallax);
  score->parallax_coverage_2gsd = CoveredShare(samples.parallax, kCovered2);
  score->parallax_coverage_4gsd = CoveredShare(samples.parallax, kCovered4);
  const NearPoints near = truth.surface.Object().Empty()
                              ? CountOnGround(truth, points, distances, samples)
                              : CountInSpace(points, distances, truth.gsd);
  const double covered = samples.twice_seen[kCovered4] + samples.twice_seen[kCovered2];
  if (covered > 0) {
    const double num = static_cast<double>(near.num_on_covered);
    score->points_per_cm2 = num / (covered * 1e4);
    score->points_per_gsd2 = num / covered * truth.gsd * truth.gsd;
  }
  if (near.num_cells > 0) {
    score->redundancy = static_cast<double>(near.num_near) / static_cast<double>(near.num_cells);
  }
}

}  // namespace

SurveyScore ScoreSurvey(const SurveyTruth& truth, const SparseModel& model, ScoredCloud cloud,
                        const ScoreOptions& options) {
  std::vector<Eigen::Vector3f>& points = cloud.points;
  if (points.empty()) throw Error("the cloud", "holds no point", "densify the model first");
  SEAPOINT_CHECK(cloud.view_gsd.empty() || cloud.view_gsd.size() == points.size());
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

  const std::vector<float> distances = DistancesToSurface(truth, points, options.num_threads);
  const std::vector<float> own_gsd = OwnGsds(truth, points, options.num_threads);
  score.accuracy = Accuracy(distances, truth.gsd);
  const std::vector<float> own_ratios = Ratios(distances, own_gsd);
  score.own_accuracy = Accuracy(own_ratios, 1);
  score.own_redundancy = OwnRedundancy(truth, points, own_ratios, own_gsd);
  score.has_views = !cloud.view_gsd.empty();
  if (score.has_views) {
    for (float& gsd : cloud.view_gsd) gsd *= static_cast<float>(score.scale);
    score.view_accuracy = Accuracy(Ratios(distances, cloud.view_gsd), 1);
  }
  const SurfaceSamples samples = SampleSurface(truth, points, options.num_threads);
  SummariseCoverage(truth, points, distances, samples, &score);
  return score;
}

}  // namespace colmap_seapoint
