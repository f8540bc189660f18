#include "colmap_seapoint/pipeline/completeness.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/gaps/answer_line.h"
#include "colmap_seapoint/gaps/completeness_json.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/gaps/gap_kml.h"
#include "colmap_seapoint/gaps/gap_map.h"
#include "colmap_seapoint/gaps/route_files.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/cloud/seen_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/gis/area_geojson.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/pictures/picture_scale.h"
#include "colmap_seapoint/pipeline/page/completeness_page.h"
#include "colmap_seapoint/workspace/output_paths.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

void Validate(const CompletenessReporterOptions& options) {
  CheckOutputPaths(options);
  if (!options.image_path.empty() && !fs::is_directory(options.image_path)) {
    throw Error(options.image_path, "there is no such folder", "check --image_path");
  }
}

SparseModel ReadModel(const CompletenessReporterOptions& options) {
  SparseModel model = ReadSparseModel(options.input_path, ModelContent::kPosesAndPoints);
  if (model.images.empty()) {
    throw Error(options.input_path, "the model holds no pictures",
                "give a model of COLMAP's mapper");
  }
  if (!options.image_path.empty()) {
    ScaleCamerasToPictures(options.image_path, options.run.num_threads, &model);
  }
  return model;
}

AskedArea ReadArea(const CompletenessReporterOptions& options, const ModelUnits& units) {
  if (options.area.empty()) return {};
  AskedArea area = AreaInPlan(units, ReadAreaGeoJson(options.area, "--area"));
  for (const Ring& ring : area.rings) {
    if (!CrossesItself(ring)) continue;
    throw Error("--area " + options.area, "a polygon crosses itself",
                "mend it (in QGIS: Fix geometries)");
  }
  return area;
}

// The plan that orthomosaics are drawn on, but turned about the world's own origin; the world
// itself where its z points up within 20 degrees. An asked area is drawn from above.
PlanFrame FindPlan(const CompletenessReporterOptions& options, const SparseModel& model,
                   const std::optional<ModelUnits>& units,
                   const std::vector<Eigen::Vector3d>& sample) {
  constexpr double kNearUp = 0.94;
  MapFrameOptions map;
  const bool knows_up = units && units->is_metric && units->frame != "model";
  if (!options.area.empty() && knows_up) map.plane = MapPlane::kModel;
  PlanFrame plan;
  const Eigen::Matrix3d rotation =
      FindMapFrame(map, model, sample, units).map_from_cloud.rotation.toRotationMatrix();
  if (rotation(2, 2) > kNearUp) return plan;
  if (!options.area.empty()) {
    throw Error("--area " + options.area,
                "the model's z does not point up from its ground, so that its x and y are no map",
                "bring the model into metres first (model_scaler with positions), or leave --area");
  }
  plan.map_from_world = rotation;
  return plan;
}

// Names of pictures below image_path that are in no model.
std::vector<std::string> LostPictures(const CompletenessReporterOptions& options,
                                      const SparseModel& model) {
  if (options.image_path.empty()) return {};
  std::set<std::string> registered(options.posed_elsewhere.begin(), options.posed_elsewhere.end());
  for (const PosedImage& image : model.images) registered.insert(image.name);
  std::vector<std::string> lost;
  for (const std::string& name : ListImages(options.image_path)) {
    if (IsSafeImageName(name) && registered.count(name) == 0) lost.push_back(name);
  }
  return lost;
}

// What the page shows beside the result: some points of the cloud, and how bright pictures are.
struct Seen {
  std::vector<ColoredPoint> points;
  std::vector<double> brightness;  // by image_idx; -1: unknown
};

PictureFacts ReadFacts(const CompletenessReporterOptions& options, const PictureMasks& masks,
                       const std::string& name, double* brightness) {
  const GrayImage luma = ReadGrayImage(fs::path(options.image_path) / name);
  const uint64_t sum = std::accumulate(luma.data.begin(), luma.data.end(), uint64_t{0});
  *brightness = static_cast<double>(sum) / static_cast<double>(luma.data.size());
  return MeasurePicture(luma, masks.Decode(name, masks.Open(name), luma.width, luma.height));
}

