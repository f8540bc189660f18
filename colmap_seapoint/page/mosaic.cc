#include "colmap_seapoint/page/mosaic.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct MapGeometry {
  Eigen::Matrix3d rotation;  // map from world
  Eigen::Vector3d translation;
  double left = 0, top = 0;      // of the map, in its own frame
  double width = 0, height = 0;  // units

  Eigen::Vector3d WorldOf(double x, double y, double height_on_map) const {
    return rotation.transpose() * (Eigen::Vector3d(x, y, height_on_map) - translation);
  }
};

MapGeometry GeometryOf(const Json& json) {
  MapGeometry map;
  for (int i = 0; i < 3; ++i) {
    const Json& row = json.at("map_from_model").at(static_cast<size_t>(i));
    for (int k = 0; k < 3; ++k) map.rotation(i, k) = row.at(static_cast<size_t>(k)).get<double>();
    map.translation[i] = row.at(3).get<double>();
  }
  const Json& offset = json.at("offset");
  map.left = json.at("min_x").get<double>() - offset.at(0).get<double>();
  map.top = json.at("max_y").get<double>() - offset.at(1).get<double>();
  const double pixel = json.at("pixel_size").get<double>();
  map.width = pixel * json.at("width").get<double>();
  map.height = pixel * json.at("height").get<double>();
  return map;
}

ColorImage Smaller(const ColorImage& picture, int max_side) {
  const double factor =
      std::min(1.0, static_cast<double>(max_side) / std::max(picture.width, picture.height));
  const auto side = [&](int pixels) { return std::max(1, static_cast<int>(factor * pixels)); };
  ColorImage small(side(picture.width), side(picture.height), 3);
  const cv::Mat from(picture.height, picture.width, CV_8UC3,
                     const_cast<uint8_t*>(picture.data.data()));
  cv::Mat to(small.height, small.width, CV_8UC3, small.data.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return small;
}

}  // namespace

std::optional<Mosaic> ReadMosaic(const fs::path& folder, const PlanFrame& plan,
                                 const Eigen::Vector3d& middle, int max_side) {
  const fs::path description = folder / "map.json", preview = folder / "orthomosaic.jpg";
  const auto in = OpenIfThere(description);
  if (in == nullptr || !fs::exists(preview)) return std::nullopt;
  MapGeometry map;
  try {
    map = GeometryOf(Json::parse(std::string{std::istreambuf_iterator<char>(*in), {}}));
  } catch (const Json::exception& e) {
    throw Error(description.string(), "is no map of ours (" + std::string(e.what()) + ")",
                "give the folder that orthomosaic wrote, or leave --map_path");
  }
  Mosaic mosaic;
  mosaic.picture = Smaller(ReadColorImage(preview), max_side);
  const double height = (map.rotation * middle + map.translation).z();
  const auto on_plan = [&](double x, double y) -> Eigen::Vector2d {
    return (plan.map_from_world * map.WorldOf(x, y, height)).head<2>();
  };
  const Eigen::Vector2d corner = on_plan(map.left, map.top);
  mosaic.plan_from_pixel.col(0) =
      (on_plan(map.left + map.width, map.top) - corner) / mosaic.picture.width;
  mosaic.plan_from_pixel.col(1) =
      (on_plan(map.left, map.top - map.height) - corner) / mosaic.picture.height;
  mosaic.plan_from_pixel.col(2) = corner;
  return mosaic;
}

}  // namespace colmap_seapoint
