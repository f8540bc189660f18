#include "examples/benchmarks/feature/pair_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr double kFarT = 1e3;

Eigen::Vector2d PixelOf(const SeaPoint& point) { return {point.x, point.y}; }

double Share(size_t part, size_t whole) {
  if (whole == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

SurveyOracle::SurveyOracle(const SurveyTruth& truth) : truth_(&truth), visibility_(truth) {}

size_t SurveyOracle::ImageIdx(const std::string& name) const {
  const std::vector<PosedImage>& images = truth_->model.images;
  for (size_t i = 0; i < images.size(); ++i) {
    if (images[i].name == name) return i;
  }
  throw Error(name, "is no picture of the survey", "give the survey that the pictures belong to");
}

const Camera& SurveyOracle::CameraOf(size_t image_idx) const {
  return truth_->model.cameras.at(truth_->model.images[image_idx].camera_id);
}

std::optional<SurfaceHit> SurveyOracle::SurfacePoint(size_t image_idx,
                                                     const Eigen::Vector2d& pixel) const {
  const auto in_cam = CameraOf(image_idx).CamFromImg(pixel);
  if (!in_cam) return std::nullopt;
  const Rigid3d world_from_cam = truth_->model.images[image_idx].cam_from_world.Inverse();
  const Eigen::Vector3d& origin = world_from_cam.translation;
  const auto hit =
      truth_->surface.Trace(origin, world_from_cam.rotation * in_cam->homogeneous(), 0, kFarT);
  if (!hit || (hit->xyz - origin).norm() > truth_->max_range) return std::nullopt;
  return hit;
}

std::optional<Eigen::Vector2d> SurveyOracle::Transfer(size_t from, const Eigen::Vector2d& pixel,
                                                      size_t to) const {
  const auto point = SurfacePoint(from, pixel);
  if (!point) return std::nullopt;
  return CameraOf(to).ImgFromCam(truth_->model.images[to].cam_from_world * point->xyz);
}

std::optional<Eigen::Vector2d> SurveyOracle::TransferVisible(size_t from,
                                                             const Eigen::Vector2d& pixel,
                                                             size_t to) const {
  const auto point = SurfacePoint(from, pixel);
  if (!point) return std::nullopt;
  return visibility_.Project(to, point->xyz, point->normal);
}

double MatchPrecision(const SurveyOracle& oracle, size_t image1, size_t image2,
                      const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                      const FeatureMatches& matches) {
  size_t num_right = 0;
  for (const FeatureMatch& match : matches) {
    const auto place = oracle.Transfer(image1, PixelOf(points1[match.idx1]), image2);
    if (place && (*place - PixelOf(points2[match.idx2])).norm() <= kMaxPointError) ++num_right;
  }
  return Share(num_right, matches.size());
}

double Repeatability(const SurveyOracle& oracle, size_t image1, size_t image2,
                     const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2) {
  size_t num_visible = 0, num_found = 0;
  for (const SeaPoint& point : points1) {
    const auto place = oracle.TransferVisible(image1, PixelOf(point), image2);
    if (!place) continue;
    ++num_visible;
    const bool found = std::any_of(points2.begin(), points2.end(), [&](const SeaPoint& candidate) {
      return (*place - PixelOf(candidate)).squaredNorm() <= kMaxPointError * kMaxPointError;
    });
    if (found) ++num_found;
  }
  return Share(num_found, num_visible);
}

std::vector<uint8_t> TrulyShared(const SurveyOracle& oracle, size_t image2, size_t image1,
                                 const CellGrid& grid) {
  const Camera& camera = oracle.CameraOf(image2);
  std::vector<uint8_t> shared(grid.Size(), 0);
  for (size_t cell = 0; cell < shared.size(); ++cell) {
    // The last cells of a row or column may reach beyond the picture.
    const Eigen::Vector2d center =
        grid.Center(cell).cwiseMin(Eigen::Vector2d(camera.width - 0.5, camera.height - 0.5));
    shared[cell] = oracle.TransferVisible(image2, center, image1) ? 1 : 0;
  }
  return shared;
}

OverlapScore ScoreOverlap(const InfluenceMask& mask, const std::vector<uint8_t>& shared,
                          const std::vector<uint8_t>& textured) {
  SEAPOINT_CHECK(shared.size() == mask.marked.size() && textured.size() == mask.marked.size());
  size_t num_shared = 0, num_to_find = 0, num_found = 0, num_marked = 0, num_rightly_marked = 0;
  for (size_t cell = 0; cell < shared.size(); ++cell) {
    const bool marked = mask.marked[cell] != 0, is_shared = shared[cell] != 0;
    num_shared += is_shared;
    num_marked += marked;
    num_rightly_marked += marked && is_shared;
    num_to_find += is_shared && textured[cell];
    num_found += is_shared && textured[cell] && marked;
  }
  OverlapScore score;
  score.true_overlap = Share(num_shared, shared.size());
  score.error = mask.OverlapRate() - score.true_overlap;
  score.textured = Share(num_to_find, num_shared);
  score.recall = Share(num_found, num_to_find);
  score.precision = Share(num_rightly_marked, num_marked);
  return score;
}

}  // namespace colmap_seapoint
