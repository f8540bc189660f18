// render_cloud CLOUD.ply PICTURE.png: a cloud seen from above (along its smallest axis), in its
// colours and, below, by height (blue low, red high). With --camera MODEL IMAGE_NAME: as that
// picture of the model saw it and, below, by distance (red near, blue far), points as squares of
// --point_size pixels. --max_range R leaves out what is farther than R from the nearest camera of
// the model, which
// --model MODEL names where no --camera does.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/compare/point_index.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/camera_picture.h"

namespace colmap_seapoint {
namespace {

constexpr char kUsage[] =
    "usage: render_cloud CLOUD.ply PICTURE.png [--camera MODEL IMAGE_NAME | --model MODEL]\n"
    "                    [--max_range R] [--point_size N]\n";
constexpr int kWidth = 1000;  // pixels
constexpr int kMaxHeight = 1500;

struct Arguments {
  std::string cloud_path, picture_path, model_path, image_name;
  double max_range = std::numeric_limits<double>::infinity();
  int point_size = 3;
};

Arguments Parse(const std::vector<std::string>& words) {
  Arguments arguments;
  size_t i = 0;
  const auto next = [&] {
    if (i >= words.size()) throw UsageError("a value is missing");
    return words[i++];
  };
  arguments.cloud_path = next();
  arguments.picture_path = next();
  while (i < words.size()) {
    const std::string option = next();
    if (option == "--camera" || option == "--model") {
      arguments.model_path = next();
      if (option == "--camera") arguments.image_name = next();
    } else if (option == "--max_range") {
      arguments.max_range = std::atof(next().c_str());
    } else if (option == "--point_size") {
      arguments.point_size = std::atoi(next().c_str());
    } else {
      throw UsageError("unknown option " + option);
    }
  }
  if (!(arguments.max_range > 0)) throw UsageError("--max_range must be a number above 0");
  if (arguments.point_size < 1) throw UsageError("--point_size must be 1 at least");
  if (std::isfinite(arguments.max_range) && arguments.model_path.empty()) {
    throw UsageError("--max_range needs --model or --camera");
  }
  return arguments;
}

PointVector CentersOf(const SparseModel& model) {
  PointVector centers;
  for (const PosedImage& image : model.images) {
    centers.push_back(image.cam_from_world.OriginInSource());
  }
  return centers;
}

std::vector<CloudPoint> WithinRange(const std::vector<CloudPoint>& cloud,
                                    const PointVector& centers, double max_range) {
  const PointIndex index(centers);
  std::vector<CloudPoint> near;
  for (const CloudPoint& point : cloud) {
    double squared = kBeyond;
    index.Nearest(point.xyz.cast<double>(), NearestOf::kAnyPoint, &squared);
    if (squared <= max_range * max_range) near.push_back(point);
  }
  return near;
}

// Above is where the cameras are; without a model, where the normals point to.
ColorImage RenderFromAbove(const std::vector<CloudPoint>& cloud, const PointVector& centers) {
  PointVector points;
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), center = Eigen::Vector3d::Zero();
  for (const CloudPoint& point : cloud) {
    points.push_back(point.xyz.cast<double>());
    center += points.back() / static_cast<double>(cloud.size());
    if (centers.empty()) up += point.normal.cast<double>();
  }
  for (const Eigen::Vector3d& camera : centers) up += camera - center;
  const PlanView view = FitPlanView(points, {}, up);
  const double relief = std::max(view.high[2] - view.low[2], 1e-9);
  PlanPicture colors(view, kWidth, kMaxHeight), heights(view, kWidth, kMaxHeight);
  for (size_t i = 0; i < cloud.size(); ++i) {
    colors.Add(points[i], cloud[i].rgb);
    heights.Add(points[i], RampColor((view.FromWorld(points[i])[2] - view.low[2]) / relief));
  }
  return StackPictures(colors.Picture(), heights.Picture());
}

const PosedImage& FindImage(const SparseModel& model, const Arguments& arguments) {
  for (const PosedImage& image : model.images) {
    if (image.name == arguments.image_name) return image;
  }
  throw Error(arguments.model_path, "has no picture " + arguments.image_name,
              "choose one of its names");
}

// Distances fill the ramp by their logarithm, between the nearest and the farthest hundredth.
ColorImage RenderFromCamera(const std::vector<CloudPoint>& cloud, const Camera& camera,
                            const Rigid3d& cam_from_world, int point_size) {
  std::vector<double> logs;
  for (const CloudPoint& point : cloud) {
    const double depth = (cam_from_world * point.xyz.cast<double>()).z();
    if (depth > 0) logs.push_back(std::log(depth));
  }
  std::sort(logs.begin(), logs.end());
  const double low = logs.empty() ? 0 : logs[logs.size() / 100];
  const double high = logs.empty() ? 1 : logs[logs.size() - 1 - logs.size() / 100];
  CameraPicture colors(camera, cam_from_world, point_size),
      distances(camera, cam_from_world, point_size);
  for (const CloudPoint& point : cloud) {
    const Eigen::Vector3d xyz = point.xyz.cast<double>();
    const double depth = (cam_from_world * xyz).z();
    if (depth <= 0) continue;
    colors.Add(xyz, point.rgb);
    distances.Add(xyz, RampColor((high - std::log(depth)) / std::max(high - low, 1e-9)));
  }
  return StackPictures(colors.Picture(), distances.Picture());
}

void Run(const Arguments& arguments) {
  std::vector<CloudPoint> cloud = ReadCloud(arguments.cloud_path);
  SparseModel model;
  if (!arguments.model_path.empty()) {
    model = ReadSparseModel(arguments.model_path, ModelContent::kPosesAndPoints);
    cloud = WithinRange(cloud, CentersOf(model), arguments.max_range);
  }
  if (cloud.empty()) throw Error(arguments.cloud_path, "has no points", "choose another one");
  if (arguments.image_name.empty()) {
    WriteImage(arguments.picture_path, RenderFromAbove(cloud, CentersOf(model)));
    return;
  }
  const PosedImage& image = FindImage(model, arguments);
  WriteImage(arguments.picture_path, RenderFromCamera(cloud, model.cameras.at(image.camera_id),
                                                      image.cam_from_world, arguments.point_size));
}

}  // namespace
}  // namespace colmap_seapoint

int main(int argc, char** argv) {
  using namespace colmap_seapoint;
  try {
    Run(Parse({argv + 1, argv + argc}));
  } catch (const UsageError& error) {
    std::cerr << kUsage << "render_cloud: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "render_cloud: " << error.what() << "\n";
    return 1;
  }
}
