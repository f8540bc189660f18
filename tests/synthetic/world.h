// An exact world of textured rectangles and exact pictures of it, through any camera model. What a
// test wants to know of it (surface, visibility, colour) has a closed form.
//
// Frame: x right, y down, z away from cameras that are not turned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/base/rigid3.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {

// center + a half_u + b half_v, -1 <= a, b <= 1; half_u and half_v stand at right angles.
struct Rectangle {
  Eigen::Vector3d center, half_u, half_v;
};

class World {
 public:
  World(std::vector<Rectangle> rectangles, const NoiseTexture& texture)
      : rectangles_(std::move(rectangles)), texture_(texture) {}

  // The nearest surface point that origin + t direction, t > 0, meets.
  std::optional<Eigen::Vector3d> Cast(const Eigen::Vector3d& origin,
                                      const Eigen::Vector3d& direction) const;
  // From any point to the nearest surface.
  double Distance(const Eigen::Vector3d& point) const;
  // Red, green, blue, 0..255, of a surface point.
  std::array<double, 3> ColorAt(const Eigen::Vector3d& point) const;

 private:
  std::vector<Rectangle> rectangles_;
  NoiseTexture texture_;
};

// Where a camera stands and looks.
struct Viewpoint {
  Camera camera;
  Rigid3d cam_from_world;

  Eigen::Vector3d Center() const { return cam_from_world.OriginInSource(); }
};

// Camera centre, and rotations about the camera's x, y, z axes in degrees (small ones: pitch, yaw,
// roll).
Viewpoint StandAt(const Camera& camera, const Eigen::Vector3d& center,
                  const Eigen::Vector3d& turn_deg = Eigen::Vector3d::Zero());

// All that the program knows but kEquirectangular.
std::vector<CameraModel> RectifiableCameraModels();
// A camera of any model with mild distortion, its principal point off the centre.
Camera MildCamera(CameraModel model, double focal, int width, int height);

// The texture's mean over 2 x 2 rays a pixel; black where no ray meets anything.
ColorImage TakePicture(const World& world, const Viewpoint& viewpoint);

// The surface point that a pixel shows.
std::optional<Eigen::Vector3d> SurfaceAt(const World& world, const Viewpoint& viewpoint,
                                         const Eigen::Vector2d& pixel);
// The pixel that shows a surface point; nullopt outside the picture or where something hides it.
std::optional<Eigen::Vector2d> PixelOf(const World& world, const Viewpoint& viewpoint,
                                       const Eigen::Vector3d& point);

// z = depth.
World FlatWorld(double depth);
// Through (0, 0, depth), turned by angle_deg about the y axis: rising to the right.
World SlantedWorld(double depth, double angle_deg);
// Two levels and the wall between them at x = 0; the near one on the side of `near_sign` x.
World StepWorld(double near_depth, double far_depth, int near_sign);

}  // namespace colmap_seapoint
