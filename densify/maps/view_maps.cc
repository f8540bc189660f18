#include "densify/maps/view_maps.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

namespace {

// Patches reach this far beyond half the way to the next sample, in steps: from aside, steps in
// depth between neighbours would show as cracks.
constexpr double kOverlap = 0.25;
constexpr double kMaxSteepness = 4;  // change of depth over a patch, in samples' distances
constexpr double kSameSurface = 4;   // difference in depth, in samples' distances
constexpr double kMinCosine = 0.03;  // of a patch that is not seen edge-on

}  // namespace

SampleFrame SampleFrameOf(const PairGeometry& geometry, int step) {
  return {geometry.world_from_rect.transpose(), geometry.center1, geometry.focal,
          static_cast<double>(step)};
}

// Of a pair and this view.
struct ViewMapRenderer::PairTerms {
  Eigen::Matrix3d rect_from_world, rect_from_cam;
  Eigen::Vector3d rect_center;  // the view's centre in the pair's frame
  Eigen::Vector3d pair_center;
  double focal, step, half;  // half: of a patch, rect pixels
};

// The plane normal . x = offset around a sample, camera's frame.
struct ViewMapRenderer::Patch {
  Eigen::Vector3d normal;
  double offset;
  double rect_x, rect_y;  // of the sample, rect pixels
  double tolerance;       // of depths of one surface
  Eigen::Vector3f seen;   // what the normal map says; 0 from behind
  int c0, c1, r0, r1;     // columns and rows that it may cover, inclusive
};

ViewMapRenderer::ViewMapRenderer(const Camera& camera, const Rigid3d& cam_from_world)
    : width_(camera.width),
      height_(camera.height),
      fx_(camera.FocalX()),
      fy_(camera.FocalY()),
      cx_(camera.PrincipalX()),
      cy_(camera.PrincipalY()),
      rotation_(cam_from_world.rotation.toRotationMatrix()),
      translation_(cam_from_world.translation),
      center_(cam_from_world.OriginInSource()),
      aside_(camera.width, camera.height) {
  SEAPOINT_CHECK(camera.model == CameraModel::kPinhole);
  maps_.depth = FloatImage(width_, height_);
  maps_.normal = FloatImage(width_, height_, 3);
  cam_from_pixel_ << 1 / fx_, 0, -cx_ / fx_, 0, 1 / fy_, -cy_ / fy_, 0, 0, 1;
  sides_ << fx_, 0, cx_, -fx_, 0, width_ - cx_, 0, fy_, cy_, 0, -fy_, height_ - cy_;
  sides_.rowwise().normalize();
}

bool ViewMapRenderer::MayShow(const Eigen::Vector3d& center, double radius) const {
  const Eigen::Vector3d in_cam = rotation_ * center + translation_;
  return in_cam.z() > -radius && (sides_ * in_cam).minCoeff() > -radius;
}

void ViewMapRenderer::Add(const SampleFrame& frame, const DensePoint* points, size_t count) {
  PairTerms pair;
  pair.rect_from_world = frame.rect_from_world;
  pair.rect_from_cam = frame.rect_from_world * rotation_.transpose();
  pair.rect_center = frame.rect_from_world * (center_ - frame.center);
  pair.pair_center = frame.center;
  pair.focal = frame.focal;
  pair.step = frame.step;
  pair.half = (0.5 + kOverlap) * frame.step;
  Patch patch;
  for (size_t i = 0; i < count; ++i) {
    if (MakePatch(pair, points[i], &patch)) Draw(pair, patch);
  }
}

