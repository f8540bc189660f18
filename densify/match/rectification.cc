#include "densify/match/rectification.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/parallel.h"
#include "densify/kernels/rectify_kernels.h"

namespace colmap_seapoint {

namespace {

using rectify::kCell;

constexpr double kMaxAlong = 3;  // asinh(cot of the angle to the baseline), 5.7 degrees

// A box of the rect frame.
struct RectBounds {
  double x_min = 1e30, x_max = -1e30, y_min = 1e30, y_max = -1e30;

  void Add(double x, double y) {
    x_min = std::min(x_min, x);
    x_max = std::max(x_max, x);
    y_min = std::min(y_min, y);
    y_max = std::max(y_max, y);
  }
};

// Whether the picture shows something of the half plane at which Mercator's map is cut open: then
// it reaches from one side of the map to the other.
bool SeesTheCut(const Camera& camera, const Eigen::Matrix3d& cam_from_rect) {
  constexpr int kSamples = 64;
  for (int i = 0; i <= kSamples; ++i) {
    const double u = kMaxAlong * (2.0 * i / kSamples - 1);
    const auto pixel = camera.ImgFromCam(cam_from_rect * Eigen::Vector3d(std::sinh(u), 0, -1));
    if (pixel && camera.InImage(*pixel)) return true;
  }
  return false;
}

}  // namespace

RectWindow WindowOfPicture(const PairGeometry& geometry, bool second) {
  const Camera& camera = second ? geometry.camera2 : geometry.camera1;
  const bool is_mercator = geometry.surface == RectSurface::kMercator;
  constexpr int kSamples = 32;
  const double limit = is_mercator ? kMaxAlong * geometry.focal : 1e9;
  RectBounds bounds;
  for (int j = 0; j <= kSamples; ++j) {
    for (int i = 0; i <= kSamples; ++i) {
      // A plane holds the picture within what it makes of its rim.
      const bool on_rim = i == 0 || j == 0 || i == kSamples || j == kSamples;
      if (!is_mercator && !on_rim) continue;
      const Eigen::Vector2d pixel(static_cast<double>(camera.width) * i / kSamples,
                                  static_cast<double>(camera.height) * j / kSamples);
      const auto rect = second ? geometry.RectFromPixel2(pixel) : geometry.RectFromPixel1(pixel);
      if (rect) bounds.Add(std::clamp(rect->x(), -limit, limit), rect->y());
    }
  }
  if (bounds.x_min > bounds.x_max) return {};
  if (is_mercator &&
      SeesTheCut(camera, second ? geometry.cam2_from_rect : geometry.cam1_from_rect)) {
    bounds.Add(bounds.x_min, -M_PI * geometry.focal);
    bounds.Add(bounds.x_min, M_PI * geometry.focal);
  }
  RectWindow window;
  window.x0 = static_cast<int>(std::floor(bounds.x_min));
  window.y0 = static_cast<int>(std::floor(bounds.y_min));
  window.width = static_cast<int>(std::ceil(bounds.x_max)) - window.x0;
  window.height = static_cast<int>(std::ceil(bounds.y_max)) - window.y0;
  return window;
}

RectMap::RectMap(const PairGeometry& geometry, bool second, const RectWindow& window,
                 int num_threads)
    : window_(window) {
  const Camera& camera = second ? geometry.camera2 : geometry.camera1;
  const Eigen::Matrix3d& cam_from_rect = second ? geometry.cam2_from_rect : geometry.cam1_from_rect;
  source_width_ = camera.width;
  source_height_ = camera.height;
  nodes_x_ = window.width / kCell + 2;
  nodes_y_ = window.height / kCell + 2;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  nodes_.assign(static_cast<size_t>(nodes_x_) * static_cast<size_t>(nodes_y_),
                Eigen::Vector2f(nan, nan));
  ParallelFor(num_threads, nodes_y_, [&](int64_t row) {
    const double y = window.y0 + 0.5 + static_cast<double>(row) * kCell;
    for (int column = 0; column < nodes_x_; ++column) {
      const double x = window.x0 + 0.5 + static_cast<double>(column) * kCell;
      const auto pixel = camera.ImgFromCam(cam_from_rect * geometry.RayAt(x, y));
      // Far outside, distortion polynomials fold back: only rays that the camera really has.
      if (!pixel || pixel->x() < -camera.width || pixel->x() > 2 * camera.width ||
          pixel->y() < -camera.height || pixel->y() > 2 * camera.height) {
        continue;
      }
      nodes_[static_cast<size_t>(row) * static_cast<size_t>(nodes_x_) +
             static_cast<size_t>(column)] = pixel->cast<float>();
    }
  });
}

std::optional<Eigen::Vector2f> RectMap::Source(int i, int j) const {
  const Eigen::Vector2f* node = nodes_.data() +
                                static_cast<size_t>(j / kCell) * static_cast<size_t>(nodes_x_) +
                                static_cast<size_t>(i / kCell);
  const float u = static_cast<float>(i % kCell) / kCell, v = static_cast<float>(j % kCell) / kCell;
  const Eigen::Vector2f source = (1 - v) * ((1 - u) * node[0] + u * node[1]) +
                                 v * ((1 - u) * node[nodes_x_] + u * node[nodes_x_ + 1]);
  // The comparison is false for NaN too.
  if (!(source.x() >= 0.5f && source.y() >= 0.5f &&
        source.x() < static_cast<float>(source_width_) - 0.5f &&
        source.y() < static_cast<float>(source_height_) - 0.5f)) {
    return std::nullopt;
  }
  return source;
}

BlockMask::BlockMask(const RectWindow& window)
    : columns_((window.width + kWidth - 1) / kWidth),
      rows_((window.height + kHeight - 1) / kHeight),
      wanted_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0) {}