// A step a picture that is looked at, and as many each time that the cloud is read.
class AssessmentProgress {
 public:
  AssessmentProgress(size_t num_pictures, uint64_t num_points, int num_readings)
      : num_pictures_(static_cast<double>(num_pictures)),
        num_points_(static_cast<double>(num_points)),
        progress_("Looking for what is missing, steps",
                  static_cast<int64_t>(1 + num_readings) * static_cast<int64_t>(num_pictures), 0,
                  Work::kCompleteness) {}

  void LookedAtPictures(int64_t num) { progress_.Update(num); }
  void BeginCloud() { ++num_readings_; }
  void ReadPoints(uint64_t num) {
    progress_.Update(static_cast<int64_t>(
        num_pictures_ * (num_readings_ + static_cast<double>(num) / num_points_)));
  }
  void Finish() { progress_.Finish(); }

 private:
  double num_pictures_, num_points_;
  int num_readings_ = 0;
  Progress progress_;
};

// By image_idx. A picture that cannot be read is named, and counts as a bad one.
std::vector<PictureFacts> MeasurePictures(const CompletenessReporterOptions& options,
                                          const SparseModel& model, AssessmentProgress* progress,
                                          Seen* seen, RunReport* report) {
  std::vector<PictureFacts> facts(model.images.size());
  seen->brightness.assign(facts.size(), -1);
  if (options.image_path.empty()) return facts;
  const PictureMasks masks(options.mask_path);
  std::vector<std::string> problems(model.images.size());
  std::mutex mutex;
  int64_t num_done = 0;
  ParallelFor(options.run.num_threads, static_cast<int64_t>(facts.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    try {
      facts[i] = ReadFacts(options, masks, model.images[i].name, &seen->brightness[i]);
    } catch (const Error& e) {
      problems[i] = e.Finding();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress->LookedAtPictures(++num_done);
  });
  for (size_t i = 0; i < problems.size(); ++i) {
    if (problems[i].empty()) continue;
    LeaveOut(model.images[i].name, problems[i], report);
    facts[i].is_bad = true;
  }
  if (std::none_of(facts.begin(), facts.end(), [](const auto& f) { return !f.Empty(); })) {
    throw Error(options.image_path,
                "none of the model's pictures can be read (" + model.images[0].name + ": " +
                    problems[0] + ")",
                "give the --image_path that the model was made from, or none");
  }
  JudgePictures(&facts);
  return facts;
}

// Of the first reading some points are kept.
class PointReading {
 public:
  PointReading(uint64_t num_points, AssessmentProgress* progress, Seen* seen)
      : chooser_(num_points, kPagePoints), progress_(progress), seen_(seen) {
    is_first_ = seen->points.empty();
    progress->BeginCloud();
  }
  void Read(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb) {
    constexpr uint64_t kPointsOfUpdate = 100000;
    if (is_first_ && chooser_.Takes(num_read_)) seen_->points.push_back({xyz, rgb});
    if (++num_read_ % kPointsOfUpdate == 0) progress_->ReadPoints(num_read_);
  }
  void Finish() { progress_->ReadPoints(num_read_); }

 private:
  PointChooser chooser_;
  AssessmentProgress* progress_;
  Seen* seen_;
  bool is_first_ = false;
  uint64_t num_read_ = 0;
};

void ReadPoints(const CompletenessReporterOptions& options, AssessmentProgress* progress,
                const std::function<void(const ConfidentPoint&)>& take, Seen* seen) {
  CloudReader reader(options.cloud_path);
  PointReading reading(reader.NumPoints(), progress, seen);
  if (options.completeness.self_check) {
    ReadSeenCloud(options.cloud_path, [&](const CloudPoint& p, uint32_t first, uint32_t second) {
      const Eigen::Vector3d xyz = p.xyz.cast<double>();
      take({{xyz, p.normal.cast<double>()}, p.confidence, {first, second}});
      reading.Read(xyz, p.rgb);
    });
  } else {
    CloudVertex vertex;
    while (reader.Next(&vertex)) {
      take({{vertex.xyz, vertex.normal.cast<double>()}, vertex.confidence, {}});
      reading.Read(vertex.xyz, vertex.rgb);
    }
  }
  reading.Finish();
}

void CheckResult(const CompletenessReporterOptions& options, const CompletenessResult& result) {
  if (result.belonging_share < kMinBelonging) {
    throw Error(
        options.cloud_path,
        "only " + std::to_string(std::lround(100 * result.belonging_share)) +
            " % of the cloud lie in any picture of " + options.input_path,
        "give the cloud that was made from this model (of a scaled model, the scaled cloud)");
  }
  if (result.is_area_too_large) {
    throw Error("--area " + options.area, "is too large to be kept in memory at this spacing",
                "check its coordinates; ask for less, or raise --Completeness.spacing");
  }
  const double unseen = result.missing_area[static_cast<size_t>(GapCause::kNeverImaged)];
  if (!options.area.empty() && unseen >= (1 - 1e-9) * result.expected_area) {
    throw Error("--area " + options.area, "no picture shows anything of it",
                "check its coordinates: longitude and latitude where the model is georeferenced, "
                "else the model's x and y");
  }
}

CompletenessResult Assess(const CompletenessReporterOptions& options, const SparseModel& model,
                          const std::optional<ModelUnits>& units, Seen* seen, RunReport* report) {
  CompletenessInput input;
  input.model = &model;
  input.num_points = CloudReader(options.cloud_path).NumPoints();
  if (input.num_points == 0) {
    throw Error(options.cloud_path, "the cloud holds no points", "check --cloud_path");
  }
  report->points = static_cast<int64_t>(input.num_points);
  AssessmentProgress progress(model.images.size(), input.num_points,
                              NumReadings(options.completeness));
  input.for_each_point = [&](const auto& take) { ReadPoints(options, &progress, take, seen); };
  input.asked = ReadArea(options, units.value_or(ModelUnits()));
  input.frame_of = [&](const auto& sample) { return FindPlan(options, model, units, sample); };
  input.lost = LostPictures(options, model);
  input.posed_elsewhere = options.posed_elsewhere;
  FormerReport former = ReadFormerReport(fs::path(options.output_path) / "completeness.json");
  input.former = std::move(former.gaps);
  input.last_id = former.last_id;
  input.facts = MeasurePictures(options, model, &progress, seen, report);
  CompletenessResult result =
      AssessCompleteness(input, options.completeness, options.run.num_threads);
  progress.Finish();
  CheckResult(options, result);
  return result;
}

// Of the layers with gaps, but for the top, which is always drawn.
std::set<LayerKey> LayersWithGaps(const CompletenessResult& result) {
  std::set<LayerKey> layers;
  for (const Gap& gap : result.gaps) layers.insert(gap.region.layer);
  layers.erase({Side::kTop, 0});
  return layers;
}

std::string MapName(const LayerKey& layer) {
  std::string name = "map_" + LayerName(layer) + ".png";
  std::replace(name.begin(), name.end(), ':', '_');
  return name;
}

// Where the model is georeferenced; else those of an earlier run go, as does a route without gaps.
void WriteGeographic(const CompletenessResult& result, const GapPlaces& places,
                     OutputFolder* folder) {
  const auto write = [&](const std::string& name, bool is_wanted, const auto& text) {
    if (is_wanted) {
      folder->Claim({name});
      WriteTextFile(folder->Path() / name, text(result, places));
    } else if (folder->IsOurs(name)) {
      folder->Remove(name);
    }
  };
  const bool has_route = places.IsGeographic() && !result.route.empty();
  write("gaps.kml", places.IsGeographic(), GapsKml);
  write("route.plan", has_route, RoutePlan);
  write("route.waypoints", has_route, RouteWaypoints);
  write("route.cmp", has_route, RouteCockpitMission);
}

// Of layers that an earlier run has found gaps in.
void RemoveFormerMaps(OutputFolder* folder) {
  for (const fs::path& file : FilesOfOurs(folder->Path())) {
    const std::string name = file.filename().string();
    if (name.rfind("map_", 0) == 0) folder->Remove(name);
  }
}

void WriteMaps(const CompletenessResult& result, const std::string& unit, OutputFolder* folder) {
  RemoveFormerMaps(folder);
  const ColorImage map = DrawGapMap(result, {Side::kTop, 0}, unit);
  if (!map.Empty()) WriteImage(folder->Path() / "map.png", map);
  for (const LayerKey& layer : LayersWithGaps(result)) {
    folder->Claim({MapName(layer)});
    WriteImage(folder->Path() / MapName(layer), DrawGapMap(result, layer, unit));
  }
}

}  // namespace

