// A pair of posed pictures turned so that matches lie on the same row (ours: the poses are known,
// so the search is along the epipolar line). Any camera model; lens distortion is taken out on the
// way.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"
#include "densify/match/sample_grid.h"

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

// The smallest window that holds the picture's part of the rect plane, up to 72 degrees aside.
RectWindow WindowOfPicture(const PairGeometry& geometry, bool second);

// The blocks of a window that are wanted: what is asked for of a large window is often little.
class BlockMask {
 public:
  static constexpr int kWidth = 64, kHeight = 16;  // pixels

  explicit BlockMask(const RectWindow& window);
  // The blocks that hold a pixel x0 <= x < x1, y0 <= y < y1 of the window.
  void Want(int x0, int y0, int x1, int y1);
  bool Wanted(int column, int row) const {
    return wanted_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                   static_cast<size_t>(column)] != 0;
  }
  int Columns() const { return columns_; }
  int Rows() const { return rows_; }

 private:
  int columns_, rows_;
  std::vector<uint8_t> wanted_;
};

struct RectPicture {
  RectWindow window;
  GrayImage
      gray;  // as large as the window; 0 outside the picture and where not wanted, else 1..255

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
  // The same for the pixels begin .. end - 1 of row j, begin a multiple of 8: NaN or beyond the
  // picture where there is none; x and y, from pixel begin on, have room for kRowSlack more.
  void SourceRow(int j, int begin, int end, float* x, float* y) const;
  // Bilinear. Rows are spread over threads.
  RectPicture Rectify(const GrayImage& source, const BlockMask& blocks, int num_threads) const;

 private:
  RectWindow window_;
  int source_width_, source_height_;
  int nodes_x_, nodes_y_;
  std::vector<Eigen::Vector2f> nodes_;  // NaN where there is no projection
};

}  // namespace colmap_seapoint
