// The whole exact surface of a survey: a height field, in its own frame or turned upright (a wall),
// and perhaps an object that stands on it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/rigid3.h"
#include "examples/survey/scene/height_field.h"
#include "examples/survey/scene/sheet.h"

namespace colmap_seapoint {

enum class SurfacePart { kGround, kObject };

struct SurfaceHit {
  double t = 0;            // on the ray
  Eigen::Vector3d xyz;     // world
  Eigen::Vector3d normal;  // unit, out of the solid, smooth
  SurfacePart part = SurfacePart::kGround;
  Eigen::Vector2d texture;  // place on the part's map of colours, metres
};

class Surface {
 public:
  Surface() = default;
  Surface(HeightField ground) : ground_(std::move(ground)) {}  // NOLINT: a height field is one
  // `object`: in the world; may be empty.
  Surface(HeightField ground, const Rigid3d& world_from_ground, Sheet object);

  const HeightField& Ground() const { return ground_; }
  const Rigid3d& WorldFromGround() const { return world_from_ground_; }
  const Sheet& Object() const { return object_; }
  // Metres between the nodes.
  double CellSize() const { return ground_.Grid().step; }

  // The first t in [t_min, t_max] where origin + t * direction meets the surface. Exact.
  std::optional<double> IntersectRay(const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction, double t_min,
                                     double t_max) const;
  // The same with all that is known about the place.
  std::optional<SurfaceHit> Trace(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double t_min, double t_max) const;

  // Distance to the nearest point of the surface; exact below `limit` (metres), else `limit`.
  double Distance(const Eigen::Vector3d& point, double limit) const;

  // A place of the world in the ground's frame, and the place above or below (x, y) of that frame.
  Eigen::Vector3d InGround(const Eigen::Vector3d& point) const;
  SurfaceHit GroundAt(double x, double y) const;  // t is 0

 private:
  HeightField ground_;
  Rigid3d world_from_ground_;
  bool is_turned_ = false;  // else nothing is transformed: not a bit changes
  Sheet object_;
};

}  // namespace colmap_seapoint
