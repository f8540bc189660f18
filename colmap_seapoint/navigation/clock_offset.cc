#include "colmap_seapoint/navigation/clock_offset.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr double kStep = 0.5;            // seconds between the offsets that are tried first
constexpr double kFine = 0.02;           // seconds: the best one is known to
constexpr size_t kMaxTrack = 120;        // pictures that the first look takes, evenly
constexpr int kRounds = 4;               // of reweighting
constexpr double kOutlier = 3;           // times the median residual: what is farther counts less
constexpr double kMinPlaced = 0.5;       // share of the pictures
constexpr size_t kMinPictures = 6;       // a similarity of seven unknowns leaves some to tell by
constexpr double kMaxUnexplained = 0.1;  // of the track's squared extent; else nothing fits
constexpr double kExact = 1e-10;         // the same, of a log without noise

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The pictures' places in the model, and by the log at one offset.
struct Placed {
  Eigen::Matrix3Xd model, metres;
};

Placed PlaceTrack(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log,
                  double offset) {
  const auto size = static_cast<Eigen::Index>(track.size());
  Placed placed{Eigen::Matrix3Xd(3, size), Eigen::Matrix3Xd(3, size)};
  Eigen::Index count = 0;
  for (const TimedCenter& center : track) {
    const auto metres = PlaceAt(log, center.seconds + offset);
    if (!metres) continue;
    placed.model.col(count) = center.in_model;
    placed.metres.col(count++) = *metres;
  }
  placed.model.conservativeResize(3, count);
  placed.metres.conservativeResize(3, count);
  return placed;
}

struct TrackFit {
  double cost = kInfinity;  // squared residual over squared extent
  double rms_m = 0;
  size_t num_placed = 0;
};

// Umeyama's similarity with weights: squared residuals of each column, and the squared extent.
struct WeightedFit {
  Eigen::VectorXd squared;
  double extent = 0;  // metres squared, of the model's track as it was scaled
};

WeightedFit FitWeighted(const Placed& placed, const Eigen::VectorXd& weights) {
  const double sum = weights.sum();
  const Eigen::Vector3d mean_model = placed.model * weights / sum;
  const Eigen::Vector3d mean_metres = placed.metres * weights / sum;
  const Eigen::Matrix3Xd model = placed.model.colwise() - mean_model;
  const Eigen::Matrix3Xd metres = placed.metres.colwise() - mean_metres;
  const Eigen::Matrix3d covariance = metres * weights.asDiagonal() * model.transpose() / sum;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV()).determinant() < 0) signs.z() = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const double spread = model.colwise().squaredNorm().dot(weights) / sum;
  const double scale = spread > 0 ? svd.singularValues().dot(signs) / spread : 0;
  WeightedFit fit;
  fit.squared = (scale * rotation * model - metres).colwise().squaredNorm();
  fit.extent = scale * scale * spread;
  return fit;
}

