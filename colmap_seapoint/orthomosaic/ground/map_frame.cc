#include "colmap_seapoint/orthomosaic/ground/map_frame.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kWallCosine = 0.5;   // of the angle between a wall's normal and up
constexpr double kAgreeing = 0.7;     // length of the mean of unit vectors that agree
constexpr double kMinThinness = 0.3;  // of a plane: its thickness over its smaller extent
constexpr int kPlaneRounds = 10;
constexpr int kMedianTrials = 300;
constexpr size_t kMedianPoints = 1000;
constexpr double kOutlierFactor = 3.5;                     // times the median distance
constexpr double kRadians = 3.14159265358979323846 / 180;  // a degree

struct Plane {
  Eigen::Vector3d center, normal;
  double thinness = 1;
};

Plane PlaneThrough(const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& xyz : points) mean += xyz;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& xyz : points) scatter += (xyz - mean) * (xyz - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(0);
  return {mean, solver.eigenvectors().col(0), values[1] > 0 ? std::sqrt(values[0] / values[1]) : 1};
}

std::vector<double> DistancesTo(const Plane& plane, const Points& points) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const Eigen::Vector3d& xyz : points) {
    distances.push_back(std::abs(plane.normal.dot(xyz - plane.center)));
  }
  return distances;
}

// The plane through three points, of many threes, that half of all points are nearest to: least
// median of squares. What the other half does is all the same.
Plane PlaneOfMost(const Points& sample) {
  Points few;
  for (size_t i = 0; i < sample.size(); i += sample.size() / kMedianPoints + 1) {
    few.push_back(sample[i]);
  }
  Plane best = PlaneThrough(few);
  double least = UpperMedian(DistancesTo(best, few));
  std::mt19937_64 random(1);  // its numbers are the standard's own: the same everywhere
  for (int i = 0; i < kMedianTrials; ++i) {
    const Points three = {few[random() % few.size()], few[random() % few.size()],
                          few[random() % few.size()]};
    const Plane plane = PlaneThrough(three);
    if (plane.thinness == 1) continue;  // three points of one line
    const double median = UpperMedian(DistancesTo(plane, few));
    if (median >= least) continue;
    least = median;
    best = plane;
  }
  return best;
}

// Points that are far from the plane of most do not tilt it; all others do.
Plane RobustPlane(const Points& sample) {
  Plane plane = PlaneOfMost(sample);
  for (int round = 0; round < kPlaneRounds; ++round) {
    const std::vector<double> distances = DistancesTo(plane, sample);
    const double limit = kOutlierFactor * UpperMedian(distances);
    Points near;
    for (size_t i = 0; i < sample.size(); ++i) {
      if (distances[i] <= limit) near.push_back(sample[i]);
    }
    if (near.size() < 3) break;
    plane = PlaneThrough(near);
  }
  return plane;
}

bool KnowsUp(const std::optional<ModelUnits>& units) {
  return units && units->is_metric && units->frame != "model";
}
bool KnowsNorth(const std::optional<ModelUnits>& units) {
  return KnowsUp(units) && units->frame != "local";
}

// The normal or its opposite: towards the side that most cameras are on.
Eigen::Vector3d TowardsCameras(const SparseModel& model, const Plane& plane) {
  int sides = 0;
  for (const PosedImage& image : model.images) {
    const Eigen::Vector3d offset = image.cam_from_world.OriginInSource() - plane.center;
    sides += plane.normal.dot(offset) < 0 ? -1 : 1;
  }
  return sides < 0 ? Eigen::Vector3d(-plane.normal) : plane.normal;
}

// The mean of what is up in the pictures, as far as it lies in the plane.
Eigen::Vector3d UprightInPlane(const SparseModel& model, const Eigen::Vector3d& normal) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PosedImage& image : model.images) {
    const Eigen::Vector3d up =
        image.cam_from_world.rotation.conjugate() * -Eigen::Vector3d::UnitY();
    const Eigen::Vector3d in_plane = up - up.dot(normal) * normal;
    if (in_plane.norm() > 1e-6) sum += in_plane.normalized();
  }
  return sum / std::max<double>(1, static_cast<double>(model.images.size()));
}

// All but a hundredth of the sample at either end.
double ExtentAlong(const Points& sample, const Eigen::Vector3d& direction) {
  std::vector<double> places;
  places.reserve(sample.size());
  for (const Eigen::Vector3d& xyz : sample) places.push_back(direction.dot(xyz));
  const auto skip = static_cast<std::ptrdiff_t>(places.size() / 100);
  std::nth_element(places.begin(), places.begin() + skip, places.end());
  const double low = places[static_cast<size_t>(skip)];
  std::nth_element(places.begin(), places.end() - 1 - skip, places.end());
  return places[places.size() - 1 - static_cast<size_t>(skip)] - low;
}

