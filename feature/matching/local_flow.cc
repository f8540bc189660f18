#include "feature/matching/local_flow.h"

#include <algorithm>
#include <complex>

namespace colmap_seapoint {

namespace {

using Complex = std::complex<double>;

Complex ToComplex(const SeaPoint& point) { return {point.x, point.y}; }

std::vector<SeaPoint> Starts(const std::vector<SeaPoint>& points1, const FeatureMatches& matches) {
  std::vector<SeaPoint> starts;
  starts.reserve(matches.size());
  for (const FeatureMatch& match : matches) starts.push_back(points1[match.idx1]);
  return starts;
}

}  // namespace

LocalFlow::LocalFlow(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                     const FeatureMatches& matches)
    : points1_(points1), points2_(points2), matches_(matches), tree_(Starts(points1, matches)) {}

const std::vector<uint32_t>& LocalFlow::Nearest(const SeaPoint& place, size_t count) {
  tree_.Nearest(place.x, place.y, count, &neighbors_);
  return neighbors_;
}

// In complex numbers, a rotation with a scale and a shift is to = a * from + b.
Eigen::Vector2d LocalFlow::Predict(const SeaPoint& place, std::optional<uint32_t> left_out) {
  Nearest(place, kNumNeighbors + (left_out ? 1 : 0));
  Complex mean_from = 0, mean_to = 0;
  double count = 0;
  for (const uint32_t i : neighbors_) {
    if (i == left_out) continue;
    mean_from += ToComplex(points1_[matches_[i].idx1]);
    mean_to += ToComplex(points2_[matches_[i].idx2]);
    ++count;
  }
  mean_from /= count;
  mean_to /= count;
  Complex covariance = 0;
  double scatter = 0;
  for (const uint32_t i : neighbors_) {
    if (i == left_out) continue;
    const Complex from = ToComplex(points1_[matches_[i].idx1]) - mean_from;
    covariance += (ToComplex(points2_[matches_[i].idx2]) - mean_to) * std::conj(from);
    scatter += std::norm(from);
  }
  const Complex turn = scatter > count ? covariance / scatter : Complex(1, 0);
  const Complex predicted = mean_to + turn * (ToComplex(place) - mean_from);
  return {predicted.real(), predicted.imag()};
}

std::vector<double> LocalFlow::Slips() {
  std::vector<double> slips;
  slips.reserve(matches_.size());
  for (uint32_t i = 0; i < matches_.size(); ++i) {
    const SeaPoint& to = points2_[matches_[i].idx2];
    slips.push_back((Predict(points1_[matches_[i].idx1], i) - Eigen::Vector2d(to.x, to.y)).norm());
  }
  return slips;
}

double LocalFlow::UsualSlip(const SeaPoint& place, const std::vector<double>& slips,
                            std::optional<uint32_t> left_out) {
  around_.clear();
  for (const uint32_t i : Nearest(place, kNumNeighbors + (left_out ? 1 : 0))) {
    if (i != left_out) around_.push_back(slips[i]);
  }
  if (around_.empty()) return 0;
  const auto median = around_.begin() + static_cast<std::ptrdiff_t>(around_.size() / 2);
  std::nth_element(around_.begin(), median, around_.end());
  return *median;
}

}  // namespace colmap_seapoint
