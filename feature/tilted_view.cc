#include "feature/tilted_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "feature/extract_features.h"

namespace colmap_seapoint {
namespace {

constexpr double kMaxPixels = 3e6;    // of a view
constexpr double kMaxDistance = 2.5;  // times that of the ground in the picture's middle
constexpr double kSideMargin = 1.15;  // of the ground that the lowest row shows
constexpr int kMinSide = 100;         // pixels
constexpr double kRadian = M_PI / 180;

// The part of the ground that is drawn, in distances of the ground in the picture's middle: u to
// the right, v towards the camera, both from there.
struct GroundFrame {
  double sine = 0, cosine = 1;  // of the tilt
  double half_width = 0, v0 = 0, v1 = 0;
  int width = 0, height = 0;  // of the view, pixels

  Eigen::Vector3d RayOf(double x, double y) const {
    const double u = (2 * x / width - 1) * half_width, v = v0 + (v1 - v0) * y / height;
    return {u, v * cosine, 1 - v * sine};
  }
};

// The size stays zero where there is no such ground.
GroundFrame FrameOf(const Camera& camera, double tilt_deg) {
  GroundFrame frame;
  frame.sine = std::sin(tilt_deg * kRadian);
  frame.cosine = std::cos(tilt_deg * kRadian);
  const double farthest = frame.cosine * (1 / kMaxDistance - 1) / std::max(frame.sine, 1e-9);
  const double k0 = std::max(-camera.PrincipalY() / camera.FocalY(), farthest);
  const double k1 = (camera.height - camera.PrincipalY()) / camera.FocalY();
  const auto v_of = [&](double k) { return k / (frame.cosine + k * frame.sine); };
  frame.v0 = v_of(k0);
  frame.v1 = v_of(k1);
  if (!(frame.v1 > frame.v0)) return frame;
  frame.half_width =
      kSideMargin * 0.5 * camera.width / camera.FocalX() * (1 - frame.v1 * frame.sine);
  const double area = 2 * frame.half_width * (frame.v1 - frame.v0);
  const double pixels = std::min(camera.MeanFocal(), std::sqrt(kMaxPixels / area));
  frame.width = static_cast<int>(2 * frame.half_width * pixels);
  frame.height = static_cast<int>((frame.v1 - frame.v0) * pixels);
  return frame;
}

Camera CameraOf(const GroundFrame& frame) {
  const double scale_x = frame.width / (2 * frame.half_width);
  const double scale_y = frame.height / (frame.v1 - frame.v0);
  Camera camera = MakeCamera(CameraModel::kPinhole, scale_x, frame.width, frame.height);
  camera.params = {scale_x * frame.cosine, scale_y * frame.cosine, 0.5 * frame.width,
                   (frame.sine - frame.v0) * scale_y};
  return camera;
}

cv::Mat MatOf(const GrayImage& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<uint8_t*>(image.data.data()));
}

// How the picture is reduced before the view is drawn, so that fine texture does not become noise:
// across by as much as the view is, along by less, for the view draws out what the tilt shortened.
struct Reduction {
  double x = 1, y = 1;
};

Reduction ReductionOf(const GroundFrame& frame, const Camera& camera) {
  const double scale = frame.width / (2 * frame.half_width) / camera.MeanFocal();
  return {std::min(1.0, scale), std::min(1.0, scale / frame.cosine)};
}

// Where each pixel of the view lies in the reduced picture, in OpenCV's frame; far outside where
// the camera sees nothing.
cv::Mat MapOf(const GroundFrame& frame, const Camera& camera, const Reduction& reduction) {
  cv::Mat map(frame.height, frame.width, CV_32FC2);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const auto pixel = camera.ImgFromCam(frame.RayOf(x + 0.5, y + 0.5));
      map.at<cv::Vec2f>(y, x) = pixel
                                    ? cv::Vec2f(static_cast<float>(pixel->x() * reduction.x - 0.5),
                                                static_cast<float>(pixel->y() * reduction.y - 0.5))
                                    : cv::Vec2f(-1e6f, -1e6f);
    }
  }
  return map;
}

GrayImage Drawn(const cv::Mat& source, const cv::Mat& map, int interpolation, int border) {
  GrayImage view(map.cols, map.rows);
  cv::Mat target = MatOf(view);
  cv::remap(source, target, map, cv::noArray(), interpolation, border, 0);
  return view;
}

}  // namespace

TiltedView ExtractTiltedView(const GrayImage& picture, const GrayImage& mask, const Camera& camera,
                             double tilt_deg, const SeaPointExtractionOptions& options) {
  TiltedView view;
  const GroundFrame frame = FrameOf(camera, tilt_deg);
  if (picture.Empty() || std::min(frame.width, frame.height) < kMinSide) return view;
  view.camera = CameraOf(frame);
  const Reduction reduction = ReductionOf(frame, camera);
  cv::Mat reduced, all_seen;
  cv::resize(MatOf(picture), reduced, {}, reduction.x, reduction.y, cv::INTER_AREA);
  if (mask.Empty()) {
    all_seen = cv::Mat(reduced.size(), CV_8U, cv::Scalar(255));
  } else {
    cv::resize(MatOf(mask), all_seen, reduced.size(), 0, 0, cv::INTER_NEAREST);
  }
  const cv::Mat map = MapOf(frame, camera, reduction);
  SeaPointExtractionOptions of_view = options;
  of_view.min_num_features *= 2;
  of_view.max_num_features *= 2;
  of_view.num_levels = kTiltedLevels;
  view.features =
      ExtractFeatures(Drawn(reduced, map, cv::INTER_LINEAR, cv::BORDER_REPLICATE),
                      Drawn(all_seen, map, cv::INTER_NEAREST, cv::BORDER_CONSTANT), of_view)
          .features;
  for (const SeaPoint& point : view.features.points) {
    const auto pixel = camera.ImgFromCam(frame.RayOf(point.x, point.y));
    view.in_picture.push_back(pixel.value_or(Eigen::Vector2d::Zero()));
  }
  return view;
}

}  // namespace colmap_seapoint
