// The survey's camera behind the window of its housing: a flat or a dome port, and what Snell's law
// makes of rays on their way from air through glass into water, exactly.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

inline constexpr double kGlassIndex = 1.52, kWaterIndex = 1.333;

enum class PortKind { kNone, kFlat, kDome };

// Metres. The entrance pupil is the camera's centre.
struct PortOptions {
  PortKind kind = PortKind::kNone;
  double thickness = 0.006;  // of the glass
  double distance = 0.02;    // flat: from the entrance pupil to the glass
  double tilt_deg = 0;       // flat: about the camera's y
  double radius = 0.06;      // dome: of the outside
  double decentring = 0;     // dome: its centre before (> 0) or behind the entrance pupil
  double sideways = 0;       // dome: its centre aside of the axis, along the camera's x
};

struct WaterRay {                                    // camera frame
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // on the outside of the port; no port: zero
  Eigen::Vector3d direction;                         // in the water, z = 1
};

// `in_water` is what the camera is for rays near the axis of a port that is not tilted or
// decentred; behind a flat port the lens has a focal length shorter by the index of water. So
// footprints and GSD are the same through any port, but for what the port does to the corners.
class PortCamera {
 public:
  PortCamera(const PortOptions& port, const Camera& in_water);

  // nullopt where the lens forms no picture.
  std::optional<WaterRay> Ray(const Eigen::Vector2d& pixel) const;
  // The pixel of a point in the water, camera frame: by the one way of light to the pupil. nullopt
  // for points that are behind the glass, farther from the axis than the lens forms pictures, or
  // well outside of the picture.
  std::optional<Eigen::Vector2d> ImgFromCam(const Eigen::Vector3d& point) const;

  // Whether the picture may hold a point of this ball, camera frame; where not, it holds none.
  bool MayHold(const Eigen::Vector3d& centre, double radius) const;

  const Camera& InWater() const { return in_water_; }
  bool HasPort() const { return port_.kind != PortKind::kNone; }

 private:
  std::optional<WaterRay> Refract(const Eigen::Vector3d& in_air) const;
  std::optional<Eigen::Vector3d> DirectionInAir(const Eigen::Vector3d& point) const;
  void MeasureReach();
  double Miss(const Eigen::Vector3d& across, double angle, const Eigen::Vector3d& point) const;

  PortOptions port_;
  Camera in_water_, lens_;
  double max_tangent_;  // of the lens, in air
  // No place in the picture lies farther from the axis than `reach_` and this slope times its
  // depth.
  double reach_ = 0, slope_ = 0;
  Eigen::Vector3d axis_;    // all is symmetrical about it: the flat port's normal, or to the dome's
  Eigen::Vector3d centre_;  // of the dome
};

}  // namespace colmap_seapoint
