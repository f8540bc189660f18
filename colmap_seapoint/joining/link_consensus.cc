#include "colmap_seapoint/joining/link_consensus.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

namespace colmap_seapoint {
namespace {

constexpr int kNumSamples = 500;
constexpr int kNumRefits = 5;
constexpr double kMaxErrorShare = 0.004;  // of the picture's longer side
constexpr double kMinMaxError = 4;        // pixels
// Of the spread across the line of the points to that along it: else the turn about it is unsure.
constexpr double kMinBreadth = 0.05;

using Indices = std::vector<size_t>;

bool IsNear(const SparseModel& model, uint32_t image_idx, const Eigen::Vector3d& xyz,
            const Eigen::Vector2d& pixel) {
  const PosedImage& image = model.images[image_idx];
  const Camera& camera = model.cameras.at(image.camera_id);
  const auto shown = camera.ImgFromCam(image.cam_from_world * xyz);
  return shown && (*shown - pixel).norm() <= MaxLinkError(camera);
}

struct Problem {
  const SparseModel& a;
  const SparseModel& b;
  const std::vector<ModelLink>& links;

  const Eigen::Vector3d& InA(size_t i) const { return a.points3D.at(links[i].point_a).xyz; }
  const Eigen::Vector3d& InB(size_t i) const { return b.points3D.at(links[i].point_b).xyz; }
};

std::optional<Similarity3d> Fit(const Problem& problem, const Indices& chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Eigen::Matrix3Xd from(3, count), to(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    from.col(i) = problem.InA(chosen[static_cast<size_t>(i)]);
    to.col(i) = problem.InB(chosen[static_cast<size_t>(i)]);
  }
  const Eigen::Matrix4d transform = Eigen::umeyama(from, to, true);
  const double scale = std::cbrt(transform.topLeftCorner<3, 3>().determinant());
  if (!transform.allFinite() || !(scale > 0)) return std::nullopt;
  Similarity3d fit;
  fit.scale = scale;
  fit.rotation = Eigen::Quaterniond(Eigen::Matrix3d(transform.topLeftCorner<3, 3>() / scale));
  fit.rotation.normalize();
  fit.translation = transform.topRightCorner<3, 1>();
  return fit;
}

Indices Agreeing(const Problem& problem, const Indices& candidates, const Similarity3d& b_from_a) {
  const Similarity3d a_from_b = b_from_a.Inverse();
  Indices agreeing;
  for (const size_t i : candidates) {
    const ModelLink& link = problem.links[i];
    if (IsNear(problem.b, link.image_idx_b, b_from_a * problem.InA(i), link.pixel_b) &&
        IsNear(problem.a, link.image_idx_a, a_from_b * problem.InB(i), link.pixel_a)) {
      agreeing.push_back(i);
    }
  }
  return agreeing;
}

bool IsBroad(const Problem& problem, const Indices& chosen) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const size_t i : chosen) mean += problem.InB(i) / static_cast<double>(chosen.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const size_t i : chosen) {
    scatter += (problem.InB(i) - mean) * (problem.InB(i) - mean).transpose();
  }
  const Eigen::Vector3d spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues().cwiseMax(0).cwiseSqrt();
  return spread(1) > kMinBreadth * spread(2);
}

struct Agreement {
  Similarity3d b_from_a;
  Indices inliers;
};

// Of more than two points, refitted as long as more agree.
Agreement Refitted(const Problem& problem, const Indices& candidates, Agreement best) {
  for (int i = 0; i < kNumRefits && best.inliers.size() > 2; ++i) {
    const auto fit = Fit(problem, best.inliers);
    if (!fit) break;
    Indices agreeing = Agreeing(problem, candidates, *fit);
    if (agreeing.size() < best.inliers.size()) break;
    best = {*fit, std::move(agreeing)};
  }
  return best;
}

Agreement Search(const Problem& problem, const Indices& candidates) {
  Agreement best;
  if (candidates.size() < 3) return best;
  std::mt19937 random(1);
  for (int k = 0; k < kNumSamples; ++k) {
    Indices sample;
    for (int i = 0; i < 3; ++i) sample.push_back(candidates[random() % candidates.size()]);
    if (!IsBroad(problem, sample)) continue;
    const auto fit = Fit(problem, sample);
    if (!fit) continue;
    Indices agreeing = Agreeing(problem, candidates, *fit);
    if (agreeing.size() > best.inliers.size()) best = {*fit, std::move(agreeing)};
  }
  return Refitted(problem, candidates, std::move(best));
}

}  // namespace

double MaxLinkError(const Camera& camera) {
  return std::max(kMinMaxError,
                  kMaxErrorShare * static_cast<double>(std::max(camera.width, camera.height)));
}

std::optional<LinkConsensus> FindLinkConsensus(const SparseModel& a, const SparseModel& b,
                                               const std::vector<ModelLink>& links) {
  const Problem problem = {a, b, links};
  Indices all(links.size());
  std::iota(all.begin(), all.end(), size_t{0});
  Agreement best = Search(problem, all);
  if (best.inliers.size() < 3 || !IsBroad(problem, best.inliers)) return std::nullopt;
  Indices others;
  std::set_difference(all.begin(), all.end(), best.inliers.begin(), best.inliers.end(),
                      std::back_inserter(others));
  const size_t num_rivals = Search(problem, others).inliers.size();
  return LinkConsensus{best.b_from_a, std::move(best.inliers), num_rivals};
}

}  // namespace colmap_seapoint
