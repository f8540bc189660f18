#include "colmap_seapoint/georeference/scale_measurements.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/georeference/marker_places.h"
#include "colmap_seapoint/georeference/marker_search.h"
#include "colmap_seapoint/georeference/triangulate_target.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/files/scale_csv.h"
#include "colmap_seapoint/io/navigation/nav_log.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNamesInWarning = 5;
// Coordinates beyond this (metres) get an offset, a multiple of kOffsetStep: a float has 7 digits.
constexpr double kMaxCoordinate = 1000;
constexpr double kOffsetStep = 100;
// The origin's latitude and longitude are rounded to this, about a metre.
constexpr double kOriginStepDeg = 1e-5;
// Cameras whose viewing directions add up to less than this share of their number look all round.
constexpr double kMinMeanAxis = 0.5;
constexpr char kPositionsOption[] = "--positions_path";
constexpr char kNavOption[] = "--nav";
constexpr char kNavTimesOption[] = "--nav_times";

Eigen::Vector3d MedianOf(const std::map<std::string, Eigen::Vector3d>& positions) {
  Eigen::Vector3d median;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const auto& [name, position] : positions) values.push_back(position[i]);
    median[i] = UpperMedian(values);
  }
  return median;
}

double Offset(double coordinate) {
  if (std::abs(coordinate) <= kMaxCoordinate) return 0;
  return kOffsetStep * std::round(coordinate / kOffsetStep);
}

GeoPosition Geo(const Eigen::Vector3d& position) {
  return {position.x(), position.y(), position.z()};
}

bool IsSamePlace(const std::optional<GeoPosition>& a, const std::optional<GeoPosition>& b) {
  if (!a || !b) return !a && !b;
  return a->latitude_deg == b->latitude_deg && a->longitude_deg == b->longitude_deg &&
         a->altitude_m == b->altitude_m;
}

bool IsSameFrame(const ModelUnits& a, const ModelUnits& b) {
  return a.is_metric == b.is_metric && a.frame == b.frame && a.crs == b.crs &&
         IsSamePlace(a.origin, b.origin) && a.offset == b.offset;
}

// Turns the table's positions into metres, and describes their frame in `units`. Offset and origin
// come from the whole table, so that all models of a dive share them; or from `former`, where it is
// of the same kind.
void ToFrame(const std::string& crs, const FormerScale* former, PicturePositions* table,
             ModelUnits* units) {
  units->crs = crs;
  const auto has_former = [&] {
    return former != nullptr && former->units.frame == units->frame && former->units.crs == crs;
  };
  if (table->is_geographic && crs.empty()) {
    const Eigen::Vector3d median = MedianOf(table->positions);
    units->frame = "east-north-up";
    units->origin =
        GeoPosition{kOriginStepDeg * std::round(median.x() / kOriginStepDeg),
                    kOriginStepDeg * std::round(median.y() / kOriginStepDeg), Offset(median.z())};
    if (has_former() && former->units.origin) units->origin = former->units.origin;
    for (auto& [name, position] : table->positions) {
      position = LocalEastNorthUp(Geo(position), *units->origin);
    }
    return;
  }
  units->frame = crs.empty() ? "local" : "projected";
  if (!crs.empty()) {
    const MapProjection projection(crs);  // even where it converts nothing, it checks the name
    for (auto& [name, position] : table->positions) {
      if (table->is_geographic) position = projection.FromGeographic(Geo(position));
    }
  }
  const Eigen::Vector3d median = MedianOf(table->positions);
  for (int i = 0; i < 3; ++i) units->offset[i] = Offset(median[i]);
  if (has_former()) units->offset = former->units.offset;
  for (auto& [name, position] : table->positions) position -= units->offset;
}

void WarnOfUnknown(const std::string& path, const std::vector<std::string>& names,
                   const std::string& what) {
  if (names.empty()) return;
  std::string line = path + ": " + std::to_string(names.size()) + " " + what + ":";
  for (size_t i = 0; i < std::min(names.size(), kNamesInWarning); ++i) line += " " + names[i];
  LogWarning(line + (names.size() > kNamesInWarning ? " ..." : ""));
}

std::map<std::string, const PosedImage*> ImagesByName(const SparseModel& model) {
  std::map<std::string, const PosedImage*> images;
  for (const PosedImage& image : model.images) images[image.name] = &image;
  return images;
}

