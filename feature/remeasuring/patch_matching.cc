#include "feature/remeasuring/patch_matching.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace colmap_seapoint {
namespace {

using warp::Patch;

constexpr int kMaxIterations = 12;
constexpr double kSmallStep = 0.003;  // pixels: no further step
constexpr double kMaxDrift = 2;       // pixels from the best whole one
constexpr double kMinGradient = 1.5;  // rms in the weakest direction, grey values a pixel
constexpr int kNumPixels = (2 * warp::kReach + 1) * (2 * warp::kReach + 1);
// Correlation by whole pixels is less than at the very place.
constexpr double kSearchSlack = 0.2;

// other = gain * patch + offset + gain * gradient . shift
constexpr int kNumParameters = 4;
using Vector = Eigen::Matrix<double, kNumParameters, 1>;
using Matrix = Eigen::Matrix<double, kNumParameters, kNumParameters>;

// The parameters' columns, each zero where the rows are filled up.
struct Design {
  std::array<Patch, kNumParameters> columns;
  Matrix normal;
  Eigen::LDLT<Matrix> inverse;
};

double Gray(const ReferencePatch& reference, int i, int j) {
  constexpr int kReach = ReferencePatch::kReach, kSide = ReferencePatch::kSide;
  return reference.gray[static_cast<size_t>((j + kReach) * kSide + i + kReach)];
}

template <typename Function>
Patch MakePatch(const Function& value) {
  Patch patch = {};
  for (int j = -warp::kReach; j <= warp::kReach; ++j) {
    for (int i = -warp::kReach; i <= warp::kReach; ++i) {
      const int at = (j + warp::kReach) * warp::Stride(warp::kReach) + i + warp::kReach;
      patch[static_cast<size_t>(at)] = static_cast<float>(value(i, j));
    }
  }
  return patch;
}

double MeanOf(const ReferencePatch& reference) {
  double sum = 0;
  for (int j = -warp::kReach; j <= warp::kReach; ++j) {
    for (int i = -warp::kReach; i <= warp::kReach; ++i) sum += Gray(reference, i, j);
  }
  return sum / kNumPixels;
}

Design MakeDesign(const ReferencePatch& reference) {
  Design d;
  const double mean = MeanOf(reference);
  d.columns[0] = MakePatch([&](int i, int j) { return Gray(reference, i, j) - mean; });
  d.columns[1] = MakePatch([](int, int) { return 1; });
  d.columns[2] = MakePatch(
      [&](int i, int j) { return 0.5 * (Gray(reference, i + 1, j) - Gray(reference, i - 1, j)); });
  d.columns[3] = MakePatch(
      [&](int i, int j) { return 0.5 * (Gray(reference, i, j + 1) - Gray(reference, i, j - 1)); });
  for (int a = 0; a < kNumParameters; ++a) {
    for (int b = 0; b <= a; ++b) {
      d.normal(a, b) = d.normal(b, a) =
          warp::Dot(d.columns[static_cast<size_t>(a)], d.columns[static_cast<size_t>(b)]);
    }
  }
  d.inverse.compute(d.normal);
  return d;
}

bool HasTexture(const Design& design) {
  const Eigen::Matrix2d gradients = design.normal.block<2, 2>(2, 2);
  const double weakest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(gradients, Eigen::EigenvaluesOnly)
          .eigenvalues()[0];
  return weakest > kNumPixels * kMinGradient * kMinGradient;
}

warp::Placement PlacementOf(const PredictedPlace& place) {
  const Eigen::Matrix2f a = place.other_from_reference.cast<float>();
  return {place.pixel.x() - 0.5, place.pixel.y() - 0.5, a(0, 0), a(1, 0), a(0, 1), a(1, 1)};
}

// The place of the best correlation, a fraction of a pixel off; nullopt at the rim, or where
// nothing correlates.
class Search {
 public:
  Search(const Patch& patch, const GrayImage& picture, const PredictedPlace& predicted) {
    std::array<float, warp::WindowSize(warp::kWideReach)> window;
    warp::SampleWindow(picture, PlacementOf(predicted), warp::kWideReach, window.data());
    warp::WholePatch whole_patch;
    warp::WholeWindow whole_window;
    std::transform(patch.begin(), patch.end(), whole_patch.begin(), Rounded);
    std::transform(window.begin(), window.end(), whole_window.begin(), Rounded);
    std::array<warp::ShiftSums, warp::kShifts * warp::kShifts> sums;
    warp::SumShifts(whole_patch, whole_window, &sums);
    double patch_sum = 0, patch_patch = 0;
    for (const int16_t value : whole_patch) {
      patch_sum += value;
      patch_patch += value * value;
    }
    const double patch_variance = patch_patch - patch_sum * patch_sum / kNumPixels;
    for (size_t i = 0; i < sums.size(); ++i) {
      const double other = sums[i].other;
      const double variance = sums[i].other_other - other * other / kNumPixels;
      const double covariance = sums[i].patch_other - patch_sum * other / kNumPixels;
      correlation_[i] = variance > 0 ? covariance / std::sqrt(variance * patch_variance) : 0;
    }
  }

