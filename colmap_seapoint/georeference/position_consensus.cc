#include "colmap_seapoint/georeference/position_consensus.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

namespace colmap_seapoint {
namespace {

constexpr size_t kMaxSamples = 3000;
constexpr size_t kMinForOutliers = 5;
constexpr int kMaxRounds = 30;
// Median length of a vector of three normal numbers.
constexpr double kMedianOfChi3 = 1.5382;
// A direction nearer to the line than this (sine of the angle) cannot tell the turn about it.
constexpr double kMinLevellingSine = 0.2;
// Exact positions scatter by nothing; they agree when they do within this share of their extent.
constexpr double kExact = 1e-9;

using Indices = std::vector<size_t>;

// Least squares of all three axes alike; nullopt where the chosen positions are all in one place.
std::optional<Similarity3d> FitAll(const std::vector<PositionMeasurement>& positions,
                                   const Indices& chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Eigen::Matrix3Xd from(3, count), to(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    from.col(i) = positions[chosen[static_cast<size_t>(i)]].in_model;
    to.col(i) = positions[chosen[static_cast<size_t>(i)]].metres;
  }
  const Eigen::Vector3d mean = from.rowwise().mean();
  const double extent = (from.colwise() - mean).norm();
  if (!(extent > 1e-12 * (1 + from.norm()))) return std::nullopt;
  const Eigen::Matrix4d fit = Eigen::umeyama(from, to, true);
  Similarity3d similarity;
  similarity.scale = fit.topLeftCorner<3, 1>().norm();
  if (!(similarity.scale > 0) || !fit.allFinite()) return std::nullopt;
  const Eigen::Matrix3d rotation = fit.topLeftCorner<3, 3>() / similarity.scale;
  similarity.rotation = Eigen::Quaterniond(rotation).normalized();
  similarity.translation = fit.topRightCorner<3, 1>();
  return similarity;
}

// For positions on a line: the line through the chosen ones, then the levelled turn about it.
std::optional<Similarity3d> FitLine(const std::vector<PositionMeasurement>& positions,
                                    const Indices& chosen, const Eigen::Vector3d& down_in_model) {
  Eigen::Vector3d from_mean = Eigen::Vector3d::Zero(), to_mean = from_mean;
  for (const size_t i : chosen) {
    from_mean += positions[i].in_model / static_cast<double>(chosen.size());
    to_mean += positions[i].metres / static_cast<double>(chosen.size());
  }
  // The model's own line is exact enough to be the axis; the measured one follows by least squares.
  size_t farthest = chosen.front();
  for (const size_t i : chosen) {
    if ((positions[i].in_model - from_mean).norm() >
        (positions[farthest].in_model - from_mean).norm()) {
      farthest = i;
    }
  }
  const Eigen::Vector3d axis = (positions[farthest].in_model - from_mean).normalized();
  double square = 0;
  Eigen::Vector3d to_axis = Eigen::Vector3d::Zero();
  for (const size_t i : chosen) {
    const double along = axis.dot(positions[i].in_model - from_mean);
    square += along * along;
    to_axis += along * (positions[i].metres - to_mean);
  }
  return LevelledSimilarity({from_mean, to_mean}, {from_mean + axis, to_mean + to_axis / square},
                            down_in_model);
}

// Draws minimal samples: all of them in order, where they are few; else random ones.
class Sampler {
 public:
  Sampler(size_t num_positions, size_t sample_size, int seed)
      : num_positions_(num_positions),
        sample_size_(sample_size),
        random_(static_cast<uint64_t>(seed)) {}

  // The next sample, valid until the next call; nullptr after the last one.
  const Indices* Next() {
    const bool has_next = IsExhaustive() ? NextInOrder() : NextAtRandom();
    return has_next ? &sample_ : nullptr;
  }

 private:
  bool IsExhaustive() const {
    const double n = static_cast<double>(num_positions_);
    const double count = sample_size_ == 2 ? n * (n - 1) / 2 : n * (n - 1) * (n - 2) / 6;
    return count <= static_cast<double>(kMaxSamples);
  }

  bool NextInOrder() {
    if (sample_.empty()) {
      sample_.resize(sample_size_);
      std::iota(sample_.begin(), sample_.end(), size_t{0});
      return true;
    }
    size_t k = sample_size_;
    while (k > 0 && sample_[k - 1] == num_positions_ - sample_size_ + k - 1) --k;
    if (k == 0) return false;
    ++sample_[k - 1];
    for (; k < sample_size_; ++k) sample_[k] = sample_[k - 1] + 1;
    return true;
  }

  bool NextAtRandom() {
    if (num_drawn_++ == kMaxSamples) return false;
    sample_.clear();
    while (sample_.size() < sample_size_) {
      const size_t i = static_cast<size_t>(random_() % num_positions_);
      if (std::find(sample_.begin(), sample_.end(), i) == sample_.end()) sample_.push_back(i);
    }
    return true;
  }