// Adds the positions of the model's pictures; returns the names of the others.
std::vector<std::string> AddPositions(const SparseModel& model, MeasuredPositions positions,
                                      const FormerScale* former, ScaleMeasurements* result) {
  PicturePositions& table = positions.table;
  ToFrame(positions.crs, former, &table, &result->units);
  const auto images = ImagesByName(model);
  std::vector<std::string> unknown;
  for (const auto& [name, position] : table.positions) {
    const auto image = images.find(name);
    if (image == images.end()) {
      unknown.push_back(name);
      continue;
    }
    PositionMeasurement measurement;
    measurement.in_model = image->second->cam_from_world.OriginInSource();
    measurement.metres = position;
    if (!table.sigmas.empty()) measurement.sigma = table.sigmas.at(name);
    result->problem.positions.push_back(measurement);
    result->position_names.push_back(name);
  }
  if (!result->position_names.empty()) return unknown;
  throw Error(positions.from, "none of its pictures is in the model",
              "write the names as the model has them, e.g. " +
                  (model.images.empty() ? std::string("img1.jpg") : model.images[0].name));
}

void AddPositionTable(const SparseModel& model, const ScaleSources& sources,
                      const FormerScale* former, ScaleMeasurements* result) {
  const std::string& path = sources.positions_path;
  const auto unknown = AddPositions(
      model, {ReadPositionsCsv(path, kPositionsOption), path, sources.crs}, former, result);
  WarnOfUnknown(path, unknown, "of its pictures are not in the model");
}

// `of_table`: the pictures that a table names.
void CheckNames(const std::string& path, const std::set<std::string>& of_table,
                const std::vector<std::string>& names) {
  std::vector<std::string> unknown;
  const std::set<std::string> known(names.begin(), names.end());
  for (const std::string& name : of_table) {
    if (known.count(name) == 0) unknown.push_back(name);
  }
  if (unknown.size() == of_table.size() && !names.empty()) {
    throw Error(path, "none of the pictures that it names is there, e.g. " + unknown.front(),
                "write the names as they are in the folder, e.g. " + names.front());
  }
  WarnOfUnknown(path, unknown, "of its pictures are not there");
}

using Targets = std::map<std::string, TriangulatedTarget>;

TargetView ViewOf(const SparseModel& model, const PosedImage& image, const TargetMark& mark) {
  const Camera& camera = model.cameras.at(image.camera_id);
  if (!camera.InImage(mark.pixel)) {
    throw Error(mark.where,
                "the mark lies outside " + image.name + ", which has " +
                    std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                    " pixels in the model",
                "write pixels of pictures in the model's size, x to the right and y down");
  }
  return {&camera, image.cam_from_world, mark.pixel};
}

TargetSummary Summarise(const std::string& name, const TriangulatedTarget& target) {
  TargetSummary summary{name, target.problem, target.is_used.size(), 0, 0};
  double square = 0;
  for (size_t i = 0; i < target.is_used.size(); ++i) {
    if (!target.is_used[i]) continue;
    ++summary.num_used;
    square += target.errors[i] * target.errors[i];
  }
  if (summary.num_used > 0) {
    summary.rms_pixels = std::sqrt(square / static_cast<double>(summary.num_used));
  }
  return summary;
}

Targets TriangulateTargets(const SparseModel& model, const ScaleSources& sources,
                           ScaleMeasurements* result) {
  Targets targets;
  if (sources.targets_path.empty()) return targets;
  const auto images = ImagesByName(model);
  std::map<std::string, std::vector<TargetView>> views;
  std::vector<std::string> unknown;
  for (const TargetMark& mark : ReadTargetsCsv(sources.targets_path)) {
    auto& of_target = views[mark.target];
    const auto image = images.find(mark.image);
    if (image == images.end()) {
      unknown.push_back(mark.target + " in " + mark.image);
      continue;
    }
    of_target.push_back(ViewOf(model, *image->second, mark));
  }
  WarnOfUnknown(sources.targets_path, unknown,
                "of its marks are in pictures that the model has not");
  for (const auto& [name, of_target] : views) {
    targets[name] = TriangulateTarget(of_target, sources.max_target_error);
    result->targets.push_back(Summarise(name, targets[name]));
    const TargetSummary& summary = result->targets.back();
    if (summary.problem.empty() && summary.num_used < summary.num_marks) {
      LogWarning("target " + name + ": " + std::to_string(summary.num_marks - summary.num_used) +
                 " of its " + std::to_string(summary.num_marks) +
                 " marks disagree and are not used");
    }
  }
  return targets;
}

using Markers = std::map<MarkerName, MarkerPlace>;

MarkerCounts CountsOf(const Markers& markers) {
  MarkerCounts counts;
  for (const auto& [name, place] : markers) {
    if (place.num_seen > 0) counts[name] = place.num_seen;
  }
  return counts;
}