void CompletenessReporterOptions::Bind(OptionTable* table) {
  table->AddRequired("input_path", &input_path, "COLMAP model, binary or text");
  table->AddRequired("cloud_path", &cloud_path, "cloud in the model's frame, PLY");
  table->AddRequired(
      "output_path", &output_path,
      "folder for index.html, completeness.json, gaps.geojson, gaps.csv, maps and run.json");
  table->Add("image_path", &image_path,
             "folder of the pictures, also of those that are in no model; empty = nothing is known "
             "of texture, blur and lost pictures",
             "ours");
  table->Add("mask_path", &mask_path,
             "folder of masks <image name>.png, 0 where nothing was asked for; empty = none",
             "COLMAP (there StereoFusion.mask_path)");
  table->Add("area", &area,
             "GeoJSON with the polygons that were to be covered, in WGS84 where the model is "
             "georeferenced, else in its x and y; empty = all that pictures outline",
             "ours");
  table->Add(
      "map_path", &map_path,
      "folder that orthomosaic wrote, for the page's map; empty = the page has none under it",
      "ours");
  completeness.Bind(table);
  table->Add("self_check", &completeness.self_check,
             "hide a quarter of the pictures four times, and measure on what they showed how wrong "
             "the missing area is said; asks for <cloud_path>.vis",
             "ours");
  run.Bind(table);
  table->MarkOutput("output_path");
}

