#include "colmap_seapoint/navigation/clock_offset.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

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
constexpr double kClearlyFewer = 0.95;   // of the pictures placed
constexpr size_t kMaxMinima = 60;        // that are followed down
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
  const double begin = first->seconds + offset, end = last->seconds + offset;
  const auto num_fixes = std::count_if(log.begin(), log.end(), [&](const LogFix& fix) {
    return fix.seconds >= begin && fix.seconds <= end;
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
    std::vector<Minimum> minima = FindMinima();
    ClockOffset result;
    if (minima.empty()) {
      result.problem = "it places fewer than half of the pictures at any offset";
      return result;
    }
    const double limit = Limit(minima.front());
    KeepAsGood(limit, &minima);
    Choose(minima.front(), &result);
    if (result.problem.empty()) Bound(minima, limit, &result);
    return result;
  }

 private:
  struct Sample {
    double offset, cost;
  };
  struct Minimum {
    size_t sample;  // of the curve
    double offset;
    TrackFit fit;  // of the few
  };

  void Scan(const OffsetRange& range) {
    const auto steps = static_cast<int64_t>(std::floor((range.high - range.low) / kStep));
    for (int64_t i = 0; i <= steps; ++i) {
      const double offset = range.low + static_cast<double>(i) * kStep;
      curve_.push_back({offset, FitTrack(few_, log_, offset).cost});
    }
  }

  // Whether the two are next to each other in one range.
  bool AreNeighbors(size_t a, size_t b) const {
    return b < curve_.size() && a < curve_.size() &&
           std::abs(curve_[a].offset - curve_[b].offset) < 1.5 * kStep;
  }

  // The deepest of the curve's minima, each followed down between its steps; the least first.
  std::vector<Minimum> FindMinima() const {
    std::vector<size_t> steps;
    for (size_t i = 0; i < curve_.size(); ++i) {
      const bool above_left = AreNeighbors(i, i - 1) && curve_[i].cost > curve_[i - 1].cost;
      const bool above_right = AreNeighbors(i, i + 1) && curve_[i].cost > curve_[i + 1].cost;
      if (curve_[i].cost < kInfinity && !above_left && !above_right) steps.push_back(i);
    }
    std::sort(steps.begin(), steps.end(), [&](size_t a, size_t b) {
      return std::pair(curve_[a].cost, a) < std::pair(curve_[b].cost, b);
    });
    if (steps.size() > kMaxMinima) steps.resize(kMaxMinima);
    std::vector<Minimum> minima;
    for (const size_t i : steps) {
      const double offset = FollowDown(few_, curve_[i].offset);
      minima.push_back({i, offset, FitTrack(few_, log_, offset)});
    }
    std::stable_sort(minima.begin(), minima.end(),
                     [](const Minimum& a, const Minimum& b) { return a.fit.cost < b.fit.cost; });
    return minima;
  }

  // By golden section.
  double FollowDown(const std::vector<TimedCenter>& track, double start) const {
    constexpr double kGolden = 0.6180339887498949;
    double low = start - kStep, high = start + kStep;
    while (high - low > kFine / 4) {
      const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
      if (FitTrack(track, log_, a).cost <= FitTrack(track, log_, b).cost) {
        high = b;
      } else {
        low = a;
      }
    }
    return (low + high) / 2;
  }

  // What chance alone may make of the least cost.
  double Limit(const Minimum& least) const {
    const double n = NumIndependent(few_, log_, least.offset);
    return least.fit.cost * (1 + 4 * std::sqrt(2 / n)) + kExact;
  }

  // The minima within the limit, without those that place clearly fewer pictures.
  static void KeepAsGood(double limit, std::vector<Minimum>* minima) {
    size_t most = 0;
    for (const Minimum& minimum : *minima) {
      if (minimum.fit.cost <= limit) most = std::max(most, minimum.fit.num_placed);
    }
    const auto is_worse = [&](const Minimum& minimum) {
      return minimum.fit.cost > limit || static_cast<double>(minimum.fit.num_placed) <
                                             kClearlyFewer * static_cast<double>(most);
    };
    minima->erase(std::remove_if(minima->begin(), minima->end(), is_worse), minima->end());
  }

  // With all pictures.
  void Choose(const Minimum& best, ClockOffset* result) const {
    result->seconds = FollowDown(track_, best.offset);
    const TrackFit fit = FitTrack(track_, log_, result->seconds);
    result->rms_m = fit.rms_m;
    result->num_placed = fit.num_placed;
    if (fit.cost <= kMaxUnexplained) return;
    const double unexplained = 100 * std::sqrt(std::min(fit.cost, 1.0));
    result->problem = "it fits the cameras' track nowhere, and leaves " +
                      std::to_string(std::lround(unexplained)) +
                      " % of the track's extent unexplained";
  }

  // The stretches around the minima that fit as well.
  void Bound(const std::vector<Minimum>& minima, double limit, ClockOffset* result) const {
    result->low = result->high = result->seconds;
    double covered_low = kInfinity, covered_high = -kInfinity;  // the last stretch
    for (const Minimum& minimum : minima) {
      const bool is_new = minimum.offset < covered_low || minimum.offset > covered_high;
      if (is_new) result->alternatives.push_back(minimum.offset);
      const double low = Edge(minimum, -1, limit), high = Edge(minimum, 1, limit);
      result->low = std::min(result->low, low);
      result->high = std::max(result->high, high);
      if (is_new) {
        covered_low = low;
        covered_high = high;
      }
    }
    result->is_determined = (result->high - result->low) / 2 <= kMaxOffsetUncertainty;
  }

  // Along the steps as long as they fit, then by halving.
  double Edge(const Minimum& minimum, int direction, double limit) const {
    size_t at = minimum.sample;
    double inside = minimum.offset;
    while (true) {
      const size_t next = direction > 0 ? at + 1 : at - 1;
      if (!AreNeighbors(at, next) || curve_[next].cost > limit) break;
      at = next;
      inside = curve_[at].offset;
    }
    double outside = inside + direction * kStep;
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
