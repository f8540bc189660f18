#include "examples/survey/paths/survey_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/paths/survey_camera.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadPerDeg = kPi / 180;
constexpr double kRevisitAltitude = 0.93;
constexpr double kRevisitHeadingDeg = 35;
// Of an object that is circled, a picture sees this well: forward_overlap is a share of it.
constexpr double kRingDeg = 80;
constexpr double kDescentFrom = 3;  // of the altitude

// Camera axes in the ground's frame for a vehicle that heads along `heading_rad` and looks down.
Eigen::Quaterniond GroundFromLevelCam(double heading_rad) {
  const Eigen::Vector3d forward(std::cos(heading_rad), std::sin(heading_rad), 0);
  Eigen::Matrix3d axes;
  axes.col(1) = -forward;  // image rows run backwards
  axes.col(2) = -Eigen::Vector3d::UnitZ();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return Eigen::Quaterniond(axes);
}

// Where a picture is planned to be taken, in the ground's frame.
struct Station {
  double x = 0, y = 0;         // metres
  double altitude_factor = 1;  // of options.altitude
  double heading = 0;          // radians
  double pitch = 0.5 * kPi;    // below the horizon, radians
};

// Steps of the track, metres: along it and to the next strip.
struct Steps {
  double forward, side;
};

Steps TrackSteps(const SurveyOptions& options) {
  const double gsd = NominalGsd(options);
  const bool sideways = options.path == SurveyPath::kWall || options.path == SurveyPath::kCircle ||
                        options.path == SurveyPath::kStatue;
  const int along = sideways ? options.width : options.height;
  const int across = sideways ? options.height : options.width;
  return {gsd * along * (1 - options.forward_overlap), gsd * across * (1 - options.side_overlap)};
}

void AddTrack(const SurveyOptions& options, int strip, std::vector<Station>* stations) {
  const Steps steps = TrackSteps(options);
  const bool outbound = strip % 2 == 0;
  for (int station = 0; station < options.images_per_strip; ++station) {
    const int along = outbound ? station : options.images_per_strip - 1 - station;
    Station place{along * steps.forward, strip * steps.side, 1, outbound ? 0 : kPi};
    if (options.path == SurveyPath::kSwim) place.pitch = options.pitch_deg * kRadPerDeg;
    if (options.path == SurveyPath::kWall) place.heading = 0.5 * kPi;
    stations->push_back(place);
  }
}

struct Ring {
  double radius, height;  // of the track, metres
  double target;          // height on the axis that the camera looks at, metres
};

Ring RingOf(const SurveyOptions& options, int strip) {
  const double rise = (strip + 0.5) / options.num_strips;  // 0 ... 1 from the lowest to the highest
  if (options.path == SurveyPath::kStatue) {
    const double height = StatueHeight(options) * (0.25 + 0.75 * rise);
    return {StatueRadius(options) + options.altitude, height,
            0.5 * (height + 0.5 * StatueHeight(options))};
  }
  return {BoulderRadius(options) + 0.9 * options.altitude, (0.5 + 0.5 * rise) * options.altitude,
          0.4 * BoulderHeight(options)};
}

void AddRing(const SurveyOptions& options, int strip, std::vector<Station>* stations) {
  const Ring ring = RingOf(options, strip);
  const double step = kRingDeg * kRadPerDeg * (1 - options.forward_overlap);
  const int count = options.images_per_strip > 0
                        ? options.images_per_strip
                        : static_cast<int>(std::ceil(2 * kPi / step - 1e-9));
  for (int station = 0; station < count; ++station) {
    // The rings' pictures do not stand one above the other.
    const double angle = 2 * kPi * (station + 0.5 * (strip % 2)) / count;
    stations->push_back({ring.radius * std::cos(angle), ring.radius * std::sin(angle),
                         ring.height / options.altitude, angle + kPi,
                         std::atan2(ring.height - ring.target, ring.radius)});
  }
}

void AddDive(const SurveyOptions& options, int strip, std::vector<Station>* stations) {
  const double way = std::log(kDescentFrom);
  const double steps = way / -std::log(std::max(options.forward_overlap, 0.1));
  const int count = options.images_per_strip > 0 ? options.images_per_strip
                                                 : static_cast<int>(std::ceil(steps - 1e-9)) + 1;
  for (int station = 0; station < count; ++station) {
    const double left = count > 1 ? 1 - station / (count - 1.0) : 0;
    stations->push_back({0, strip * TrackSteps(options).side, std::exp(way * left), 0});
  }
}

std::vector<Station> PlanStations(const SurveyOptions& options) {
  std::vector<Station> stations;
  for (int strip = 0; strip < options.num_strips; ++strip) {
    switch (options.path) {
      case SurveyPath::kCircle:
      case SurveyPath::kStatue:
        AddRing(options, strip, &stations);
        break;
      case SurveyPath::kDescent:
        AddDive(options, strip, &stations);
        break;
      default:
        AddTrack(options, strip, &stations);
    }
  }
  const double forward_step = TrackSteps(options).forward;
  for (int station = 0; station < options.revisit; ++station) {
    stations.push_back(
        {(station + 0.5) * forward_step, 0, kRevisitAltitude, kRevisitHeadingDeg * kRadPerDeg});
  }
  return stations;
}