void BlockMask::Want(int x0, int y0, int x1, int y1) {
  const int a1 = std::min(columns_, (x1 + kWidth - 1) / kWidth);
  const int b1 = std::min(rows_, (y1 + kHeight - 1) / kHeight);
  for (int b = std::max(0, y0) / kHeight; b < b1; ++b) {
    for (int a = std::max(0, x0) / kWidth; a < a1; ++a) {
      wanted_[static_cast<size_t>(b) * static_cast<size_t>(columns_) + static_cast<size_t>(a)] = 1;
    }
  }
}

void RectMap::SourceRow(int j, int begin, int end, float* x, float* y) const {
  const Eigen::Vector2f* above = nodes_.data() +
                                 static_cast<size_t>(j / kCell) * static_cast<size_t>(nodes_x_) +
                                 static_cast<size_t>(begin / kCell);
  rectify::InterpolateRow(above->data(), (above + nodes_x_)->data(),
                          static_cast<float>(j % kCell) / kCell, end - begin, x, y);
}

RectPicture RectMap::Rectify(const GrayImage& source, const BlockMask& blocks,
                             int num_threads) const {
  RectPicture picture{window_, GrayImage()};
  picture.gray.width = window_.width;
  picture.gray.height = window_.height;
  picture.gray.data.assign(
      static_cast<size_t>(window_.width) * static_cast<size_t>(window_.height) +
          RectPicture::kSlack,
      0);
  ParallelFor(num_threads, blocks.Rows(), [&](int64_t band) {
    const int row = static_cast<int>(band);
    const int j_end = std::min(window_.height, (row + 1) * BlockMask::kHeight);
    std::array<float, BlockMask::kWidth + kRowSlack> x, y;
    for (int column = 0; column < blocks.Columns(); ++column) {
      if (!blocks.Wanted(column, row)) continue;
      const int begin = column * BlockMask::kWidth;
      const int end = std::min(window_.width, begin + BlockMask::kWidth);
      // Block by block: where the frame is turned against the picture, a row of it runs down
      // columns of the picture, and the next row wants the same cache lines.
      for (int j = row * BlockMask::kHeight; j < j_end; ++j) {
        SourceRow(j, begin, end, x.data(), y.data());
        rectify::SampleRow(source, x.data(), y.data(), end - begin, picture.gray.Row(j) + begin);
      }
    }
  });
  return picture;
}

}  // namespace colmap_seapoint
