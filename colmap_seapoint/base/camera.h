// COLMAP's camera models, all 18 of COLMAP 4.1 (3.8 has 0 to 10): intrinsics, projection and its
// inverse.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace colmap_seapoint {

// Numbers and parameter order are COLMAP's.
enum class CameraModel : int {
  kSimplePinhole = 0,            // f, cx, cy
  kPinhole = 1,                  // fx, fy, cx, cy
  kSimpleRadial = 2,             // f, cx, cy, k
  kRadial = 3,                   // f, cx, cy, k1, k2
  kOpenCV = 4,                   // fx, fy, cx, cy, k1, k2, p1, p2
  kOpenCVFisheye = 5,            // fx, fy, cx, cy, k1, k2, k3, k4
  kFullOpenCV = 6,               // fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6
  kFov = 7,                      // fx, fy, cx, cy, omega
  kSimpleRadialFisheye = 8,      // f, cx, cy, k
  kRadialFisheye = 9,            // f, cx, cy, k1, k2
  kThinPrismFisheye = 10,        // fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1
  kRadTanThinPrismFisheye = 11,  // fx, fy, cx, cy, k0 ... k5, p0, p1, s0 ... s3 (COLMAP 3.11)
  kSimpleDivision = 12,          // f, cx, cy, k (this and the next three: 4.0)
  kDivision = 13,                // fx, fy, cx, cy, k
  kSimpleFisheye = 14,           // f, cx, cy
  kFisheye = 15,                 // fx, fy, cx, cy
  kEucm = 16,                    // fx, fy, cx, cy, alpha, beta (4.1)
  kEquirectangular = 17,         // width, height (4.1): the half in front of the camera is used
};

struct CameraModelInfo {
  CameraModel model;
  const char* name;  // COLMAP's, e.g. "OPENCV"
  int num_params;
  // params[0] = f, (cx, cy) = params[1..2]; else fx, fy, cx, cy. (Neither for kEquirectangular.)
  bool has_single_focal;
};

// nullptr when this program does not know the model.
const CameraModelInfo* FindCameraModel(int model_id);
const CameraModelInfo* FindCameraModel(const std::string& name);
// "SIMPLE_PINHOLE, PINHOLE, ..." for messages.
std::string CameraModelNames();

struct Camera {
  uint32_t camera_id = 0;
  CameraModel model = CameraModel::kOpenCV;
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::vector<double> params;
  bool has_prior_focal_length = false;

  // Pixels; of kEquirectangular: pixels a radian, on the axis.
  double FocalX() const;
  double FocalY() const;
  double MeanFocal() const { return 0.5 * (FocalX() + FocalY()); }
  double PrincipalX() const;
  double PrincipalY() const;

  // Pixel coordinates of a direction in the camera frame (x right, y down, z forward).
  // nullopt for z <= 0 (behind the camera), and for non-finite results.
  std::optional<Eigen::Vector2d> ImgFromCam(const Eigen::Vector3d& point_in_cam) const;

  // The point (u, v) on the plane z = 1 that projects to the pixel: Newton iterations on the
  // distortion; nullopt when they do not come back to within 1e-3 px, or when the ray points
  // sideways or backwards.
  std::optional<Eigen::Vector2d> CamFromImg(const Eigen::Vector2d& pixel) const;

  bool InImage(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width && pixel.y() <= height;
  }
};

// Whether pictures of these two sizes can show the same in two resolutions (paper 4, hybrid
// resolution): one factor takes both sides of one to the other's, whole pixels apart for rounding.
// True for equal sizes; false where only one side differs.
bool AreScaledSizes(int width1, int height1, int width2, int height2);

// The same camera for its pictures in another resolution, width x height pixels: what was at (x, y)
// is at (k x, k y), since the first pixel covers [0, 1). Distortion parameters stay. Needs
// AreScaledSizes; a single focal length takes the mean of the two sides' factors, which rounding
// keeps apart.
Camera ScaledCamera(const Camera& camera, int width, int height);

// A camera with COLMAP's initial guess: principal point at the centre, no distortion.
Camera MakeCamera(CameraModel model, double focal, int width, int height);

}  // namespace colmap_seapoint
