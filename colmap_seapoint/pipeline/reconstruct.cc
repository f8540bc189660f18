#include "colmap_seapoint/pipeline/reconstruct.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/cameras/camera_identity.h"
#include "colmap_seapoint/cameras/exif_focal_length.h"
#include "colmap_seapoint/disk/job_disk.h"
#include "colmap_seapoint/estimate/preflight.h"
#include "colmap_seapoint/georeference/marker_search.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/pictures/duplicates.h"
#include "colmap_seapoint/pictures/exif_positions.h"
#include "colmap_seapoint/pipeline/completeness_models.h"
#include "colmap_seapoint/pipeline/densify_models.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/pipeline/intake/take_in.h"
#include "colmap_seapoint/pipeline/job_size.h"
#include "colmap_seapoint/pipeline/map.h"
#include "colmap_seapoint/pipeline/match.h"
#include "colmap_seapoint/pipeline/orthomosaic_models.h"
#include "colmap_seapoint/pipeline/page/job_page.h"
#include "colmap_seapoint/pipeline/scale_models.h"
#include "colmap_seapoint/pipeline/tie_pictures.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/system/battery.h"
#include "colmap_seapoint/workspace/workspace_database.h"
#include "feature/match_features.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Options = AutomaticReconstructorOptions;

std::vector<std::string> NamesOf(const PictureSet& pictures) {
  std::vector<std::string> names;
  for (const ReadablePicture& picture : pictures.readable) names.push_back(picture.name);
  return names;
}

// All that decides which rows the database holds, the SeaPoints apart.
DatabaseInputs InputsOfDatabase(const Options& options,
                                const std::vector<ReadablePicture>& pictures) {
  DatabaseInputs inputs;
  inputs.options = OptionsFingerprint(OptionValues(options.reader)) +
                   OptionsFingerprint(OptionValues(options.matching));
  for (const ReadablePicture& picture : pictures) {
    const ImageInfo& info = picture.info;
    const auto focal = FocalLengthFromExif(info.camera, info.width, info.height);
    inputs.pictures.push_back(picture.name + " " + std::to_string(info.width) + " " +
                              std::to_string(info.height) + " " +
                              std::to_string(focal ? focal->px : 0) + " " + CameraKey(info.camera));
  }
  return inputs;
}

// The stage that begins the database.
Stage DatabaseStage(const Options& options, const DatabaseInputs& inputs) {
  std::string text = inputs.options;
  text += MatchesAllPairs(options, inputs.pictures.size())
              ? "exhaustive"
              : OptionsFingerprint(OptionValues(options.pairs)) +
                    std::to_string(options.run.random_seed);
  for (const std::string& picture : inputs.pictures) text += "\n" + picture;
  return {"database", kMatchingVersion, text, ""};
}

// Whether a stage is up to date is known when its turn comes; here that its record is there, beside
// a database that is begun with the same pictures and options, is enough.
OfWork<bool> DoneBefore(const Stage& database, const WorkspaceState& state) {
  OfWork<bool> done;
  const auto begun = state.Read(database.name);
  if (!begun || begun->value("fingerprint", "") != StageFingerprint(database)) return done;
  if (!state.Read("mapper")) return done;
  for (const Work work :
       {Work::kPictures, Work::kLookAlikes, Work::kPairs, Work::kRegistration, Work::kRefinement}) {
    done[work] = true;
  }
  done[Work::kDensification] = done[Work::kMaps] = state.Read("dense_0").has_value();
  done[Work::kOrthomosaic] = state.Read("map_0").has_value();
  done[Work::kCompleteness] = state.Read("completeness_0").has_value();
  return done;
}

// The two cameras of a rig may have one body, and one serial number.
Options WithRigsCameras(Options options) {
  int* per_folder = &options.reader.single_camera_per_folder;
  if (!options.rig.empty() && *per_folder < 0) *per_folder = 1;
  return options;
}

// Each once. Throws Error when that leaves a single one.
PictureSet ReadPictures(const Options& options, const Workspace& workspace) {
  PictureSet pictures = ReadPictureSet(ExtractorOptions(options, workspace));
  for (auto& twin :
       LeaveOutDuplicates(workspace.images, options.run.num_threads, &pictures.readable)) {
    pictures.left_out.push_back(std::move(twin));
  }
  if (pictures.readable.size() > 1) return pictures;
  throw Error(options.image_path,
              "holds one picture at most that can be used, " + pictures.readable.front().name,
              "depth takes two pictures at least that show the same place from different points: "
              "add more, which overlap by half or more");
}

// Pictures that are in none of the models are left out.
std::vector<ModelSummary> ReadModels(const std::vector<fs::path>& paths, RunReport* report) {
  std::vector<ModelSummary> models;
  std::set<std::string> known;
  for (const fs::path& path : paths) {
    ModelSummary model;
    model.name = path.filename().string();
    model.path = path;
    for (const PosedImage& image : ReadSparseModel(path, ModelContent::kPosesAndPoints).images) {
      model.pictures.push_back(image.name);
      known.insert(image.name);
    }
    models.push_back(std::move(model));
  }
  report->images_used = static_cast<int64_t>(known.size());
  for (const auto& left_out : report->left_out) known.insert(left_out.name);
  for (const RunReport::Input& input : report->inputs) {
    if (known.count(input.name) > 0) continue;
    LeaveOut(input.name, "is in no model: the mapper could not register it", report);
  }
  return models;
}