// The longer side of the smallest rectangle in the plane that holds the sample.
Eigen::Vector3d LongestSide(const Points& sample, const Eigen::Vector3d& normal) {
  Points few;
  for (size_t i = 0; i < sample.size(); i += sample.size() / kMedianPoints + 1) {
    few.push_back(sample[i]);
  }
  const Eigen::Vector3d first = normal.unitOrthogonal();
  Eigen::Vector3d longest = first;
  double least = std::numeric_limits<double>::infinity();
  for (int degree = 0; degree < 90; ++degree) {
    const Eigen::Vector3d side = Eigen::AngleAxisd(degree * kRadians, normal) * first;
    const Eigen::Vector3d other = normal.cross(side);
    const double a = ExtentAlong(few, side), b = ExtentAlong(few, other);
    if (a * b >= least) continue;
    least = a * b;
    longest = a >= b ? side : other;
  }
  return longest;
}

// Rotation with rows right, up, normal.
Eigen::Matrix3d AxesOf(const Eigen::Vector3d& normal, const Eigen::Vector3d& up) {
  const Eigen::Vector3d in_plane = up - up.dot(normal) * normal;
  if (!(in_plane.norm() > 1e-6 * up.norm())) {
    throw Error("the map's directions", "what points up on the map points to the eye too",
                "give --up across --plane");
  }
  Eigen::Matrix3d axes;
  axes.row(1) = in_plane.normalized();
  axes.row(2) = normal;
  axes.row(0) = axes.row(1).cross(axes.row(2));
  return axes;
}

Eigen::Vector3d UnitDirection(const Eigen::Vector3d& direction) {
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw Error("the map's directions", "a direction of no length was given",
                "give three numbers that are not all 0");
  }
  return direction.normalized();
}

PlaneKind KindOf(const MapFrameOptions& options, const Plane& plane, bool knows_up) {
  if (options.towards_eye) return PlaneKind::kGiven;
  if (options.plane == MapPlane::kModel) return PlaneKind::kLevel;
  const bool is_wall =
      knows_up && plane.thinness < kMinThinness && std::abs(plane.normal.z()) < kWallCosine;
  if (is_wall) return PlaneKind::kWall;
  return knows_up && options.plane == MapPlane::kAuto ? PlaneKind::kLevel : PlaneKind::kFitted;
}

struct MapUp {
  Eigen::Vector3d direction;
  std::string text;
};

MapUp FindUp(const MapFrameOptions& options, const SparseModel& model, const Points& sample,
             const Eigen::Vector3d& normal, PlaneKind kind, bool knows_north) {
  if (options.up) return {UnitDirection(*options.up), "up as given"};
  if (kind == PlaneKind::kWall) return {Eigen::Vector3d::UnitZ(), "up is up"};
  if (kind == PlaneKind::kLevel) {
    return {Eigen::Vector3d::UnitY(), knows_north ? "north is up" : "y of the model is up"};
  }
  const Eigen::Vector3d upright = UprightInPlane(model, normal);
  if (upright.norm() > kAgreeing)
    return {upright, "turned as the pictures are, north is not known"};
  return {normal.cross(LongestSide(sample, normal)),
          "its longer side to the right, north is not known"};
}

std::string PlaneText(PlaneKind kind) {
  switch (kind) {
    case PlaneKind::kLevel:
      return "seen from above";
    case PlaneKind::kFitted:
      return "seen across the best plane of the cloud, from the cameras' side";
    case PlaneKind::kWall:
      return "a wall, seen across its own plane from the cameras' side";
    case PlaneKind::kGiven:
      break;
  }
  return "seen from the given direction";
}

}  // namespace

MapFrame FindMapFrame(const MapFrameOptions& options, const SparseModel& model,
                      const Points& sample, const std::optional<ModelUnits>& units) {
  SEAPOINT_CHECK(!sample.empty());
  const Plane plane = RobustPlane(sample);
  MapFrame frame;
  frame.kind = KindOf(options, plane, KnowsUp(units));
  Eigen::Vector3d normal = TowardsCameras(model, plane);
  if (frame.kind == PlaneKind::kGiven) normal = UnitDirection(*options.towards_eye);
  if (frame.kind == PlaneKind::kLevel) normal = Eigen::Vector3d::UnitZ();
  const MapUp up = FindUp(options, model, sample, normal, frame.kind, KnowsNorth(units));
  frame.is_north_up = frame.kind == PlaneKind::kLevel && KnowsNorth(units) && !options.up;
  frame.text = PlaneText(frame.kind) + "; " + up.text;
  if (frame.kind == PlaneKind::kLevel && !options.up) return frame;  // exactly the model's own
  const Eigen::Matrix3d axes = AxesOf(normal, up.direction);
  frame.map_from_cloud.rotation = Eigen::Quaterniond(axes);
  if (frame.kind != PlaneKind::kLevel) {
    frame.map_from_cloud.translation = -(frame.map_from_cloud.rotation * plane.center);
  }
  return frame;
}

}  // namespace colmap_seapoint