  // In pixels of the reference.
  std::optional<Eigen::Vector2d> Best(double min_correlation) const {
    const auto best = std::max_element(correlation_.begin(), correlation_.end());
    if (!(*best >= min_correlation)) return std::nullopt;
    const int at = static_cast<int>(best - correlation_.begin());
    const int x = at % warp::kShifts, y = at / warp::kShifts;
    if (IsRim(x) || IsRim(y)) return std::nullopt;
    return Eigen::Vector2d(x - warp::kSearch + Peak(at, 1),
                           y - warp::kSearch + Peak(at, warp::kShifts));
  }
  double BestCorrelation() const {
    return *std::max_element(correlation_.begin(), correlation_.end());
  }

 private:
  static int16_t Rounded(float value) { return static_cast<int16_t>(std::lround(value)); }
  static bool IsRim(int shift) { return shift == 0 || shift == warp::kShifts - 1; }

  // Of the parabola through three neighbours.
  double Peak(int at, int step) const {
    const double before = correlation_[static_cast<size_t>(at - step)];
    const double here = correlation_[static_cast<size_t>(at)];
    const double behind = correlation_[static_cast<size_t>(at + step)];
    const double bend = 2 * here - before - behind;
    return bend > 0 ? 0.5 * (behind - before) / bend : 0;
  }

  std::array<double, warp::kShifts * warp::kShifts> correlation_;
};

// What the patch's parameters are at a place, and how well they explain the grey values.
struct Fit {
  double gain;
  Eigen::Vector2d shift;  // pixels of the reference
  double residual_variance, correlation;
};

Fit FitAt(const Design& design, const GrayImage& picture, const PredictedPlace& place) {
  Patch other;
  warp::SampleWindow(picture, PlacementOf(place), warp::kReach, other.data());
  for (int j = 0; j <= 2 * warp::kReach; ++j) {
    other[static_cast<size_t>((j + 1) * warp::Stride(warp::kReach) - 1)] = 0;
  }
  Vector right;
  for (int a = 0; a < kNumParameters; ++a) {
    right[a] = warp::Dot(design.columns[static_cast<size_t>(a)], other);
  }
  const Vector solution = design.inverse.solve(right);
  const double other_other = warp::Dot(other, other);
  const double other_variance = other_other - right[1] * right[1] / kNumPixels;
  const double unexplained = std::max(0.0, other_other - right.dot(solution));
  return {solution[0], solution.tail<2>() / solution[0],
          unexplained / (kNumPixels - kNumParameters),
          right[0] / std::sqrt(std::max(1e-9, other_variance * design.normal(0, 0)))};
}

// The picture shows at sample s what the patch holds at s + shift.
void Move(const Fit& fit, PredictedPlace* place) {
  place->pixel -= place->other_from_reference * fit.shift;
}

double SigmaOf(const Design& design, const Fit& fit, const PredictedPlace& place) {
  const Matrix inverse = design.inverse.solve(Matrix::Identity());
  const Eigen::Matrix2d covariance = place.other_from_reference * inverse.block<2, 2>(2, 2) *
                                     place.other_from_reference.transpose() *
                                     fit.residual_variance / (fit.gain * fit.gain);
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues()[1];
  return std::sqrt(std::max(0.0, largest));
}

PatchMatchStatus StatusOf(const PatchMatch& match) {
  if (!(match.correlation >= kMinPatchCorrelation)) return PatchMatchStatus::kUnlike;
  return match.sigma <= kMaxPatchSigma ? PatchMatchStatus::kMatched : PatchMatchStatus::kUnsure;
}

PatchMatch Refine(const Design& design, const GrayImage& picture, const PredictedPlace& start) {
  PatchMatch match;
  PredictedPlace place = start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!((place.pixel - start.pixel).norm() <= kMaxDrift)) break;
    if (!warp::IsInside(picture, PlacementOf(place), warp::kReach)) {
      match.status = PatchMatchStatus::kOutside;
      return match;
    }
    const Fit fit = FitAt(design, picture, place);
    if (!(fit.gain > 0)) break;
    Move(fit, &place);
    if (!(fit.shift.norm() <= kSmallStep)) continue;
    match.pixel = place.pixel;
    match.correlation = fit.correlation;
    match.sigma = SigmaOf(design, fit, place);
    match.status = StatusOf(match);
    return match;
  }
  match.status = PatchMatchStatus::kDiverged;
  return match;
}

}  // namespace

PatchMatch MatchPatch(const ReferencePatch& reference, const GrayImage& picture,
                      const PredictedPlace& predicted) {
  PatchMatch match;
  if (!warp::IsInside(picture, PlacementOf(predicted), warp::kWideReach)) {
    match.status = PatchMatchStatus::kOutside;
    return match;
  }
  const Design design = MakeDesign(reference);
  if (!HasTexture(design)) {
    match.status = PatchMatchStatus::kNoTexture;
    return match;
  }
  const Search search(design.columns[0], picture, predicted);
  constexpr double kMinCorrelation = kMinPatchCorrelation - kSearchSlack;
  const auto shift = search.Best(kMinCorrelation);
  if (!shift) {
    match.status = search.BestCorrelation() >= kMinCorrelation ? PatchMatchStatus::kDiverged
                                                               : PatchMatchStatus::kUnlike;
    return match;
  }
  PredictedPlace start = predicted;
  start.pixel += start.other_from_reference * *shift;
  return Refine(design, picture, start);
}

}  // namespace colmap_seapoint
