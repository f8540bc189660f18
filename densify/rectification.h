// A pair of posed pictures turned so that matches lie on the same row (ours: the poses are known,
// so the search is along the epipolar line). Any camera model; lens distortion is taken out on the
// way.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

// The common rectified frame "rect": a pinhole at each camera centre, x axis along the baseline
// from camera 1 to camera 2, z axis between the two viewing directions. A point at depth Z has the
// disparity x1 - x2 = focal * baseline / Z > 0.
struct PairGeometry {
  Camera camera1, camera2;
  Eigen::Matrix3d cam1_from_rect, cam2_from_rect, world_from_rect;
  Eigen::Vector3d center1;  // world
  double focal = 0;         // pixels
  double baseline = 0;      // model units

  // Pixel of picture 1 / 2 -> (x, y) in rect pixels (no offset: the axis is at (0, 0)).
  std::optional<Eigen::Vector2d> RectFromPixel1(const Eigen::Vector2d& pixel) const;
  std::optional<Eigen::Vector2d> RectFromPixel2(const Eigen::Vector2d& pixel) const;
  // Disparity of a point at (x, y) at a distance from the centre of camera 1, model units.
  double DisparityAtRange(double x, double y, double range) const;
  // The point of the world at rect position (x, y) and disparity d > 0.
  Eigen::Vector3d PointInWorld(double x, double y, double disparity) const;
};

// nullopt when the cameras coincide, or when one looks along the baseline (the epipole lies in or
// near the picture): no rectification exists.
std::optional<PairGeometry> MakePairGeometry(const Camera& camera1, const Rigid3d& cam1_from_world,
                                             const Camera& camera2, const Rigid3d& cam2_from_world);

// A window of the rect plane: pixel (i, j) of the window is centred at rect (x0 + i + 0.5, ...).
struct RectWindow {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

// The smallest window that holds the picture's part of the rect plane, up to 72 degrees aside.
RectWindow WindowOfPicture(const PairGeometry& geometry, bool second);

struct RectPicture {
  RectWindow window;
  GrayImage gray;  // as large as the window; 0 outside the picture, 1..255 in it

  // Bytes behind the last pixel that may be read (vectors reach beyond a window).
  static constexpr size_t kSlack = 16;
};

// Where the pixels of a window come from: positions in the source picture, sampled every kCell
// pixels and bilinear in between.
class RectMap {
 public:
  static constexpr size_t kRowSlack = 16;

  RectMap(const PairGeometry& geometry, bool second, const RectWindow& window, int num_threads);
  // Source position (pixels) of the window's pixel (i, j); nullopt outside the picture.
  std::optional<Eigen::Vector2f> Source(int i, int j) const;
  // The same for the whole row j, NaN or beyond the picture where there is none; x and y hold
  // window.width + kRowSlack values.
  void SourceRow(int j, float* x, float* y) const;
  // Bilinear. Rows are spread over threads.
  RectPicture Rectify(const GrayImage& source, int num_threads) const;

 private:
  RectWindow window_;
  int source_width_, source_height_;
  int nodes_x_, nodes_y_;
  std::vector<Eigen::Vector2f> nodes_;  // NaN where there is no projection
};

}  // namespace colmap_seapoint
