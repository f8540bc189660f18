#include "densify/maps/undistortion.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

namespace {

constexpr double kMaxSlope = 3.0;  // |x / z| of a ray that is still used, as in rectification
constexpr double kMinSize = 0.2, kMaxSize = 2.0;  // of the source's, COLMAP's bounds
constexpr int kCell = 8;                          // pixels between exact places of the map
constexpr int kBand = 64;                         // rows that are remapped at once
constexpr float kNowhere = -1e4f;

// low .. high: the part of one axis of the plane z = 1 that the picture fills.
struct Span {
  double low = -kMaxSlope, high = kMaxSlope;

  void NotBelow(double value) { low = std::max(low, value); }
  void NotAbove(double value) { high = std::min(high, value); }
};

// A span of at least and at most so many pixels, around the place that the axis of the lens has in
// it.
void KeepWithin(double focal, double size, Span* span) {
  const double pixels = focal * (span->high - span->low);
  if (!(span->high > span->low) || pixels < kMinSize * size) {
    // The borders cross: a lens that no picture comes from. What it would be without distortion.
    *span = {-0.5 * size / focal, 0.5 * size / focal};
  } else if (pixels > kMaxSize * size) {
    span->low *= kMaxSize * size / pixels;
    span->high *= kMaxSize * size / pixels;
  }
}

bool HasNoDistortion(const Camera& camera) {
  return camera.model == CameraModel::kPinhole || camera.model == CameraModel::kSimplePinhole;
}

// Where pixels of the target lie in the source, less half a pixel as OpenCV counts: exact on
// lattice points kCell apart, linear in between, which is off by less than 0.01 pixels.
class SourceMap {
 public:
  SourceMap(const Camera& from, const Camera& to)
      : columns_((to.width + kCell - 1) / kCell + 1), rows_((to.height + kCell - 1) / kCell + 1) {
    nodes_.reserve(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
    for (int b = 0; b < rows_; ++b) {
      for (int a = 0; a < columns_; ++a) {
        const Eigen::Vector3d ray((a * kCell + 0.5 - to.PrincipalX()) / to.FocalX(),
                                  (b * kCell + 0.5 - to.PrincipalY()) / to.FocalY(), 1);
        const auto pixel = from.ImgFromCam(ray);
        nodes_.push_back(pixel ? Eigen::Vector2f((pixel->array() - 0.5).cast<float>())
                               : Eigen::Vector2f(kNowhere, kNowhere));
      }
    }
  }

  void Row(int y, int width, float* source_x, float* source_y) const {
    const Eigen::Vector2f* above = &nodes_[static_cast<size_t>(y / kCell * columns_)];
    const Eigen::Vector2f* below = above + columns_;
    const float v = static_cast<float>(y % kCell) / kCell;
    for (int x = 0; x < width; ++x) {
      const int a = x / kCell;
      const float u = static_cast<float>(x % kCell) / kCell;
      const Eigen::Vector2f place = (1 - v) * ((1 - u) * above[a] + u * above[a + 1]) +
                                    v * ((1 - u) * below[a] + u * below[a + 1]);
      source_x[x] = place.x();
      source_y[x] = place.y();
    }
  }

 private:
  int columns_, rows_;
  std::vector<Eigen::Vector2f> nodes_;
};

}  // namespace

Camera UndistortedCamera(const Camera& camera) {
  SEAPOINT_CHECK(camera.model != CameraModel::kEquirectangular);
  Camera pinhole = camera;
  pinhole.model = CameraModel::kPinhole;
  const double fx = camera.FocalX(), fy = camera.FocalY();
  if (HasNoDistortion(camera)) {
    pinhole.params = {fx, fy, camera.PrincipalX(), camera.PrincipalY()};
    return pinhole;
  }
  Span x, y;
  for (int i = 0; i <= camera.height; ++i) {
    if (const auto left = camera.CamFromImg({0, i})) x.NotBelow(left->x());
    if (const auto right = camera.CamFromImg({camera.width, i})) x.NotAbove(right->x());
  }
  for (int i = 0; i <= camera.width; ++i) {
    if (const auto top = camera.CamFromImg({i, 0})) y.NotBelow(top->y());
    if (const auto bottom = camera.CamFromImg({i, camera.height})) y.NotAbove(bottom->y());
  }
  KeepWithin(fx, camera.width, &x);
  KeepWithin(fy, camera.height, &y);
  pinhole.width = std::max(1, static_cast<int>(fx * (x.high - x.low)));
  pinhole.height = std::max(1, static_cast<int>(fy * (y.high - y.low)));
  pinhole.params = {fx, fy, -fx * x.low, -fy * y.low};
  return pinhole;
}

Image<uint8_t> UndistortPicture(const Image<uint8_t>& picture, const Camera& from,
                                const Camera& to) {
  const SourceMap map(from, to);
  const int type = CV_8UC(picture.channels);
  const cv::Mat source(picture.height, picture.width, type,
                       const_cast<uint8_t*>(picture.data.data()));
  Image<uint8_t> undistorted(to.width, to.height, picture.channels);
  for (int y0 = 0; y0 < to.height; y0 += kBand) {
    const int rows = std::min(kBand, to.height - y0);
    cv::Mat x(rows, to.width, CV_32F), y(rows, to.width, CV_32F);
    for (int i = 0; i < rows; ++i) {
      map.Row(y0 + i, to.width, x.ptr<float>(i), y.ptr<float>(i));
    }
    // Places half a pixel beyond the outermost centres still lie in the picture.
    cv::Mat band(rows, to.width, type, undistorted.Row(y0));
    cv::remap(source, band, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < to.width; ++j) {
        const float u = x.at<float>(i, j), v = y.at<float>(i, j);
        const bool inside = u >= -1 && v >= -1 && u <= static_cast<float>(picture.width) &&
                            v <= static_cast<float>(picture.height);
        if (inside) continue;
        for (int k = 0; k < picture.channels; ++k) undistorted.At(j, y0 + i, k) = 0;
      }
    }
  }
  return undistorted;
}

