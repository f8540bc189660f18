#include "examples/survey/paths/dive_passes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
constexpr double kMaxTiltDeg = 20;
constexpr char kRemedy[] = "give gaps.geojson of completeness_reporter on this survey's own model";

struct Unsteadiness {
  uint64_t seed = 0;
  double jitter = 1;
};

Eigen::Vector3d PlaceOf(const Json& json, const Eigen::Matrix3d& map_from_world) {
  return map_from_world.transpose() * Eigen::Vector3d(json.at(0), json.at(1), json.at(2));
}

Eigen::Matrix3d MatrixOf(const Json& rows) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k)
      matrix(i, k) = rows.at(static_cast<size_t>(i)).at(static_cast<size_t>(k));
  }
  return matrix;
}

// At `place`, looking down, with `ahead` up in the picture; both world.
Rigid3d PoseAt(const Eigen::Vector3d& place, const Eigen::Vector3d& ahead,
               const Eigen::Vector3d& up, const Unsteadiness& unsteady, int64_t number) {
  const auto bell = [&](int k) {
    return unsteady.jitter * Bell(Hash(Hash(unsteady.seed, 7919), number, k));
  };
  Eigen::Matrix3d world_from_cam;
  world_from_cam.col(1) = -(ahead - ahead.dot(up) * up).normalized();
  world_from_cam.col(2) = -up;
  world_from_cam.col(0) = world_from_cam.col(1).cross(world_from_cam.col(2));
  const Eigen::Quaterniond tilt =
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(3), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(4), Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(2.5 * kRadPerDeg * bell(5), Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d drift = 0.02 * Eigen::Vector3d(bell(0), bell(1), bell(2));
  Rigid3d pose;
  pose.rotation = (Eigen::Quaterniond(world_from_cam) * tilt).conjugate().normalized();
  pose.translation = -(pose.rotation * (place + drift));
  return pose;
}

void AddPass(const Json& feature, const Eigen::Matrix3d& map_from_world,
             const std::string& image_format, const Unsteadiness& unsteady, DivePasses* dive) {
  const Json& properties = feature.at("properties");
  if (properties.at("tilt_deg").get<double>() > kMaxTiltDeg) {
    ++dive->num_tilted;
    return;
  }
  const Json& corners = feature.at("geometry").at("coordinates");
  const int num_lines = properties.at("num_lines");
  const int a_line = properties.at("num_pictures").get<int>() / std::max(num_lines, 1);
  if (a_line < 2 || corners.size() != 2 * static_cast<size_t>(num_lines)) {
    throw Error("a pass in gaps.geojson", "has no pictures, or not two corners a line", kRemedy);
  }
  const Eigen::Vector3d up = map_from_world.row(2).transpose();
  int number = 0;
  for (size_t line = 0; line < corners.size(); line += 2) {
    const Eigen::Vector3d from = PlaceOf(corners[line], map_from_world);
    const Eigen::Vector3d to = PlaceOf(corners[line + 1], map_from_world);
    for (int k = 0; k < a_line; ++k) {
      PosedImage image;
      char name[64];
      std::snprintf(name, sizeof(name), "pass_%03d_%03d.%s", properties.at("gap").get<int>(),
                    ++number, image_format.c_str());
      image.name = name;
      image.camera_id = 1;
      image.cam_from_world = PoseAt(from + k / (a_line - 1.0) * (to - from), to - from, up,
                                    unsteady, static_cast<int64_t>(dive->images.size()));
      dive->images.push_back(std::move(image));
    }
  }
}

}  // namespace

DivePasses PlanPasses(const std::filesystem::path& gaps_geojson, const std::string& image_format,
                      int seed, double jitter) {
  std::ifstream in(gaps_geojson);
  DivePasses dive;
  try {
    const Json json = Json::parse(in);
    const Eigen::Matrix3d map_from_world = MatrixOf(json.at("map_from_model"));
    for (const Json& feature : json.at("features")) {
      if (feature.at("properties").at("kind") != "pass") continue;
      AddPass(feature, map_from_world, image_format, {static_cast<uint64_t>(seed), jitter}, &dive);
    }
  } catch (const Json::exception& e) {
    throw Error(gaps_geojson.string(),
                "holds no passes to photograph (" + std::string(e.what()) + ")", kRemedy);
  }
  if (dive.images.empty()) throw Error(gaps_geojson.string(), "holds no pass", kRemedy);
  return dive;
}

}  // namespace colmap_seapoint
