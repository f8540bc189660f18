#include "densify/sequence/triangulate_matches.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "densify/match/view.h"
#include "densify/sequence/covisibility.h"

namespace colmap_seapoint {

namespace {

constexpr size_t kFarthestRank = 64;
constexpr double kMaxTurnDeg = 70;  // between two pictures that are matched
constexpr double kMinParallaxDeg = 1;
constexpr double kMaxErrorPx = 2;

struct Ray {
  Eigen::Vector3d origin, direction;  // world; of length 1
};

std::optional<Ray> RayOf(const View& view, const SeaPoint& point) {
  const auto ray = view.camera.CamFromImg({point.x, point.y});
  if (!ray) return std::nullopt;
  return Ray{view.cam_from_world.OriginInSource(),
             view.cam_from_world.rotation.inverse() * ray->homogeneous().normalized()};
}

// Half-way between the two rays where they are nearest to each other; nullopt when they are
// parallel or meet behind a camera.
std::optional<Eigen::Vector3d> Meet(const Ray& ray1, const Ray& ray2) {
  const Eigen::Vector3d between = ray2.origin - ray1.origin;
  const double cosine = ray1.direction.dot(ray2.direction);
  const double square_sine = 1 - cosine * cosine;
  if (square_sine < 1e-12) return std::nullopt;
  const double along1 = between.dot(ray1.direction), along2 = between.dot(ray2.direction);
  const double range1 = (along1 - cosine * along2) / square_sine;
  const double range2 = (cosine * along1 - along2) / square_sine;
  if (range1 <= 0 || range2 <= 0) return std::nullopt;
  return 0.5 * (ray1.origin + range1 * ray1.direction + ray2.origin + range2 * ray2.direction);
}

bool Shows(const View& view, const Eigen::Vector3d& place, const SeaPoint& point) {
  const auto pixel = view.camera.ImgFromCam(view.cam_from_world * place);
  return pixel && (*pixel - Eigen::Vector2d(point.x, point.y)).norm() <= kMaxErrorPx;
}

std::optional<Eigen::Vector3d> Triangulate(const View& view1, const SeaPoint& point1,
                                           const View& view2, const SeaPoint& point2) {
  const auto ray1 = RayOf(view1, point1), ray2 = RayOf(view2, point2);
  if (!ray1 || !ray2) return std::nullopt;
  const auto place = Meet(*ray1, *ray2);
  if (!place || ParallaxDeg(*place, ray1->origin, ray2->origin) < kMinParallaxDeg ||
      !Shows(view1, *place, point1) || !Shows(view2, *place, point2)) {
    return std::nullopt;
  }
  return place;
}

// Pairs of image_idx, the smaller one first.
std::set<std::pair<int, int>> NearPairs(const SparseModel& model) {
  const double min_cosine = std::cos(kMaxTurnDeg * M_PI / 180);
  std::vector<Ray> axes;
  for (const PosedImage& image : model.images) {
    axes.push_back({image.cam_from_world.OriginInSource(),
                    image.cam_from_world.rotation.inverse() * Eigen::Vector3d::UnitZ()});
  }
  std::set<std::pair<int, int>> pairs;
  std::vector<std::pair<double, int>> others;  // (distance, image_idx)
  for (size_t i = 0; i < axes.size(); ++i) {
    others.clear();
    for (size_t k = 0; k < axes.size(); ++k) {
      if (k == i || axes[i].direction.dot(axes[k].direction) < min_cosine) continue;
      others.emplace_back((axes[i].origin - axes[k].origin).norm(), static_cast<int>(k));
    }
    const auto end = others.begin() + static_cast<long>(std::min(others.size(), kFarthestRank));
    std::partial_sort(others.begin(), end, others.end());
    for (size_t rank = 1; rank <= std::min(others.size(), kFarthestRank); rank *= 2) {
      pairs.insert(std::minmax(static_cast<int>(i), others[rank - 1].second));
    }
  }
  return pairs;
}

View ViewOf(const SparseModel& model, int image_idx) {
  const PosedImage& image = model.images[static_cast<size_t>(image_idx)];
  return {image_idx, model.cameras.at(image.camera_id), image.cam_from_world};
}

SparsePoint::TrackElement Observe(const SeaPoint& point, uint64_t id, PosedImage* image) {
  image->points2D.resize(image->point3D_ids.size(), Eigen::Vector2d::Zero());
  image->points2D.emplace_back(point.x, point.y);
  image->point3D_ids.push_back(id);
  return {image->image_id, static_cast<uint32_t>(image->point3D_ids.size() - 1)};
}

}  // namespace

bool HasSharedPoints(const SparseModel& model) {
  return std::any_of(model.points3D.begin(), model.points3D.end(), [](const auto& entry) {
    const auto& track = entry.second.track;
    return std::any_of(track.begin(), track.end(), [&](const auto& element) {
      return element.image_id != track.front().image_id;
    });
  });
}

SparseModel WithTriangulatedMatches(SparseModel model, PictureCache* pictures) {
  uint64_t id = model.points3D.empty() ? 0 : model.points3D.rbegin()->first;
  for (const auto& [idx1, idx2] : NearPairs(model)) {
    const View view1 = ViewOf(model, idx1), view2 = ViewOf(model, idx2);
    const auto features1 = pictures->GetSeaPoints(idx1), features2 = pictures->GetSeaPoints(idx2);
    for (const FeatureMatch& match : *pictures->GetMatches(idx1, idx2)) {
      const SeaPoint &point1 = features1->points[match.idx1],
                     &point2 = features2->points[match.idx2];
      const auto place = Triangulate(view1, point1, view2, point2);
      if (!place) continue;
      SparsePoint& point = model.points3D[++id];
      point.xyz = *place;
      point.track = {Observe(point1, id, &model.images[static_cast<size_t>(idx1)]),
                     Observe(point2, id, &model.images[static_cast<size_t>(idx2)])};
    }
  }
  return model;
}

}  // namespace colmap_seapoint
