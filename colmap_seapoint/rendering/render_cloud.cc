#include "colmap_seapoint/rendering/render_cloud.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/compare/point_index.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/rendering/camera_picture.h"
#include "colmap_seapoint/rendering/legend.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Beyond the bounds of 98 % of the points, in their extent.
constexpr double kMarginOfView = 0.1;

void Validate(const CloudRendererOptions& options) {
  CheckOutputPaths(options);
  if (options.model_path.empty() && !options.image_name.empty()) {
    throw UsageError("--image_name: needs --model_path, which has that picture");
  }
  if (options.model_path.empty() && options.max_range > 0) {
    throw UsageError("--max_range: needs --model_path, whose cameras it is measured from");
  }
  if (fs::exists(options.output_path)) {
    throw Error(options.output_path, "is there already",
                "remove it, or give another --output_path");
  }
  CheckWritableDir(FolderOf(options.output_path));
}

std::string UnitOf(const fs::path& cloud_path) {
  const auto units = ReadModelUnits(fs::absolute(cloud_path).parent_path());
  return units && units->is_metric ? "m" : "units";
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
ColorImage RenderFromAbove(const std::vector<CloudPoint>& cloud, const PointVector& centers,
                           int width, const std::string& unit) {
  PointVector points;
  Eigen::Vector3d up = Eigen::Vector3d::Zero(), center = Eigen::Vector3d::Zero();
  for (const CloudPoint& point : cloud) {
    points.push_back(point.xyz.cast<double>());
    center += points.back() / static_cast<double>(cloud.size());
    if (centers.empty()) up += point.normal.cast<double>();
  }
  for (const Eigen::Vector3d& camera : centers) up += camera - center;
  PlanView view = FitPlanView(points, {}, up);
  TrimPlanView(points, kMarginOfView, &view);
  const double relief = std::max(view.high[2] - view.low[2], 1e-9);
  const int max_height = 3 * width / 2;
  PlanPicture colors(view, width, max_height), heights(view, width, max_height);
  for (size_t i = 0; i < cloud.size(); ++i) {
    colors.Add(points[i], cloud[i].rgb);
    heights.Add(points[i], RampColor((view.FromWorld(points[i])[2] - view.low[2]) / relief));
  }
  ColorImage above = colors.Picture();
  DrawScaleBar(colors.PixelsAUnit(), unit, &above);
  return StackPictures(StackPictures(above, heights.Picture()),
                       RampLegend(width, 0, relief, unit + " high"));
}

const PosedImage& FindImage(const SparseModel& model, const CloudRendererOptions& options) {
  for (const PosedImage& image : model.images) {
    if (image.name == options.image_name) return image;
  }
  throw Error(options.model_path, "has no picture " + options.image_name,
              "choose one of its names");
}

// Distances fill the ramp by their logarithm, between the nearest and the farthest hundredth.
ColorImage RenderFromCamera(const std::vector<CloudPoint>& cloud, const Camera& camera,
                            const Rigid3d& cam_from_world, int point_size,
                            const std::string& unit) {
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
  // Red is near: the legend runs from far to near.
  return StackPictures(StackPictures(colors.Picture(), distances.Picture()),
                       RampLegend(camera.width, std::exp(high), std::exp(low), unit + " away"));
}

std::vector<CloudPoint> PointsToShow(const CloudRendererOptions& options,
                                     const SparseModel& model) {
  std::vector<CloudPoint> cloud = ReadCloud(options.input_path);
  if (options.max_range > 0) cloud = WithinRange(cloud, CentersOf(model), options.max_range);
  if (cloud.empty()) throw Error(options.input_path, "has no points to show", "choose another one");
  return cloud;
}

}  // namespace

void CloudRendererOptions::Bind(OptionTable* table) {
  table->AddRequired("input_path", &input_path, "cloud, PLY");
  table->AddRequired("output_path", &output_path, "picture, PNG or JPEG; must not be there yet");
  table->Add("model_path", &model_path,
             "COLMAP model of the cloud: up is where its cameras are; empty = where the normals "
             "point to",
             "ours");
  table->Add("image_name", &image_name,
             "the cloud as this picture of the model saw it; empty = from above", "ours");
  table->Add("max_range", &max_range,
             "points farther than this from the nearest camera of the model are not shown, units "
             "of the cloud; 0 = no limit",
             "ours", 0, 1e9);
  table->Add("point_size", &point_size, "pixels of a point, with image_name", "ours", 1, 100);
  table->Add("width", &width, "pixels of the picture, from above", "ours", 16, 10000);
  run.Bind(table);
  table->MarkOutput("output_path");
}

CommandResult RunCloudRenderer(const CloudRendererOptions& options) {
  Validate(options);
  SparseModel model;
  if (!options.model_path.empty()) {
    model = ReadSparseModel(options.model_path, ModelContent::kPosesAndPoints);
  }
  const std::vector<CloudPoint> cloud = PointsToShow(options, model);
  const std::string unit = UnitOf(options.input_path);
  if (options.image_name.empty()) {
    WriteImage(options.output_path, RenderFromAbove(cloud, CentersOf(model), options.width, unit));
  } else {
    const PosedImage& image = FindImage(model, options);
    WriteImage(options.output_path,
               RenderFromCamera(cloud, model.cameras.at(image.camera_id), image.cam_from_world,
                                options.point_size, unit));
  }
  LogInfo("picture of " + std::to_string(cloud.size()) + " points: " + options.output_path);
  return {};
}

}  // namespace colmap_seapoint