// The bars' coded markers take their places among the targets; marks in a table come first.
void AddMarkers(const std::vector<ScaleBar>& bars, const Markers& markers, Targets* targets,
                ScaleMeasurements* result) {
  for (const ScaleBar& bar : bars) {
    for (const ScaleBarEnd& end : bar.ends) {
      const auto name = ParseMarkerName(end.name).name;
      if (!name || targets->count(end.name) > 0) continue;
      const auto found = markers.find(*name);
      MarkerPlace place;
      place.problem = "is found in no picture; found: " + MostFound(CountsOf(markers));
      if (found != markers.end()) place = found->second;
      TriangulatedTarget& target = (*targets)[end.name];
      target.problem = place.problem;
      target.xyz = place.xyz;
      target.covariance = place.covariance;
      result->targets.push_back(
          {end.name, place.problem, place.num_seen, place.num_used, place.rms_pixels});
    }
  }
}

// Where the end of a bar lies in the model.
struct Place {
  std::string problem;  // why it has no place; empty: it has one
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // model units squared
};

// Throws Error when the end names nothing that there is.
Place PlaceOf(const SparseModel& model, const ScaleSources& sources, const ScaleBar& bar,
              const ScaleBarEnd& end, const Targets& targets) {
  if (end.point3D_id) {
    const auto point = model.points3D.find(*end.point3D_id);
    if (point != model.points3D.end()) return {"", point->second.xyz, Eigen::Matrix3d::Zero()};
    throw Error(bar.where, "the model has no 3D point " + std::to_string(*end.point3D_id),
                "give the id of a point of this very model");
  }
  const auto target = targets.find(end.name);
  if (target == targets.end()) {
    throw Error(bar.where, "'" + end.name + "' is no target",
                sources.targets_path.empty()
                    ? "give --targets_path, or write a coded marker (tag36h11:12) or point:ID for "
                      "a 3D point "
                      "of the model"
                    : "mark it in " + sources.targets_path +
                          ", or write point:ID for a 3D point of the model");
  }
  const TriangulatedTarget& found = target->second;
  if (found.problem.empty()) return {"", found.xyz, found.covariance};
  Place nowhere;
  nowhere.problem = "target " + end.name + " " + found.problem;
  return nowhere;
}

// Why the length between two places cannot be used; "" when it can.
std::string Fault(const Place& a, const Place& b) {
  if (!b.problem.empty()) return b.problem;
  if (!a.problem.empty()) return a.problem;
  return (b.xyz - a.xyz).norm() > 0 ? "" : "its two ends coincide in the model";
}

LengthMeasurement LengthBetween(const Place& a, const Place& b) {
  const Eigen::Vector3d between = b.xyz - a.xyz, along = between.normalized();
  LengthMeasurement length;
  length.in_model = between.norm();
  length.in_model_sigma = std::sqrt(along.dot((a.covariance + b.covariance) * along));
  return length;
}

void AddBars(const SparseModel& model, const ScaleSources& sources, const Markers& markers,
             ScaleMeasurements* result, RunReport* report) {
  if (sources.scale_bars_path.empty()) return;
  const std::vector<ScaleBar> bars = ReadScaleBarsCsv(sources.scale_bars_path);
  Targets targets = TriangulateTargets(model, sources, result);
  AddMarkers(bars, markers, &targets, result);
  for (const ScaleBar& bar : bars) {
    const std::string name = bar.ends[0].name + " - " + bar.ends[1].name;
    const Place a = PlaceOf(model, sources, bar, bar.ends[0], targets);
    const Place b = PlaceOf(model, sources, bar, bar.ends[1], targets);
    const std::string fault = Fault(a, b);
    if (!fault.empty()) {
      LeaveOut("scale bar " + name, fault, report);
      continue;
    }
    LengthMeasurement length = LengthBetween(a, b);
    length.metres = bar.metres;
    length.sigma = bar.sigma.value_or(sources.length_sigma);
    result->problem.lengths.push_back(length);
    result->length_names.push_back(name);
  }
}

// Every marker that has a place is as long as its side.
void AddMarkerSides(const ScaleSources& sources, const Markers& markers,
                    ScaleMeasurements* result) {
  if (sources.marker_size <= 0) return;
  const auto families = ParseMarkerFamilies(sources.marker_families);
  for (const auto& [name, place] : markers) {
    const bool is_of_them =
        families && std::count(families->begin(), families->end(), name.family) > 0;
    if (!is_of_them || !place.problem.empty()) continue;
    LengthMeasurement length;
    length.in_model = place.side;
    length.in_model_sigma = place.side_sigma;
    length.metres = sources.marker_size;
    length.sigma = sources.length_sigma;
    result->problem.lengths.push_back(length);
    result->length_names.push_back("side of " + MarkerText(name));
  }
}

