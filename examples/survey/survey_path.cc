#include "examples/survey/survey_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadPerDeg = kPi / 180;
constexpr double kRevisitAltitude = 0.93;
constexpr double kRevisitHeadingDeg = 35;

double Focal(const SurveyOptions& options) {
  return 0.5 * options.width / std::tan(0.5 * options.field_of_view_deg * kRadPerDeg);
}

Camera MakeSurveyCamera(const SurveyOptions& options) {
  Camera camera = MakeCamera(CameraModel::kOpenCV, Focal(options), options.width, options.height);
  camera.camera_id = 1;
  camera.params[1] *= 1.0015;
  camera.params[2] += 0.0046 * options.width;
  camera.params[3] -= 0.0040 * options.height;
  camera.params[4] = -0.11;
  camera.params[5] = 0.045;
  camera.params[6] = 4e-4;
  camera.params[7] = -3e-4;
  return camera;
}

// Camera axes in the world for a vehicle that heads along `heading_rad` and looks down.
Eigen::Quaterniond WorldFromLevelCam(double heading_rad) {
  const Eigen::Vector3d forward(std::cos(heading_rad), std::sin(heading_rad), 0);
  Eigen::Matrix3d axes;
  axes.col(1) = -forward;  // image rows run backwards
  axes.col(2) = -Eigen::Vector3d::UnitZ();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return Eigen::Quaterniond(axes);
}

// The place and heading at which a picture is planned to be taken.
struct Station {
  double x = 0, y = 0;         // metres
  double altitude_factor = 1;  // of options.altitude
  double heading = 0;          // radians
};

Station StripStation(const SurveyOptions& options, int strip, int station, double forward_step,
                     double side_step) {
  const bool outbound = strip % 2 == 0;
  const int along = outbound ? station : options.images_per_strip - 1 - station;
  return {along * forward_step, strip * side_step, 1, outbound ? 0 : kPi};
}

Station RevisitStation(int station, double forward_step) {
  return {(station + 0.5) * forward_step, 0, kRevisitAltitude, kRevisitHeadingDeg * kRadPerDeg};
}

// `number`: of the picture, in the order in which they are taken.
Rigid3d UnsteadyPose(const SurveyOptions& options, const Station& station, int64_t number) {
  const auto bell = [&](int k) {
    return options.jitter * Bell(Hash(Hash(static_cast<uint64_t>(options.seed), 7001), number, k));
  };
  const double swell =
      0.03 * options.jitter * std::sin(0.55 * static_cast<double>(number) + options.seed);
  const Eigen::Vector3d centre(station.x + 0.02 * bell(0), station.y + 0.02 * bell(1),
                               0.05 * options.relief + options.altitude * station.altitude_factor *
                                                           (1 + swell + 0.008 * bell(2)));
  const Eigen::Quaterniond tilt =
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(3), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(4), Eigen::Vector3d::UnitY());
  const double heading = station.heading + 2.5 * kRadPerDeg * bell(5);
  Rigid3d cam_from_world;
  cam_from_world.rotation = (WorldFromLevelCam(heading) * tilt).conjugate().normalized();
  cam_from_world.translation = -(cam_from_world.rotation * centre);
  return cam_from_world;
}

}  // namespace

std::string CheckSurveyOptions(const SurveyOptions& o) {
  std::ostringstream problem;
  const auto range = [&](const char* name, double value, double min, double max) {
    if (value >= min && value <= max) return;
    problem << "--" << name << " is " << value << ", must be between " << min << " and " << max
            << ". ";
  };
  range("seed", o.seed, 0, 2147483647);
  range("num_strips", o.num_strips, 1, 1000);
  range("images_per_strip", o.images_per_strip, 1, 10000);
  range("revisit", o.revisit, 0, o.images_per_strip);
  range("width", o.width, 64, 8000);
  range("height", o.height, 64, 8000);
  range("forward_overlap", o.forward_overlap, 0, 0.98);
  range("side_overlap", o.side_overlap, 0, 0.98);
  range("altitude", o.altitude, 1, 10);
  range("field_of_view", o.field_of_view_deg, 20, 80);
  range("relief", o.relief, 0, 1.5);
  range("turbidity", o.turbidity, 0, 1);
  range("caustics", o.caustics, 0, 1);
  range("marine_snow", o.marine_snow, 0, 1);
  range("noise", o.noise, 0, 10);
  range("jitter", o.jitter, 0, 3);
  if (o.image_format != "jpg" && o.image_format != "png") {
    problem << "--image_format is " << o.image_format << ", must be jpg or png. ";
  }
  return problem.str();
}

double NominalGsd(const SurveyOptions& options) { return options.altitude / Focal(options); }

SparseModel PlanSurvey(const SurveyOptions& options) {
  SparseModel model;
  model.cameras[1] = MakeSurveyCamera(options);
  const double gsd = NominalGsd(options);
  const double forward_step = gsd * options.height * (1 - options.forward_overlap);
  const double side_step = gsd * options.width * (1 - options.side_overlap);
  const auto add = [&](const Station& station) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(model.images.size() + 1);
    image.camera_id = 1;
    char name[64];
    std::snprintf(name, sizeof(name), "seabed_%04u.%s", image.image_id,
                  options.image_format.c_str());
    image.name = name;
    image.cam_from_world =
        UnsteadyPose(options, station, static_cast<int64_t>(model.images.size()));
    model.images.push_back(std::move(image));
  };
  for (int strip = 0; strip < options.num_strips; ++strip) {
    for (int station = 0; station < options.images_per_strip; ++station) {
      add(StripStation(options, strip, station, forward_step, side_step));
    }
  }
  for (int station = 0; station < options.revisit; ++station) {
    add(RevisitStation(station, forward_step));
  }
  return model;
}

Rectangle Footprint(const Camera& camera, const Rigid3d& cam_from_world, double lowest) {
  const Rigid3d world_from_cam = cam_from_world.Inverse();
  const Eigen::Vector3d centre = world_from_cam.translation;
  Rectangle box{centre.x(), centre.y(), centre.x(), centre.y()};
  constexpr int kSteps = 8;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const auto ray = camera.CamFromImg(
          {camera.width * double(i) / kSteps, camera.height * double(j) / kSteps});
      SEAPOINT_CHECK(ray.has_value());
      const Eigen::Vector3d direction = world_from_cam.rotation * ray->homogeneous();
      SEAPOINT_CHECK(direction.z() < 0);
      const Eigen::Vector3d ground = centre + direction * ((lowest - centre.z()) / direction.z());
      box = Union(box, {ground.x(), ground.y(), ground.x(), ground.y()});
    }
  }
  return box;
}

Rectangle Union(const Rectangle& a, const Rectangle& b) {
  return {std::min(a.min_x, b.min_x), std::min(a.min_y, b.min_y), std::max(a.max_x, b.max_x),
          std::max(a.max_y, b.max_y)};
}

}  // namespace colmap_seapoint
