// render_cloud CLOUD.ply PICTURE.png: a cloud seen along its mean normal, in its colours and,
// below, by height (blue low, red high). The smallest program on top of seapoint_io.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image_file.h"
#include "colmap_seapoint/io/ply.h"

namespace colmap_seapoint {
namespace {

constexpr int kLongerSide = 1000;  // pixels
constexpr int kMaxHeight = 1500;

struct Axis {
  Eigen::Vector3f direction;
  float low = 0, high = 0;  // of all but a thousandth of the points at either end

  float Position(const CloudPoint& point) const { return direction.dot(point.xyz) - low; }
};

Axis MakeAxis(const std::vector<CloudPoint>& cloud, const Eigen::Vector3f& direction) {
  Axis axis;
  axis.direction = direction;
  std::vector<float> values;
  values.reserve(cloud.size());
  for (const CloudPoint& point : cloud) values.push_back(direction.dot(point.xyz));
  const auto skip = static_cast<std::ptrdiff_t>(values.size() / 1000);
  std::nth_element(values.begin(), values.begin() + skip, values.end());
  axis.low = values[static_cast<size_t>(skip)];
  std::nth_element(values.begin(), values.end() - 1 - skip, values.end());
  axis.high = values[values.size() - 1 - static_cast<size_t>(skip)];
  return axis;
}

// Up is the mean normal; right is the cloud's longest direction across it.
void ViewingAxes(const std::vector<CloudPoint>& cloud, Axis* right, Axis* down, Axis* up) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  for (const CloudPoint& point : cloud) {
    mean += point.xyz.cast<double>();
    normal += point.normal.cast<double>();
  }
  mean /= static_cast<double>(cloud.size());
  if (normal.norm() < 1e-6) normal = Eigen::Vector3d::UnitZ();
  normal.normalize();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const CloudPoint& point : cloud) {
    Eigen::Vector3d offset = point.xyz.cast<double>() - mean;
    offset -= normal * normal.dot(offset);
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d longest = solver.eigenvectors().col(2).normalized();
  *right = MakeAxis(cloud, longest.cast<float>());
  *down = MakeAxis(cloud, longest.cross(normal).cast<float>());
  *up = MakeAxis(cloud, normal.cast<float>());
}

std::array<uint8_t, 3> HeightColor(float share) {
  auto ramp = [share](float center) {
    return static_cast<uint8_t>(255 * std::clamp(1.5f - 4 * std::abs(share - center), 0.0f, 1.0f));
  };
  return {ramp(0.75f), ramp(0.5f), ramp(0.25f)};
}

ColorImage Render(const std::vector<CloudPoint>& cloud) {
  Axis right, down, up;
  ViewingAxes(cloud, &right, &down, &up);
  const float scale = (kLongerSide - 1) / std::max(right.high - right.low, 1e-9f);
  const int height =
      std::clamp(static_cast<int>(scale * (down.high - down.low)) + 1, 1, kMaxHeight);
  ColorImage picture(kLongerSide, 2 * height, 3);
  std::vector<float> top(static_cast<size_t>(kLongerSide) * static_cast<size_t>(height), -1e30f);
  for (const CloudPoint& point : cloud) {
    const int x = static_cast<int>(std::floor(scale * right.Position(point)));
    const int y = static_cast<int>(std::floor(scale * down.Position(point)));
    if (x < 0 || y < 0 || x >= kLongerSide || y >= height) continue;
    float& highest = top[static_cast<size_t>(y) * kLongerSide + static_cast<size_t>(x)];
    const float level = up.Position(point);
    if (level <= highest) continue;
    highest = level;
    const auto color =
        HeightColor(std::clamp(level / std::max(up.high - up.low, 1e-9f), 0.0f, 1.0f));
    for (int c = 0; c < 3; ++c) {
      picture.At(x, y, c) = point.rgb[static_cast<size_t>(c)];
      picture.At(x, y + height, c) = color[static_cast<size_t>(c)];
    }
  }
  return picture;
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: render_cloud CLOUD.ply PICTURE.png\n";
    return 2;
  }
  try {
    const auto cloud = colmap_seapoint::ReadCloud(argv[1]);
    if (cloud.empty()) {
      throw colmap_seapoint::Error(argv[1], "the cloud is empty", "choose another one");
    }
    colmap_seapoint::WriteImage(argv[2], colmap_seapoint::Render(cloud));
  } catch (const std::exception& error) {
    std::cerr << "render_cloud: " << error.what() << "\n";
    return 1;
  }
}