// The mapper poses the two cameras of a rig one by one: their distance is the median over all
// frames, as certain as these agree.
void AddRig(const SparseModel& model, const ScaleSources& sources, const StereoRig& rig,
            ScaleMeasurements* result) {
  if (sources.rig_spacing <= 0) return;
  std::vector<double> spacings;
  for (size_t i = 0; i < rig.right_of.size(); ++i) {
    if (rig.right_of[i] < 0) continue;
    const auto right = static_cast<size_t>(rig.right_of[i]);
    spacings.push_back((model.images[i].cam_from_world.OriginInSource() -
                        model.images[right].cam_from_world.OriginInSource())
                           .norm());
  }
  if (spacings.empty()) {
    throw Error("--rig_spacing", "the model holds no two pictures that a rig took at once",
                "give --rig LEFT,RIGHT and --image_path, or a model with frames");
  }
  const double median = UpperMedian(spacings);
  std::vector<double> deviations;
  for (const double spacing : spacings) deviations.push_back(std::abs(spacing - median));
  LengthMeasurement length;
  length.in_model = median;
  length.in_model_sigma =
      1.2533 * 1.4826 * UpperMedian(deviations) / std::sqrt(static_cast<double>(spacings.size()));
  length.metres = sources.rig_spacing;
  length.sigma = sources.length_sigma;
  result->problem.lengths.push_back(length);
  result->length_names.push_back("rig (" + std::to_string(spacings.size()) + " frames)");
}

Eigen::Vector3d MeanViewingDirection(const SparseModel& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PosedImage& image : model.images) {
    sum += image.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  }
  const double num_images = static_cast<double>(model.images.size());
  if (sum.norm() < kMinMeanAxis * num_images) return Eigen::Vector3d::Zero();
  return sum.normalized();
}

}  // namespace

void CheckScaleTables(const ScaleSources& sources) {
  MarkersOfBars(sources);
  if (!sources.targets_path.empty()) ReadTargetsCsv(sources.targets_path);
  if (!sources.nav.empty()) ReadNavLogs(sources.nav, kNavOption);
  if (!sources.nav_times.empty()) ReadPictureTimes(sources.nav_times, kNavTimesOption);
  if (!sources.crs.empty()) MapProjection check(sources.crs);
  if (sources.HasPositionTable()) {
    PicturePositions table = ReadPositionsCsv(sources.positions_path, kPositionsOption);
    ModelUnits units;
    ToFrame(sources.crs, nullptr, &table, &units);
  }
}

void CheckScaleNames(const ScaleSources& sources, const std::vector<std::string>& names) {
  if (sources.HasPositionTable()) {
    std::set<std::string> of_table;
    for (const auto& [name, position] :
         ReadPositionsCsv(sources.positions_path, kPositionsOption).positions) {
      of_table.insert(name);
    }
    CheckNames(sources.positions_path, of_table, names);
  }
  if (!sources.targets_path.empty()) {
    std::set<std::string> of_table;
    for (const TargetMark& mark : ReadTargetsCsv(sources.targets_path)) of_table.insert(mark.image);
    CheckNames(sources.targets_path, of_table, names);
  }
  if (!sources.nav_times.empty()) {
    std::set<std::string> of_table;
    for (const PictureTime& time : ReadPictureTimes(sources.nav_times, kNavTimesOption)) {
      of_table.insert(time.image);
    }
    CheckNames(sources.nav_times, of_table, names);
  }
}

ScaleMeasurements GatherMeasurements(const SparseModel& model, const ScaleSources& sources,
                                     const std::vector<MarkerSighting>& sightings,
                                     const StereoRig& rig, int seed, RunReport* report,
                                     const MeasuredPositions* measured, const FormerScale* former) {
  ScaleMeasurements result;
  result.units.is_metric = true;
  result.problem.seed = seed;
  result.problem.down_in_model = MeanViewingDirection(model);
  if (sources.HasPositionTable()) AddPositionTable(model, sources, former, &result);
  if (measured != nullptr) AddPositions(model, *measured, former, &result);
  if (former != nullptr && IsSameFrame(former->units, result.units)) {
    result.problem.former = former->metric_from_model;
  }
  const Markers markers = PlaceMarkers(model, sightings, sources.max_target_error);
  AddBars(model, sources, markers, &result, report);
  AddMarkerSides(sources, markers, &result);
  AddRig(model, sources, rig, &result);
  if (!result.problem.positions.empty() || !result.problem.lengths.empty()) return result;
  if (sources.scale_bars_path.empty()) {
    throw Error("--marker_size",
                "no marker has a place in the model; found: " + MostFound(CountsOf(markers)),
                "see that two of its pictures show one whole, and that --marker_families is right");
  }
  throw Error(sources.scale_bars_path,
              "no bar has two ends in the model: " + (report->left_out.empty()
                                                          ? std::string("none is given")
                                                          : report->left_out.back().reason),
              "see that two of its pictures at least show each end of a bar, or mark them there");
}

}  // namespace colmap_seapoint
