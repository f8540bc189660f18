#include "densify/maps/view_maps.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
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

// Where a plane through a sample meets the rays to the four corners of its patch, pair's frame.
struct PatchCorners {
  std::array<Eigen::Vector3d, 4> places;
  bool are_steep = false;  // one lies too far before or behind the sample
};

// rect_x, rect_y: of the sample, rect pixels; half: of a patch, rect pixels; max_step: in depth.
PatchCorners CornersOn(const Eigen::Vector3d& rect_normal, const Eigen::Vector3d& in_rect,
                       double rect_x, double rect_y, double half, double focal, double max_step) {
  PatchCorners corners;
  const double rect_offset = rect_normal.dot(in_rect);
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d ray((rect_x + (k % 2 == 0 ? -half : half)) / focal,
                              (rect_y + (k < 2 ? -half : half)) / focal, 1);
    const double z = rect_offset / rect_normal.dot(ray);
    corners.are_steep |= !(std::abs(z - in_rect.z()) <= max_step);
    corners.places[k] = z * ray;
  }
  return corners;
}

// A plane on which the samples around one lie on a lattice.
struct PatchFrame {
  Eigen::Matrix3d rect_from_world;
  double focal, step;  // pixels
};

// The pair's own plane; on Mercator's map the plane that touches it at a point (from the pair's
// first centre, rect frame), where one radian is as many pixels as the map is drawn with there.
PatchFrame FrameOf(const SampleFrame& frame, const Eigen::Vector3d& in_rect) {
  const PairGeometry& geometry = frame.geometry;
  const Eigen::Matrix3d rect_from_world = geometry.world_from_rect.transpose();
  if (geometry.surface == RectSurface::kPlane) {
    return {rect_from_world, geometry.focal, frame.step};
  }
  const double across = std::hypot(in_rect.y(), in_rect.z());
  const double x = geometry.focal * std::asinh(in_rect.x() / across);
  const Eigen::Vector3d z_axis = in_rect.normalized();
  const Eigen::Vector3d y_axis = z_axis.cross(Eigen::Vector3d::UnitX()).normalized();
  Eigen::Matrix3d touching_from_rect;
  touching_from_rect << y_axis.cross(z_axis).transpose(), y_axis.transpose(), z_axis.transpose();
  return {touching_from_rect * rect_from_world, geometry.focal * in_rect.norm() / across,
          frame.step * geometry.SampleSpacing(x)};
}

}  // namespace

// What all samples of a pair share in this view.
struct ViewMapRenderer::PairTerms {
  Eigen::Matrix3d rect_from_world, rect_from_cam;
  Eigen::Vector3d rect_center;  // the view's centre in the pair's frame
  Eigen::Vector3d pair_center;
  double focal, step, half;  // half: of a patch, rect pixels
};

// Columns and rows of pixels, inclusive.
struct ViewMapRenderer::PixelBox {
  int c0, c1, r0, r1;
};

// The plane normal . x = offset around a sample, camera's frame.
struct ViewMapRenderer::Patch {
  Eigen::Vector3d normal;
  double offset;
  double rect_x, rect_y;  // of the sample, rect pixels
  double tolerance;       // of depths of one surface
  Eigen::Vector3f seen;   // what the normal map says; 0 from behind
  PixelBox box;           // what it may cover
};

ViewMapRenderer::ViewMapRenderer(const Camera& camera, const Rigid3d& cam_from_world)
    : lens_{camera.FocalX(), camera.FocalY(), camera.PrincipalX(), camera.PrincipalY()},
      rotation_(cam_from_world.rotation.toRotationMatrix()),
      translation_(cam_from_world.translation),
      center_(cam_from_world.OriginInSource()),
      aside_(camera.width, camera.height) {
  SEAPOINT_CHECK(camera.model == CameraModel::kPinhole);
  const auto& [fx, fy, cx, cy] = lens_;
  const int width = camera.width, height = camera.height;
  maps_.depth = FloatImage(width, height);
  maps_.normal = FloatImage(width, height, 3);
  cam_from_pixel_ << 1 / fx, 0, -cx / fx, 0, 1 / fy, -cy / fy, 0, 0, 1;
  sides_ << fx, 0, cx, -fx, 0, width - cx, 0, fy, cy, 0, -fy, height - cy;
  sides_.rowwise().normalize();
}

bool ViewMapRenderer::MayShow(const Eigen::Vector3d& center, double radius) const {
  const Eigen::Vector3d in_cam = rotation_ * center + translation_;
  return in_cam.z() > -radius && (sides_ * in_cam).minCoeff() > -radius;
}

ViewMapRenderer::PairTerms ViewMapRenderer::TermsOf(const SampleFrame& frame,
                                                    const Eigen::Vector3d& in_rect) const {
  const PatchFrame patch_frame = FrameOf(frame, in_rect);
  PairTerms pair;
  pair.rect_from_world = patch_frame.rect_from_world;
  pair.rect_from_cam = patch_frame.rect_from_world * rotation_.transpose();
  pair.rect_center = patch_frame.rect_from_world * (center_ - frame.geometry.center1);
  pair.pair_center = frame.geometry.center1;
  pair.focal = patch_frame.focal;
  pair.step = patch_frame.step;
  pair.half = (0.5 + kOverlap) * patch_frame.step;
  return pair;
}

