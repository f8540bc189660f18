// render_cloud CLOUD.ply PICTURE.png: a cloud seen from above (along its smallest axis), in its
// colours and, below, by height (blue low, red high). The smallest program on top of
// seapoint_compare.

#include <algorithm>
#include <iostream>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 1000;  // pixels
constexpr int kMaxHeight = 1500;

ColorImage Render(const std::vector<CloudPoint>& cloud) {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d normal_sum = Eigen::Vector3d::Zero();
  for (const CloudPoint& point : cloud) {
    points.push_back(point.xyz.cast<double>());
    normal_sum += point.normal.cast<double>();
  }
  const PlanView view = FitPlanView(points, {}, normal_sum);
  const double relief = std::max(view.high[2] - view.low[2], 1e-9);
  PlanPicture colors(view, kWidth, kMaxHeight), heights(view, kWidth, kMaxHeight);
  for (size_t i = 0; i < cloud.size(); ++i) {
    colors.Add(points[i], cloud[i].rgb);
    heights.Add(points[i], RampColor((view.FromWorld(points[i])[2] - view.low[2]) / relief));
  }
  return StackPictures(colors.Picture(), heights.Picture());
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
