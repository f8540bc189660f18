#include "colmap_seapoint/pipeline/completeness/completeness_reporter.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/gaps/answer_line.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/cloud/seen_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/gis/area_geojson.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/pictures/picture_scale.h"
#include "colmap_seapoint/pipeline/completeness/measure_pictures.h"
#include "colmap_seapoint/pipeline/completeness/write_gap_files.h"
#include "colmap_seapoint/pipeline/page/completeness_page.h"
#include "colmap_seapoint/workspace/output_paths.h"
#include "densify/completeness/assess_completeness.h"
#include "densify/self_check/check_by_hiding.h"
#include "densify/self_check/hidden_pictures.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

void Validate(const CompletenessReporterOptions& options) {
  CheckOutputPaths(options);
  if (!options.image_path.empty() && !fs::is_directory(options.image_path)) {
    throw Error(options.image_path, "there is no such folder", "check --image_path");
  }
  if (options.self_check && !fs::exists(options.cloud_path + ".vis")) {
    throw Error(options.cloud_path + ".vis", "is not there, so that no picture can be hidden",
                "give a cloud of partial_densifier, or leave --self_check");
  }
}

SparseModel ReadModel(const CompletenessReporterOptions& options) {
  SparseModel model = ReadSparseModel(options.input_path, ModelContent::kPosesAndPoints);
  if (model.images.empty()) {
    throw Error(options.input_path, "the model holds no pictures",
                "give a model of COLMAP's mapper");
  }
  if (options.self_check && model.images.size() < kMinPicturesToHide) {
    throw Error(options.input_path, "holds too few pictures to hide some of them",
                "leave --self_check");
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

constexpr int kNumReadings = 2;  // of the cloud (CompletenessInput)

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

// By image_idx.
std::vector<PictureFacts> FactsOf(const CompletenessReporterOptions& options,
                                  const SparseModel& model, AssessmentProgress* progress,
                                  Seen* seen, RunReport* report) {
  seen->brightness.assign(model.images.size(), -1);
  if (options.image_path.empty()) return std::vector<PictureFacts>(model.images.size());
  PictureMeasures measures = MeasurePictures(
      model, {options.image_path, options.mask_path, options.facts_file}, options.run.num_threads,
      [&](int64_t num_done) { progress->LookedAtPictures(num_done); }, report);
  seen->brightness = std::move(measures.brightness);
  return std::move(measures.facts);
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

// With the pictures that each point is from, which only a self check asks for.
void ReadPoints(const CompletenessReporterOptions& options, size_t num_pictures,
                AssessmentProgress* progress,
                const std::function<void(const ConfidentPoint&)>& take, Seen* seen) {
  CloudReader reader(options.cloud_path);
  PointReading reading(reader.NumPoints(), progress, seen);
  if (options.self_check) {
    ReadSeenCloud(options.cloud_path, [&](const CloudPoint& p, uint32_t first, uint32_t second) {
      if (std::max(first, second) >= num_pictures) {
        throw Error(options.cloud_path + ".vis", "names pictures that the model does not hold",
                    "give the model that the cloud was made from, or leave --self_check");
      }
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

// In the frame of the model.
FormerReport FormerOf(const CompletenessReporterOptions& options, const SparseModel& model) {
  FormerReport former = options.former
                            ? *options.former
                            : ReadFormerReport(fs::path(options.output_path) / kCompletenessFile);
  const size_t num_gaps = former.gaps.size();
  MoveToModel(model, &former);
  if (former.gaps.size() < num_gaps) {
    LogInfo("The model is not the one of the report before: its gaps get new numbers");
  }
  return former;
}

CompletenessResult Assess(const CompletenessReporterOptions& options, const SparseModel& model,
                          const std::optional<ModelUnits>& units, const FormerReport& former,
                          Seen* seen, RunReport* report) {
  CompletenessInput input;
  input.model = &model;
  input.num_points = CloudReader(options.cloud_path).NumPoints();
  if (input.num_points == 0) {
    throw Error(options.cloud_path, "the cloud holds no points", "check --cloud_path");
  }
  report->points = static_cast<int64_t>(input.num_points);
  AssessmentProgress progress(model.images.size(), input.num_points,
                              kNumReadings + (options.self_check ? kNumFolds : 0));
  input.for_each_point = [&](const auto& take) {
    ReadPoints(options, model.images.size(), &progress, take, seen);
  };
  input.asked = ReadArea(options, units.value_or(ModelUnits()));
  input.frame_of = [&](const auto& sample) { return FindPlan(options, model, units, sample); };
  input.lost = LostPictures(options, model);
  input.posed_elsewhere = options.posed_elsewhere;
  input.former = former.gaps;
  input.last_id = former.last_id;
  input.facts = FactsOf(options, model, &progress, seen, report);
  CompletenessResult result =
      AssessCompleteness(input, options.completeness, options.run.num_threads);
  CheckResult(options, result);
  if (options.self_check) {
    CheckByHiding(input, options.completeness, options.run.num_threads, &result);
  }
  progress.Finish();
  return result;
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
  table->Add("self_check", &self_check,
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
      {"index.html", kCompletenessFile, "gaps.geojson", "gaps.csv", "map.png", "run.json"});
  {
    const StageTimer timer(&report, "completeness_reporter");
    const std::optional<ModelUnits> units = ReadModelUnits(options.input_path);
    report.units = UnitsWord(units);
    const SparseModel model = ReadModel(options);
    report.images_in = static_cast<int64_t>(model.images.size());
    Seen seen;
    const FormerReport former = FormerOf(options, model);
    const CompletenessResult result = Assess(options, model, units, former, &seen, &report);
    const std::vector<GapChange> changes = ChangesOf(former, result);
    report.images_used = report.images_in - static_cast<int64_t>(report.left_out.size());
    const GapPlaces places(units.value_or(ModelUnits()), result.ground.frame);
    WriteGapFiles({model, result, places, changes}, &folder);
    done.answer = CompletenessLine(result, model, places, changes);
    WriteTextFile(folder.Path() / "index.html",
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