  const size_t num_positions_, sample_size_;
  std::mt19937_64 random_;
  size_t num_drawn_ = 0;
  Indices sample_;
};

// Of the camera centres, in metres, over the given sigma where there is one.
double Extent(const std::vector<PositionMeasurement>& positions, const Similarity3d& similarity) {
  Eigen::Vector3d low = positions.front().in_model, high = low;
  for (const PositionMeasurement& position : positions) {
    low = low.cwiseMin(position.in_model);
    high = high.cwiseMax(position.in_model);
  }
  const double sigma = positions.front().sigma.maxCoeff();
  return similarity.scale * (high - low).norm() / (sigma > 0 ? sigma : 1);
}

using Fit = std::function<std::optional<Similarity3d>(const Indices&)>;

struct Start {
  std::optional<Similarity3d> similarity;
  double sigma = std::numeric_limits<double>::infinity();
};

// The minimal sample whose similarity leaves the smallest h-th residual.
Start LeastQuantile(const std::vector<PositionMeasurement>& positions, size_t sample_size, int seed,
                    const Fit& fit) {
  const size_t count = positions.size();
  const auto rank = static_cast<std::ptrdiff_t>(std::min(count - 1, count / 2 + 1));
  std::vector<double> residuals(count);
  Sampler sampler(count, sample_size, seed);
  Start start;
  double best = std::numeric_limits<double>::infinity();
  while (const Indices* sample = sampler.Next()) {
    const auto similarity = fit(*sample);
    if (!similarity) continue;
    for (size_t i = 0; i < count; ++i) {
      residuals[i] = NormalisedResidual(positions[i], *similarity);
    }
    std::nth_element(residuals.begin(), residuals.begin() + rank, residuals.end());
    if (residuals[static_cast<size_t>(rank)] >= best) continue;
    best = residuals[static_cast<size_t>(rank)];
    start.similarity = similarity;
  }
  // Where positions are few, the best minimal sample leaves residuals that are too small.
  start.sigma = best / kMedianOfChi3 * (1 + 5.0 / static_cast<double>(count));
  return start;
}

// Standard deviation from the residuals of the chosen positions.
double Scatter(const std::vector<PositionMeasurement>& positions, const Indices& chosen,
               const Similarity3d& similarity, double num_unknowns) {
  double square = 0;
  for (const size_t i : chosen) square += std::pow(NormalisedResidual(positions[i], similarity), 2);
  const double freedom = 3 * static_cast<double>(chosen.size()) - num_unknowns;
  return std::sqrt(square / std::max(1.0, freedom));
}

Indices Agreeing(const std::vector<PositionMeasurement>& positions, const Similarity3d& similarity,
                 double sigma) {
  Indices agreeing;
  for (size_t i = 0; i < positions.size(); ++i) {
    const double residual = NormalisedResidual(positions[i], similarity);
    if (!(residual > kMaxPositionResidual * sigma)) agreeing.push_back(i);
  }
  return agreeing;
}

}  // namespace

double NormalisedResidual(const PositionMeasurement& position, const Similarity3d& similarity) {
  Eigen::Vector3d residual = similarity * position.in_model - position.metres;
  if (position.sigma.minCoeff() > 0) residual = residual.cwiseQuotient(position.sigma);
  return residual.norm();
}

std::optional<Similarity3d> LevelledSimilarity(const PositionMeasurement& a,
                                               const PositionMeasurement& b,
                                               const Eigen::Vector3d& down_in_model) {
  const Eigen::Vector3d from = b.in_model - a.in_model, to = b.metres - a.metres;
  if (!(from.norm() > 0) || !(to.norm() > 0)) return std::nullopt;
  const Eigen::Vector3d from_across = from.normalized().cross(down_in_model.normalized());
  const Eigen::Vector3d to_across = to.normalized().cross(-Eigen::Vector3d::UnitZ());
  if (from_across.norm() < kMinLevellingSine || to_across.norm() < kMinLevellingSine) {
    return std::nullopt;
  }
  const auto frame = [](const Eigen::Vector3d& along, const Eigen::Vector3d& across) {
    Eigen::Matrix3d axes;
    axes.col(0) = along.normalized();
    axes.col(1) = across.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  };
  Similarity3d similarity;
  similarity.scale = to.norm() / from.norm();
  similarity.rotation = Eigen::Quaterniond(
      Eigen::Matrix3d(frame(to, to_across) * frame(from, from_across).transpose()));
  similarity.rotation.normalize();
  similarity.translation = a.metres - similarity.scale * (similarity.rotation * a.in_model);
  return similarity;
}

std::optional<PositionConsensus> FindPositionConsensus(
    const std::vector<PositionMeasurement>& positions,
    const std::optional<Eigen::Vector3d>& down_in_model, int seed) {
  const Fit fit = [&](const Indices& chosen) {
    return down_in_model ? FitLine(positions, chosen, *down_in_model) : FitAll(positions, chosen);
  };
  const size_t count = positions.size(), sample_size = down_in_model ? 2 : 3;
  const double num_unknowns = down_in_model ? 6 : 7;
  if (count < sample_size) return std::nullopt;
  Indices inliers(count);
  std::iota(inliers.begin(), inliers.end(), size_t{0});
  Start start;
  if (count < kMinForOutliers) {
    start.similarity = fit(inliers);
    if (start.similarity) {
      start.sigma = Scatter(positions, inliers, *start.similarity, num_unknowns);
    }
  } else {
    start = LeastQuantile(positions, sample_size, seed, fit);
  }
  if (!start.similarity) return std::nullopt;
  PositionConsensus result;
  result.metric_from_model = *start.similarity;
  const double floor = kExact * Extent(positions, *start.similarity);
  result.sigma_factor = std::max(start.sigma, floor);
  for (int round = 0; round < kMaxRounds && count >= kMinForOutliers; ++round) {
    const Indices now = Agreeing(positions, result.metric_from_model, result.sigma_factor);
    const bool is_settled = round > 0 && now == inliers;
    inliers = now;
    const auto refined = fit(inliers);
    if (is_settled || inliers.size() < sample_size || !refined) break;
    result.metric_from_model = *refined;
    result.sigma_factor = std::max(Scatter(positions, inliers, *refined, num_unknowns), floor);
  }
  result.is_inlier.assign(count, false);
  for (const size_t i : inliers) result.is_inlier[i] = true;
  return result;
}

}  // namespace colmap_seapoint