Eigen::Quaterniond Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
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
  Eigen::Quaterniond tilt =
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(3), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(1.5 * kRadPerDeg * bell(4), Eigen::Vector3d::UnitY());
  const double up = 0.5 * kPi - station.pitch;
  if (up > 0) {  // the heading turns about the vertical: an oblique camera rolls by itself
    tilt = Turn(up, Eigen::Vector3d::UnitX()) * tilt *
           Turn(2 * kRadPerDeg * bell(6), Eigen::Vector3d::UnitZ());
  }
  if (options.roll_deg != 0 && number % 2 == 1) {
    tilt = tilt * Turn(options.roll_deg * kRadPerDeg, Eigen::Vector3d::UnitZ());
  }
  const double heading = station.heading + 2.5 * kRadPerDeg * bell(5);
  Rigid3d cam_from_ground;
  cam_from_ground.rotation = (GroundFromLevelCam(heading) * tilt).conjugate().normalized();
  cam_from_ground.translation = -(cam_from_ground.rotation * centre);
  return cam_from_ground;
}

// Place of every picture among the names.
std::vector<size_t> NameOrder(const SurveyOptions& options, size_t count) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  if (options.path != SurveyPath::kRandom) return order;
  const auto key = [&](size_t i) {
    return Hash(static_cast<uint64_t>(options.seed), 7103, static_cast<int64_t>(i));
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
  return order;
}

Rectangle Union(const Rectangle& a, const Rectangle& b) {
  return {std::min(a.min_x, b.min_x), std::min(a.min_y, b.min_y), std::max(a.max_x, b.max_x),
          std::max(a.max_y, b.max_y)};
}

// Where a ray meets the level `lowest`, or the end of its reach.
Eigen::Vector3d GroundPlace(const Eigen::Vector3d& centre, const Eigen::Vector3d& direction,
                            double lowest, double reach) {
  const double flat = direction.head<2>().norm();
  double t = reach / std::max(flat, 1e-12);
  if (direction.z() < 0) t = std::min(t, (lowest - centre.z()) / direction.z());
  return centre + direction * t;
}

}  // namespace

Rigid3d WorldFromGround(const SurveyOptions& options) {
  Rigid3d world_from_ground;
  if (options.path == SurveyPath::kWall) {
    world_from_ground.rotation = Turn(0.5 * kPi, Eigen::Vector3d::UnitX());
  }
  return world_from_ground;
}

SparseModel PlanSurvey(const SurveyOptions& options) {
  SparseModel model;
  model.cameras[1] = MakeSurveyCamera(options);
  const std::vector<Station> stations = PlanStations(options);
  const std::vector<size_t> order = NameOrder(options, stations.size());
  for (size_t number : order) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(model.images.size() + 1);
    image.camera_id = 1;
    char name[64];
    std::snprintf(name, sizeof(name), "seabed_%04u.%s", image.image_id,
                  options.image_format.c_str());
    image.name = name;
    image.cam_from_world = UnsteadyPose(options, stations[number], static_cast<int64_t>(number));
    if (options.path == SurveyPath::kWall) {
      image.cam_from_world = image.cam_from_world * WorldFromGround(options).Inverse();
    }
    model.images.push_back(std::move(image));
  }
  return model;
}

Rectangle Footprint(const PortCamera& camera, const Rigid3d& cam_from_ground, double lowest,
                    double reach) {
  const Rigid3d ground_from_cam = cam_from_ground.Inverse();
  const Eigen::Vector3d centre = ground_from_cam.translation;
  Rectangle box{centre.x(), centre.y(), centre.x(), centre.y()};
  constexpr int kSteps = 8;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const auto ray = camera.Ray({camera.InWater().width * double(i) / kSteps,
                                   camera.InWater().height * double(j) / kSteps});
      if (!ray) continue;  // a black corner
      const Eigen::Vector3d direction = ground_from_cam.rotation * ray->direction;
      const Eigen::Vector3d ground =
          GroundPlace(ground_from_cam * ray->origin, direction, lowest, reach);
      box = Union(box, {ground.x(), ground.y(), ground.x(), ground.y()});
    }
  }
  return box;
}

Rectangle SurveyArea(const SurveyOptions& options, const SparseModel& model, double lowest) {
  const Rigid3d world_from_ground = WorldFromGround(options);
  const double reach = kFadeOut * MaxRange(options);
  const PortCamera camera(options.port, model.cameras.at(1));
  Rectangle box{};
  for (size_t i = 0; i < model.images.size(); ++i) {
    Rigid3d pose = model.images[i].cam_from_world;
    if (options.path == SurveyPath::kWall) pose = pose * world_from_ground;
    const Rectangle seen = Footprint(camera, pose, lowest, reach);
    box = i == 0 ? seen : Union(box, seen);
  }
  if (options.path == SurveyPath::kCircle || options.path == SurveyPath::kStatue) {
    // A plateau around what is looked at, as far as the track and a little more.
    const double half = RingOf(options, 0).radius + 0.8 * options.altitude;
    box = {std::max(box.min_x, -half), std::max(box.min_y, -half), std::min(box.max_x, half),
           std::min(box.max_y, half)};
  }
  return box;
}

}  // namespace colmap_seapoint