CompletenessReport ReportCompleteness(const CompletenessReporterOptions& options) {
  Validate(options);
  CompletenessReport done;
  RunReport& report = done.run = StartReport("completeness_reporter", options, options.run);
  OutputFolder folder(options.output_path, "--output_path");
  folder.Claim(
      {"index.html", "completeness.json", "gaps.geojson", "gaps.csv", "map.png", "run.json"});
  {
    const StageTimer timer(&report, "completeness_reporter");
    const std::optional<ModelUnits> units = ReadModelUnits(options.input_path);
    report.units = UnitsWord(units);
    const SparseModel model = ReadModel(options);
    report.images_in = static_cast<int64_t>(model.images.size());
    Seen seen;
    const CompletenessResult result = Assess(options, model, units, &seen, &report);
    report.images_used = report.images_in - static_cast<int64_t>(report.left_out.size());
    const GapPlaces places(units.value_or(ModelUnits()), result.ground.frame);
    const fs::path& output = folder.Path();
    WriteTextFile(output / "gaps.geojson", GapsGeoJson(result, model, places));
    WriteTextFile(output / "gaps.csv", GapsCsv(result, model, places));
    WriteGeographic(result, places, &folder);
    WriteMaps(result, places.Unit(), &folder);
    WriteTextFile(output / "completeness.json", CompletenessJson(result, model, places));
    done.answer = CompletenessLine(result, model, places);
    WriteTextFile(output / "index.html",
                  CompletenessPage({model, result, places, done.answer, options.image_path,
                                    options.cloud_path, options.map_path, std::move(seen.points),
                                    std::move(seen.brightness), options.run.num_threads}));
  }
  WriteRunReport(folder.Path() / "run.json", report);
  return done;
}

CommandResult RunCompletenessReporter(const CompletenessReporterOptions& options) {
  const CompletenessReport done = ReportCompleteness(options);
  CommandResult command = ResultOf(done.run);
  command.text = done.answer + "\n";
  return command;
}

}  // namespace colmap_seapoint