// False when nothing of it can be seen.
bool ViewMapRenderer::MakePatch(const PairTerms& pair, const DensePoint& point,
                                Patch* patch) const {
  const Eigen::Vector3d in_cam = rotation_ * point.xyz.cast<double>() + translation_;
  if (!(in_cam.z() > 0)) return false;
  const Eigen::Vector3d in_rect =
      pair.rect_from_world * (point.xyz.cast<double>() - pair.pair_center);
  if (!(in_rect.z() > 0)) return false;
  const double spacing = in_rect.z() * pair.step / pair.focal;
  if ((sides_ * in_cam).minCoeff() < -2 * kMaxSteepness * spacing) return false;

  const Eigen::Vector3d normal = rotation_ * point.normal.cast<double>();
  const double offset = normal.dot(in_cam);
  if (!(std::abs(offset) > kMinCosine * in_cam.norm())) return false;
  patch->seen.setZero();
  if (offset < 0) patch->seen = normal.cast<float>();
  patch->rect_x = pair.focal * in_rect.x() / in_rect.z();
  patch->rect_y = pair.focal * in_rect.y() / in_rect.z();
  patch->tolerance = kSameSurface * spacing;

  Eigen::Vector3d rect_normal = pair.rect_from_cam * normal;
  Eigen::Vector3d corners[4];
  for (const bool is_flat : {false, true}) {
    // A plane along its own pair's rays would reach far beyond its neighbours.
    if (is_flat) rect_normal = -in_rect.normalized();
    const double rect_offset = rect_normal.dot(in_rect);
    bool is_steep = false;
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d ray(
          (patch->rect_x + (k % 2 == 0 ? -pair.half : pair.half)) / pair.focal,
          (patch->rect_y + (k < 2 ? -pair.half : pair.half)) / pair.focal, 1);
      const double z = rect_offset / rect_normal.dot(ray);
      is_steep |= !(std::abs(z - in_rect.z()) <= kMaxSteepness * spacing);
      corners[k] = z * ray;
    }
    if (!is_steep) break;
  }
  patch->normal = pair.rect_from_cam.transpose() * rect_normal;
  patch->offset = patch->normal.dot(in_cam);
  if (!(std::abs(patch->offset) > kMinCosine * in_cam.norm())) return false;

  double c0 = width_, c1 = -1, r0 = height_, r1 = -1;
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector3d p = pair.rect_from_cam.transpose() * (corner - pair.rect_center);
    if (!(p.z() > 1e-3 * in_cam.z())) return false;
    const double c = fx_ * p.x() / p.z() + cx_, r = fy_ * p.y() / p.z() + cy_;
    c0 = std::min(c0, c);
    c1 = std::max(c1, c);
    r0 = std::min(r0, r);
    r1 = std::max(r1, r);
  }
  patch->c0 = static_cast<int>(std::ceil(std::clamp(c0, 0.0, static_cast<double>(width_))));
  patch->c1 = static_cast<int>(std::floor(std::clamp(c1, -1.0, width_ - 1.0)));
  patch->r0 = static_cast<int>(std::ceil(std::clamp(r0, 0.0, static_cast<double>(height_))));
  patch->r1 = static_cast<int>(std::floor(std::clamp(r1, -1.0, height_ - 1.0)));
  return patch->c0 <= patch->c1 && patch->r0 <= patch->r1;
}

// A pixel's ray d meets the plane at depth 1 / w, w = n . d / offset, in the pair's frame at
// (A d + b w) / w: both are linear in the pixel.
void ViewMapRenderer::Draw(const PairTerms& pair, const Patch& patch) {
  const Eigen::RowVector3d w_of_ray = patch.normal.transpose() / patch.offset;
  const Eigen::RowVector3d w_of = w_of_ray * cam_from_pixel_;
  const Eigen::Matrix3d rect_of =
      (pair.rect_from_cam + pair.rect_center * w_of_ray) * cam_from_pixel_;
  for (int r = patch.r0; r <= patch.r1; ++r) {
    for (int c = patch.c0; c <= patch.c1; ++c) {
      const Eigen::Vector3d place(c, r, 1);
      const double w = w_of * place;
      const Eigen::Vector3d q = rect_of * place;
      if (!(w > 0) || !(q.z() > 0)) continue;
      const double to_pixels = pair.focal / q.z();
      const double aside = std::max(std::abs(to_pixels * q.x() - patch.rect_x),
                                    std::abs(to_pixels * q.y() - patch.rect_y));
      if (!(aside <= pair.half)) continue;
      const auto depth = static_cast<float>(1 / w);
      const auto far = static_cast<uint8_t>(255 * aside / pair.half);
      float& known = maps_.depth.At(c, r);
      const bool is_first = known == 0 || depth < known - patch.tolerance;
      const bool is_nearer = far < aside_.At(c, r) && depth < known + patch.tolerance;
      if (!is_first && !is_nearer) continue;
      known = depth;
      aside_.At(c, r) = far;
      for (int k = 0; k < 3; ++k) maps_.normal.At(c, r, k) = patch.seen[k];
    }
  }
}

ViewMaps ViewMapRenderer::Finish() {
  for (size_t i = 0; i < maps_.depth.data.size(); ++i) {
    const float* n = &maps_.normal.data[3 * i];
    if (n[0] == 0 && n[1] == 0 && n[2] == 0) maps_.depth.data[i] = 0;
  }
  return std::move(maps_);
}

}  // namespace colmap_seapoint
