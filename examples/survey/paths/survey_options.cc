#include "examples/survey/paths/survey_options.h"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;

constexpr std::array<std::pair<SurveyPath, const char*>, 7> kPathNames = {
    {{SurveyPath::kStrips, "strips"},
     {SurveyPath::kRandom, "random"},
     {SurveyPath::kSwim, "swim"},
     {SurveyPath::kCircle, "circle"},
     {SurveyPath::kStatue, "statue"},
     {SurveyPath::kWall, "wall"},
     {SurveyPath::kDescent, "descent"}}};

bool IsFisheyeSurvey(const SurveyOptions& options) {
  return options.camera_model == CameraModel::kOpenCVFisheye;
}

bool EndsByItself(SurveyPath path) {
  return path == SurveyPath::kCircle || path == SurveyPath::kStatue || path == SurveyPath::kDescent;
}

bool IsLawnMower(SurveyPath path) {
  return path == SurveyPath::kStrips || path == SurveyPath::kRandom;
}

}  // namespace

SurveyPath ParseSurveyPath(const std::string& name) {
  std::string names;
  for (const auto& [path, known] : kPathNames) {
    if (name == known) return path;
    names += (names.empty() ? "" : ", ") + std::string(known);
  }
  throw UsageError("--path is " + name + ", must be one of " + names);
}

CameraModel ParseSurveyCameraModel(const std::string& name) {
  if (name == "OPENCV") return CameraModel::kOpenCV;
  if (name == "OPENCV_FISHEYE") return CameraModel::kOpenCVFisheye;
  throw UsageError("--camera_model is " + name + ", must be OPENCV or OPENCV_FISHEYE");
}

std::string SurveyPathName(SurveyPath path) {
  for (const auto& [known, name] : kPathNames) {
    if (path == known) return name;
  }
  SEAPOINT_CHECK(false);
  return "";
}

PortKind ParsePortKind(const std::string& name) {
  for (const PortKind kind : {PortKind::kNone, PortKind::kFlat, PortKind::kDome}) {
    if (name == PortKindName(kind)) return kind;
  }
  throw UsageError("--port is " + name + ", must be none, flat or dome");
}

std::string PortKindName(PortKind kind) {
  if (kind == PortKind::kFlat) return "flat";
  return kind == PortKind::kDome ? "dome" : "none";
}

std::string CheckSurveyOptions(const SurveyOptions& o) {
  std::ostringstream problem;
  const auto range = [&](const char* name, double value, double min, double max) {
    if (value >= min && value <= max) return;
    problem << "--" << name << " is " << value << ", must be between " << min << " and " << max
            << ". ";
  };
  range("seed", o.seed, 0, 2147483647);
  range("num_strips", o.num_strips, 1, 1000);
  range("images_per_strip", o.images_per_strip, EndsByItself(o.path) ? 0 : 1, 10000);
  range("revisit", o.revisit, 0, IsLawnMower(o.path) ? o.images_per_strip : 0);
  range("width", o.width, 64, 8000);
  range("height", o.height, 64, 8000);
  range("forward_overlap", o.forward_overlap, 0, 0.98);
  range("side_overlap", o.side_overlap, 0, 0.98);
  range("altitude", o.altitude, 1, 10);
  range("pitch", o.pitch_deg, 10, 90);
  range("roll", o.roll_deg, -180, 180);
  range("max_range", o.max_range, 0, 100);
  range("field_of_view", o.field_of_view_deg, 20,
        IsFisheyeSurvey(o) && o.port.kind != PortKind::kFlat ? 150 : 80);
  range("port_thickness", o.port.thickness, 0, 0.03);
  range("port_distance", o.port.distance, 0, 0.2);
  range("port_tilt", o.port.tilt_deg, -10, 10);
  range("port_radius", o.port.radius, 0.04, 0.2);
  // The entrance pupil stays well inside of the dome.
  const double max_off = 0.4 * (o.port.radius - o.port.thickness);
  range("port_decentring", o.port.decentring, -max_off, max_off);
  range("port_sideways", o.port.sideways, -max_off, max_off);
  range("relief", o.relief, 0, 1.5);
  range("turbidity", o.turbidity, 0, 1);
  range("caustics", o.caustics, 0, 1);
  range("marine_snow", o.marine_snow, 0, 1);
  range("noise", o.noise, 0, 10);
  range("jitter", o.jitter, 0, 3);
  range("markers", o.markers, 0, IsLawnMower(o.path) || o.path == SurveyPath::kSwim ? 200 : 0);
  range("marker_size", o.marker_size, 0.01, 1);
  range("marker_bar", o.marker_bar, 2 * o.marker_size, 20);
  if (o.image_format != "jpg" && o.image_format != "png") {
    problem << "--image_format is " << o.image_format << ", must be jpg or png. ";
  }
  return problem.str();
}

bool ShowsOpenWater(const SurveyOptions& options) {
  return !IsLawnMower(options.path) || IsFisheyeSurvey(options) || options.max_range > 0;
}

double MaxRange(const SurveyOptions& options) {
  if (!ShowsOpenWater(options)) return std::numeric_limits<double>::infinity();
  if (options.max_range > 0) return options.max_range;
  return (options.path == SurveyPath::kDescent ? 5 : 3.5) * options.altitude;
}

double NominalFocal(const SurveyOptions& options) {
  const double half_angle = 0.5 * options.field_of_view_deg * kRadPerDeg;
  return 0.5 * options.width / (IsFisheyeSurvey(options) ? half_angle : std::tan(half_angle));
}

double NominalGsd(const SurveyOptions& options) { return options.altitude / NominalFocal(options); }

double BoulderRadius(const SurveyOptions& options) { return 0.42 * options.altitude; }
double BoulderHeight(const SurveyOptions& options) { return 0.36 * options.altitude; }
double StatueHeight(const SurveyOptions& options) { return 0.8 * options.altitude; }
double StatueRadius(const SurveyOptions& options) { return 0.22 * options.altitude; }

}  // namespace colmap_seapoint