TrackFit FitTrack(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log,
                  double offset) {
  const Placed placed = PlaceTrack(track, log, offset);
  const auto count = placed.model.cols();
  TrackFit result;
  result.num_placed = static_cast<size_t>(count);
  if (result.num_placed < kMinPictures ||
      static_cast<double>(count) < kMinPlaced * static_cast<double>(track.size())) {
    return result;
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  double sum = 0, extent = 0;
  for (int round = 0; round < kRounds; ++round) {
    const WeightedFit fit = FitWeighted(placed, weights);
    std::vector<double> sizes(fit.squared.data(), fit.squared.data() + count);
    const double limit = kOutlier * kOutlier * UpperMedian(sizes);
    sum = fit.squared.cwiseMin(limit).sum();
    extent = fit.extent;
    for (Eigen::Index i = 0; i < count; ++i) {
      weights[i] = fit.squared[i] > limit ? limit / fit.squared[i] : 1;
    }
  }
  const double mean_squared = sum / (static_cast<double>(count) - 8.0 / 3);
  result.rms_m = std::sqrt(mean_squared);
  if (extent > 0) result.cost = mean_squared / extent;
  return result;
}

std::vector<TimedCenter> Thinned(const std::vector<TimedCenter>& track) {
  if (track.size() <= kMaxTrack) return track;
  std::vector<TimedCenter> few;
  for (size_t i = 0; i < kMaxTrack; ++i) few.push_back(track[i * track.size() / kMaxTrack]);
  return few;
}

// Residuals that are independent of one another: pictures between the same two fixes share theirs.
double NumIndependent(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log,
                      double offset) {
  const auto [first, last] =
      std::minmax_element(track.begin(), track.end(),
                          [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  const auto num_fixes = std::count_if(log.begin(), log.end(), [&](const LogFix& fix) {
    return fix.seconds >= first->seconds + offset && fix.seconds <= last->seconds + offset;
  });
  const double count =
      std::min<double>(static_cast<double>(num_fixes), static_cast<double>(track.size()));
  return std::max(1.0, 3 * count - 8);
}

// One search: the curve of costs over the offsets, and what of it is as low as noise can tell.
class OffsetSearch {
 public:
  OffsetSearch(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log)
      : track_(track), few_(Thinned(track)), log_(log) {}

  ClockOffset Run(const std::vector<OffsetRange>& ranges) {
    for (const OffsetRange& range : ranges) Scan(range);
    const auto best = std::min_element(curve_.begin(), curve_.end(), IsLower);
    ClockOffset result;
    if (best == curve_.end() || best->cost == kInfinity) {
      result.problem = "it places fewer than half of the pictures at any offset";
      return result;
    }
    Refine(best->offset, &result);
    if (result.problem.empty()) Bound(&result);
    return result;
  }

 private:
  struct Sample {
    double offset, cost;
  };
  static bool IsLower(const Sample& a, const Sample& b) { return a.cost < b.cost; }

  void Scan(const OffsetRange& range) {
    const auto steps = static_cast<int64_t>(std::floor((range.high - range.low) / kStep));
    for (int64_t i = 0; i <= steps; ++i) {
      const double offset = range.low + static_cast<double>(i) * kStep;
      curve_.push_back({offset, FitTrack(few_, log_, offset).cost});
    }
  }

  // With all pictures, by golden section around the best of the steps.
  void Refine(double start, ClockOffset* result) const {
    constexpr double kGolden = 0.6180339887498949;
    double low = start - kStep, high = start + kStep;
    while (high - low > kFine / 4) {
      const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
      if (FitTrack(track_, log_, a).cost <= FitTrack(track_, log_, b).cost) {
        high = b;
      } else {
        low = a;
      }
    }
    result->seconds = (low + high) / 2;
    const TrackFit fit = FitTrack(track_, log_, result->seconds);
    result->rms_m = fit.rms_m;
    result->num_placed = fit.num_placed;
    if (!(fit.cost <= kMaxUnexplained)) {
      result->problem =
          "it fits the cameras' track nowhere, and leaves " +
          std::to_string(static_cast<int>(std::lround(100 * std::sqrt(std::min(fit.cost, 1.0))))) +
          " % of the track's extent unexplained";
    }
  }

  // The offsets that fit as well: of the steps, and between the last one and the next by halving.
  void Bound(ClockOffset* result) const {
    const double least = FitTrack(few_, log_, result->seconds).cost;
    const double n = NumIndependent(few_, log_, result->seconds);
    const double limit = least * (1 + 4 * std::sqrt(2 / n)) + kExact;
    result->low = result->high = result->seconds;
    for (const Sample& sample : curve_) {
      if (sample.cost > limit) continue;
      result->low = std::min(result->low, sample.offset);
      result->high = std::max(result->high, sample.offset);
    }
    result->low = Edge(result->low, -kStep, limit);
    result->high = Edge(result->high, kStep, limit);
    result->is_determined = (result->high - result->low) / 2 <= kMaxOffsetUncertainty;
  }

  double Edge(double inside, double step, double limit) const {
    double outside = inside + step;
    while (std::abs(outside - inside) > kFine / 2) {
      const double middle = (inside + outside) / 2;
      (FitTrack(few_, log_, middle).cost <= limit ? inside : outside) = middle;
    }
    return inside;
  }

  const std::vector<TimedCenter>& track_;
  const std::vector<TimedCenter> few_;
  const std::vector<LogFix>& log_;
  std::vector<Sample> curve_;
};

}  // namespace

std::vector<LogFix> SortedFixes(std::vector<LogFix> log) {
  const auto is_useless = [](const LogFix& fix) {
    return !std::isfinite(fix.seconds) || !fix.metres.allFinite();
  };
  log.erase(std::remove_if(log.begin(), log.end(), is_useless), log.end());
  std::stable_sort(log.begin(), log.end(),
                   [](const LogFix& a, const LogFix& b) { return a.seconds < b.seconds; });
  const auto end = std::unique(log.begin(), log.end(), [](const LogFix& a, const LogFix& b) {
    return a.seconds == b.seconds;
  });
  log.erase(end, log.end());
  return log;
}

std::optional<Eigen::Vector3d> PlaceAt(const std::vector<LogFix>& log, double seconds) {
  const auto after =
      std::lower_bound(log.begin(), log.end(), seconds,
                       [](const LogFix& fix, double wanted) { return fix.seconds < wanted; });
  if (after == log.end()) return std::nullopt;
  if (after->seconds == seconds) return after->metres;
  if (after == log.begin()) return std::nullopt;
  const LogFix& before = *(after - 1);
  const double gap = after->seconds - before.seconds;
  if (gap > kMaxLogGap) return std::nullopt;
  return before.metres + (seconds - before.seconds) / gap * (after->metres - before.metres);
}

ClockOffset FindClockOffset(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log,
                            const std::vector<OffsetRange>& ranges) {
  if (track.size() < kMinPictures) {
    ClockOffset few;
    few.problem = "it cannot be fitted to " + std::to_string(track.size()) +
                  " pictures with a time; " + std::to_string(kMinPictures) + " are needed";
    return few;
  }
  return OffsetSearch(track, log).Run(ranges);
}

}  // namespace colmap_seapoint