SparseModel UndistortedModel(const SparseModel& model) {
  SparseModel undistorted;
  for (const auto& [camera_id, camera] : model.cameras) {
    undistorted.cameras[camera_id] = UndistortedCamera(camera);
  }
  for (const auto& [point3D_id, point] : model.points3D) {
    undistorted.points3D[point3D_id] = {point.xyz, point.rgb, point.error, {}};
  }
  std::vector<const PosedImage*> by_id;
  for (const PosedImage& image : model.images) by_id.push_back(&image);
  std::sort(by_id.begin(), by_id.end(),
            [](const auto* a, const auto* b) { return a->image_id < b->image_id; });
  for (const PosedImage* image : by_id) {
    const Camera& from = model.cameras.at(image->camera_id);
    const Camera& to = undistorted.cameras.at(image->camera_id);
    PosedImage kept{image->image_id, image->camera_id, image->name, image->cam_from_world, {}, {}};
    SEAPOINT_CHECK(image->points2D.size() == image->point3D_ids.size());
    for (size_t i = 0; i < image->points2D.size(); ++i) {
      const uint64_t id = image->point3D_ids[i];
      if (id == kNoPoint3D) continue;
      SparsePoint& point = undistorted.points3D.at(id);
      const auto ray = from.CamFromImg(image->points2D[i]);
      const Eigen::Vector3d in_cam =
          ray ? Eigen::Vector3d(ray->homogeneous()) : image->cam_from_world * point.xyz;
      const auto pixel = to.ImgFromCam(in_cam);
      if (!pixel) continue;
      point.track.push_back({kept.image_id, static_cast<uint32_t>(kept.points2D.size())});
      kept.points2D.push_back(*pixel);
      kept.point3D_ids.push_back(id);
    }
    undistorted.images.push_back(std::move(kept));
  }
  return undistorted;
}

}  // namespace colmap_seapoint