void ViewMapRenderer::Add(const SampleFrame& frame, const DensePoint* points, size_t count) {
  const PairGeometry& geometry = frame.geometry;
  const bool is_same_for_all = geometry.surface == RectSurface::kPlane;
  PairTerms pair = TermsOf(frame, Eigen::Vector3d::UnitZ());
  for (size_t i = 0; i < count; ++i) {
    if (!is_same_for_all) {
      pair = TermsOf(frame, geometry.world_from_rect.transpose() *
                                (points[i].xyz.cast<double>() - geometry.center1));
    }
    const std::optional<Patch> patch = MakePatch(pair, points[i]);
    if (patch) Draw(pair, *patch);
  }
}

std::optional<ViewMapRenderer::Patch> ViewMapRenderer::MakePatch(const PairTerms& pair,
                                                                 const DensePoint& point) const {
  const Eigen::Vector3d in_cam = rotation_ * point.xyz.cast<double>() + translation_;
  if (!(in_cam.z() > 0)) return std::nullopt;
  const Eigen::Vector3d in_rect =
      pair.rect_from_world * (point.xyz.cast<double>() - pair.pair_center);
  if (!(in_rect.z() > 0)) return std::nullopt;
  const double spacing = in_rect.z() * pair.step / pair.focal;
  if ((sides_ * in_cam).minCoeff() < -2 * kMaxSteepness * spacing) return std::nullopt;
  const Eigen::Vector3d normal = rotation_ * point.normal.cast<double>();
  const double offset = normal.dot(in_cam);
  if (!(std::abs(offset) > kMinCosine * in_cam.norm())) return std::nullopt;

  Patch patch;
  patch.seen.setZero();
  if (offset < 0) patch.seen = normal.cast<float>();
  patch.rect_x = pair.focal * in_rect.x() / in_rect.z();
  patch.rect_y = pair.focal * in_rect.y() / in_rect.z();
  patch.tolerance = kSameSurface * spacing;
  Eigen::Vector3d rect_normal = pair.rect_from_cam * normal;
  const auto corners_on = [&](const Eigen::Vector3d& of_plane) {
    return CornersOn(of_plane, in_rect, patch.rect_x, patch.rect_y, pair.half, pair.focal,
                     kMaxSteepness * spacing);
  };
  PatchCorners corners = corners_on(rect_normal);
  if (corners.are_steep) {
    // A plane along its own pair's rays would reach far beyond its neighbours: it is drawn flat.
    rect_normal = -in_rect.normalized();
    corners = corners_on(rect_normal);
  }
  patch.normal = pair.rect_from_cam.transpose() * rect_normal;
  patch.offset = patch.normal.dot(in_cam);
  if (!(std::abs(patch.offset) > kMinCosine * in_cam.norm())) return std::nullopt;
  const std::optional<PixelBox> box = BoxOf(corners.places, pair, in_cam.z());
  if (!box) return std::nullopt;
  patch.box = *box;
  return patch;
}

// Around a patch's corners (pair's frame), cut to the picture. nullopt: nothing of it is in view,
// or it reaches behind the camera. `depth`: of its sample.
std::optional<ViewMapRenderer::PixelBox> ViewMapRenderer::BoxOf(
    const std::array<Eigen::Vector3d, 4>& corners, const PairTerms& pair, double depth) const {
  const int width = maps_.depth.width, height = maps_.depth.height;
  double c0 = width, c1 = -1, r0 = height, r1 = -1;
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector3d p = pair.rect_from_cam.transpose() * (corner - pair.rect_center);
    if (!(p.z() > 1e-3 * depth)) return std::nullopt;
    const double c = lens_.fx * p.x() / p.z() + lens_.cx, r = lens_.fy * p.y() / p.z() + lens_.cy;
    c0 = std::min(c0, c);
    c1 = std::max(c1, c);
    r0 = std::min(r0, r);
    r1 = std::max(r1, r);
  }
  const PixelBox box = {
      static_cast<int>(std::ceil(std::clamp(c0, 0.0, static_cast<double>(width)))),
      static_cast<int>(std::floor(std::clamp(c1, -1.0, width - 1.0))),
      static_cast<int>(std::ceil(std::clamp(r0, 0.0, static_cast<double>(height)))),
      static_cast<int>(std::floor(std::clamp(r1, -1.0, height - 1.0)))};
  if (box.c0 > box.c1 || box.r0 > box.r1) return std::nullopt;
  return box;
}

// A pixel's ray d meets the plane at depth 1 / w, w = n . d / offset, in the pair's frame at
// (A d + b w) / w: both are linear in the pixel.
void ViewMapRenderer::Draw(const PairTerms& pair, const Patch& patch) {
  const Eigen::RowVector3d w_of_ray = patch.normal.transpose() / patch.offset;
  const Eigen::RowVector3d w_of = w_of_ray * cam_from_pixel_;
  const Eigen::Matrix3d rect_of =
      (pair.rect_from_cam + pair.rect_center * w_of_ray) * cam_from_pixel_;
  for (int r = patch.box.r0; r <= patch.box.r1; ++r) {
    for (int c = patch.box.c0; c <= patch.box.c1; ++c) {
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
