// Which pictures truly see a place of the surface.
#pragma once

#include <optional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/scene/height_field.h"

namespace colmap_seapoint {

class SurfaceVisibility {
 public:
  // Keeps references: both must outlive it.
  SurfaceVisibility(const SparseModel& model, const HeightField& surface);

  // The pixel of a surface point in picture `image_idx`; nullopt when it lies outside the picture,
  // is hidden by relief, or is seen more than 80 degrees from its normal. Any number of threads.
  std::optional<Eigen::Vector2d> Project(size_t image_idx, const Eigen::Vector3d& point,
                                         const Eigen::Vector3d& normal) const;

  // The number of pictures in which the place is seen, counted up to `limit`.
  int CountViews(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int limit) const;

 private:
  struct View {
    Rigid3d cam_from_world;
    Eigen::Vector3d centre;
    const Camera* camera;
    double max_tangent;  // of the angle from the axis; beyond it the lens model means nothing
  };
  const HeightField* surface_;
  std::vector<View> views_;
};

}  // namespace colmap_seapoint