// Before the hours of mapping, so that a marker that no picture shows is known by then.
void FindMarkersOfDive(const Options& options, const Workspace& workspace, WorkspaceState* state,
                       RunReport* report) {
  const MarkerSearch search = {FamiliesToFind(options.scale), report->inputs,
                               options.run.num_threads};
  const auto sightings = FindMarkersOnce(search, workspace, state, report);
  for (const std::string& line : MissingMarkers(options.scale, sightings)) LogWarning(line);
}

// Into sparse_scaled/<k>: the mapper's own models stay as they are.
void ScaleModels(const Options& options, const PictureSet& pictures, const Workspace& workspace,
                 const std::string& mapper_fingerprint, WorkspaceState* state,
                 std::vector<ModelSummary>* models, RunReport* report) {
  ModelScalerOptions scaler;
  scaler.image_path = workspace.images.string();
  scaler.rig = options.rig;
  scaler.sources = options.scale;
  if (!FamiliesToFind(options.scale).empty()) scaler.markers_path = workspace.markers.string();
  scaler.run = options.run;
  const PictureRecords records = RecordsFromExif(pictures.readable);
  AddPart(ScaleAllModels(scaler, records, workspace, mapper_fingerprint, state, models), report);
  for (const ModelSummary& model : *models) {
    report->units = report->units.empty() || report->units == model.units_word
                        ? model.units_word
                        : "metres and arbitrary, see summary.txt";
  }
}

// Pictures come in meanwhile where it watches: it waits for room, and does not end.
WhenShort WhenDiskIsShort(const Options& options) {
  if (!options.check_disk) return WhenShort::kWarn;
  return options.watch ? WhenShort::kPause : WhenShort::kStop;
}

CommandResult WriteReport(const Workspace& workspace, const std::vector<ModelSummary>& models,
                          const RunReport& report) {
  const std::string summary = SummaryText(models, report);
  WriteTextFile(workspace.report / "summary.txt", summary);
  WriteRunReport(workspace.report / "run.json", report);
  WriteJobPage(workspace, models, report);
  return {report.left_out.empty(), summary + "report: " + workspace.report.string() + "\n"};
}

}  // namespace

CommandResult RunAutomaticReconstructor(const AutomaticReconstructorOptions& given) {
  given.Check();
  const Options options = WithRigsCameras(given);
  if (options.estimate_only) return EstimateJob(options);
  const BatteryGuard battery(options.pause_on_battery);
  Workspace workspace(options.image_path, options.workspace_path);
  MappingPlan plan = PlanMapping(options, workspace);
  WorkspaceState state(workspace.root, workspace.Names());
  CheckWritableDir(workspace.report);
  RunReport report = StartReport("automatic_reconstructor", options, options.run);
  report.options.insert(report.options.end(), options.mapper.begin(), options.mapper.end());

  JobProgress progress;
  progress.Plan(CostsHere(SizeBeforeIntake(options, workspace.images)), {});
  TakeInPictures({options.frames, options.run.num_threads}, &workspace, &state, &report);
  plan.job.image_path = workspace.images;
  const PictureSet pictures = ReadPictures(options, workspace);
  CheckScaleNames(options.scale, NamesOf(pictures));
  const DatabaseInputs inputs = InputsOfDatabase(options, pictures.readable);
  const Stage begin = DatabaseStage(options, inputs);
  const JobSize size = SizeOf(options, pictures.readable);
  PlanJob(size, workspace.root, DoneBefore(begin, state), &progress);
  JobDisk disk(workspace, size, WhenDiskIsShort(options));
  disk.Begin(JobPart::kDatabase);
  ColmapDatabase database = OpenWorkspaceDatabase(workspace.database, pictures.readable,
                                                  options.reader, begin, inputs, &state);
  ExtractAndTie(options, workspace, pictures, begin, &database, &state, &report);
  FindMarkersOfDive(options, workspace, &state, &report);
  disk.Begin(JobPart::kModels);
  const Mapping mapping = MapPictures(plan, database, &state);
  report.stages.insert(report.stages.end(), mapping.seconds.begin(), mapping.seconds.end());
  std::vector<ModelSummary> models = ReadModels(mapping.models, &report);
  ScaleModels(options, pictures, workspace, mapping.fingerprint, &state, &models, &report);
  disk.Begin(JobPart::kClouds);
  DensifyModels(options, workspace, mapping.fingerprint, &database, &state, &models, &report);
  disk.Begin(JobPart::kMaps);
  MakeMaps(options, workspace, mapping.fingerprint, &state, &models, &report);
  disk.Begin(JobPart::kReport);
  ReportCompletenessOfModels(options, workspace, mapping.fingerprint, &state, &models, &report);
  RememberJob(&progress);
  return WriteReport(workspace, models, report);
}

}  // namespace colmap_seapoint
