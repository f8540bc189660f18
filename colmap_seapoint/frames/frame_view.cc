#include "colmap_seapoint/frames/frame_view.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "colmap_seapoint/base/median.h"
#include "feature/extract_features.h"
#include "feature/match_features.h"
#include "feature/matching/overlap_share.h"

namespace colmap_seapoint {
namespace {

constexpr int kMinNumPoints = 500, kMaxNumPoints = 700;
// Fewer agree by chance.
constexpr size_t kMinNumMatches = 20;
// A displacement by parallax counts as one of this many times as far: views of one place from two
// sides match worse than views of two places from one side.
constexpr double kParallaxWeight = 4;
constexpr int kNumFits = 3;

using Points = Eigen::Matrix2Xd;

struct Similarity {
  Eigen::Matrix2d turn;  // and scale
  Eigen::Vector2d shift;

  Eigen::Vector2d operator()(const Eigen::Vector2d& place) const { return turn * place + shift; }
};

// Least squares; in the plane, a turn with a scale has a closed form.
Similarity Fit(const Points& from, const Points& to) {
  const Eigen::Vector2d middle_from = from.rowwise().mean(), middle_to = to.rowwise().mean();
  double dot = 0, cross = 0, norm = 0;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    const Eigen::Vector2d p = from.col(i) - middle_from, q = to.col(i) - middle_to;
    dot += p.dot(q);
    cross += p.x() * q.y() - p.y() * q.x();
    norm += p.squaredNorm();
  }
  Similarity motion;
  motion.turn << dot, -cross, cross, dot;
  motion.turn /= std::max(norm, 1e-12);
  motion.shift = middle_to - motion.turn * middle_from;
  return motion;
}

std::vector<double> Residuals(const Similarity& motion, const Points& from, const Points& to) {
  std::vector<double> residuals;
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    residuals.push_back((motion(from.col(i)) - to.col(i)).norm());
  }
  return residuals;
}

// To most of the matches: those that lie far off have no say in the next fit.
Similarity FitRobustly(const Points& from, const Points& to) {
  Similarity motion = Fit(from, to);
  for (int fit = 1; fit < kNumFits; ++fit) {
    const std::vector<double> residuals = Residuals(motion, from, to);
    const double limit = 3 * Quantile(residuals, 0.5);
    std::vector<Eigen::Index> near;
    for (Eigen::Index i = 0; i < from.cols(); ++i) {
      if (residuals[static_cast<size_t>(i)] <= limit) near.push_back(i);
    }
    motion = Fit(from(Eigen::all, near), to(Eigen::all, near));
  }
  return motion;
}

using Polygon = std::vector<Eigen::Vector2d>;

// The part of the polygon where axis `axis` times `sign` is at most `limit`.
Polygon Clip(const Polygon& polygon, int axis, double sign, double limit) {
  Polygon kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double beyond_a = sign * a[axis] - limit, beyond_b = sign * b[axis] - limit;
    if (beyond_a <= 0) kept.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      kept.push_back(a + (b - a) * (beyond_a / (beyond_a - beyond_b)));
    }
  }
  return kept;
}

double Area(const Polygon& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

// Of the larger of both frames, so that coming nearer counts as going away does.
double SharedArea(const Similarity& motion, const FrameView& first, const FrameView& second) {
  Polygon frame;
  const double w = first.width, h = first.height;
  for (const auto& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(w, 0), Eigen::Vector2d(w, h),
                             Eigen::Vector2d(0, h)}) {
    frame.push_back(motion(corner));
  }
  const double larger = std::max(Area(frame), double(second.width) * second.height);
  for (const int axis : {0, 1}) {
    frame = Clip(frame, axis, -1, 0);
    frame = Clip(frame, axis, 1, axis == 0 ? second.width : second.height);
  }
  return Area(frame) / larger;
}

}  // namespace

double Sharpness(const GrayImage& gray) {
  constexpr int kStep = 2;
  if (gray.width <= kStep || gray.height <= kStep) return 0;
  uint64_t sum = 0;
  for (int y = 0; y + kStep < gray.height; ++y) {
    const uint8_t* row = gray.Row(y);
    const uint8_t* below = gray.Row(y + kStep);
    uint32_t row_sum = 0;  // 2 x 255^2 x 16384 pixels fit
    for (int x = 0; x + kStep < gray.width; ++x) {
      const int across = row[x + kStep] - row[x], down = below[x] - row[x];
      row_sum += static_cast<uint32_t>(across * across + down * down);
    }
    sum += row_sum;
  }
  return static_cast<double>(sum) / (double(gray.width - kStep) * (gray.height - kStep));
}

FrameView ViewOf(const GrayImage& gray) {
  SeaPointExtractionOptions options;
  options.min_num_features = kMinNumPoints;
  options.max_num_features = kMaxNumPoints;
  return {gray.width, gray.height, ExtractFeatures(gray, {}, options).features, Sharpness(gray)};
}

double OverlapOf(const FrameView& first, const FrameView& second) {
  const auto& points1 = first.features.points;
  const auto& points2 = second.features.points;
  if (points1.size() < kMinNumMatches || points2.size() < kMinNumMatches) return 0;
  const FeatureMatches matches = MatchSeaPoints(first.features, second.features, {});
  if (matches.size() < kMinNumMatches) return 0;
  if (OverlapShare(points1, points2, matches) < kMinOverlapShare) return 0;
  Points from(2, matches.size()), to(2, matches.size());
  for (size_t i = 0; i < matches.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    from.col(column) << points1[matches[i].idx1].x, points1[matches[i].idx1].y;
    to.col(column) << points2[matches[i].idx2].x, points2[matches[i].idx2].y;
  }
  const Similarity motion = FitRobustly(from, to);
  const double parallax = Quantile(Residuals(motion, from, to), 0.75) / second.width;
  const double overlap = SharedArea(motion, first, second) - kParallaxWeight * parallax;
  return std::clamp(overlap, 0.0, 1.0);
}

}  // namespace colmap_seapoint
