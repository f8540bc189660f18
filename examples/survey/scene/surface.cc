#include "examples/survey/scene/surface.h"

#include <algorithm>
#include <utility>

namespace colmap_seapoint {

Surface::Surface(HeightField ground, const Rigid3d& world_from_ground, Sheet object)
    : ground_(std::move(ground)),
      world_from_ground_(world_from_ground),
      is_turned_(world_from_ground.rotation.vec() != Eigen::Vector3d::Zero() ||
                 world_from_ground.translation != Eigen::Vector3d::Zero()),
      object_(std::move(object)) {}

Eigen::Vector3d Surface::InGround(const Eigen::Vector3d& point) const {
  return is_turned_ ? world_from_ground_.Inverse() * point : point;
}

SurfaceHit Surface::GroundAt(double x, double y) const {
  SurfaceHit hit;
  hit.xyz = {x, y, ground_.Height(x, y)};
  hit.normal = ground_.Normal(x, y);
  hit.texture = {x, y};
  if (is_turned_) {
    hit.xyz = world_from_ground_ * hit.xyz;
    hit.normal = world_from_ground_.rotation * hit.normal;
  }
  return hit;
}

std::optional<double> Surface::IntersectRay(const Eigen::Vector3d& origin,
                                            const Eigen::Vector3d& direction, double t_min,
                                            double t_max) const {
  const Eigen::Vector3d in_ground =
      is_turned_ ? world_from_ground_.rotation.conjugate() * direction : direction;
  const auto t = ground_.IntersectRay(InGround(origin), in_ground, t_min, t_max);
  if (object_.Empty()) return t;
  const auto hit = object_.IntersectRay(origin, direction, t_min, t.value_or(t_max));
  return hit ? std::optional<double>(hit->t) : t;
}

std::optional<SurfaceHit> Surface::Trace(const Eigen::Vector3d& origin,
                                         const Eigen::Vector3d& direction, double t_min,
                                         double t_max) const {
  const Eigen::Vector3d in_ground =
      is_turned_ ? world_from_ground_.rotation.conjugate() * direction : direction;
  const auto t = ground_.IntersectRay(InGround(origin), in_ground, t_min, t_max);
  const auto object = object_.IntersectRay(origin, direction, t_min, t.value_or(t_max));
  if (object) {
    return SurfaceHit{object->t, origin + object->t * direction, object_.Normal(object->lattice),
                      SurfacePart::kObject, object_.Step() * object->lattice};
  }
  if (!t) return std::nullopt;
  const Eigen::Vector3d place = InGround(origin + *t * direction);
  SurfaceHit hit = GroundAt(place.x(), place.y());
  hit.t = *t;
  hit.xyz = origin + *t * direction;
  return hit;
}

double Surface::Distance(const Eigen::Vector3d& point, double limit) const {
  // The object first: far from the ground, a search of that costs much more.
  return ground_.Distance(InGround(point), object_.Distance(point, limit));
}

}  // namespace colmap_seapoint
