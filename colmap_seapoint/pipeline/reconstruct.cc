#include "colmap_seapoint/pipeline/reconstruct.h"

#include <filesystem>
#include <map>
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
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/mapping/second_chance.h"
#include "colmap_seapoint/pairing/tilted_pairs.h"
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

// The stage that finds the untied pictures: all that decides which they are, but for what the
// pictures hold (SecondChance::pictures).
Stage SecondChanceStage(const Options& options, const Stage& database_stage) {
  return {"second_chance", kMatchingVersion,
          StageFingerprint(database_stage) + OptionsFingerprint(OptionValues(options.extraction)),
          ""};
}

// A picture is told from another one of its name by its content, which the extraction hashes
// anyway: size and time may be the same (a restored copy), and times differ where nothing did (a
// moved survey).
struct SecondChance {
  std::set<std::string> untied;  // names
  std::string pictures;          // a hash of all pictures that they were found among
};

void to_json(nlohmann::ordered_json& json, const SecondChance& chance) {
  json = {{"untied", chance.untied}, {"pictures", chance.pictures}};
}

void from_json(const nlohmann::ordered_json& json, SecondChance& chance) {
  chance = {json.at("untied").get<std::set<std::string>>(), json.at("pictures")};
}

std::string HashOf(const std::vector<RunReport::Input>& pictures) {
  std::string text;
  for (const RunReport::Input& picture : pictures) text += picture.name + " " + picture.hash + "\n";
  return HashText(text);
}

// The two cameras of a rig may have one body, and one serial number.
Options WithRigsCameras(Options options) {
  int* per_folder = &options.reader.single_camera_per_folder;
  if (!options.rig.empty() && *per_folder < 0) *per_folder = 1;
  return options;
}

FeatureExtractorOptions ExtractorOptions(const Options& options, const Workspace& workspace) {
  FeatureExtractorOptions extractor;
  extractor.database_path = workspace.database.string();
  extractor.image_path = workspace.images.string();
  extractor.reader = options.reader;
  extractor.extraction = options.extraction;
  extractor.run = options.run;
  return extractor;
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
              "holds one picture that can be used, " + pictures.readable.front().name,
              "depth takes two pictures at least that show the same place from different points: "
              "add more, which overlap by half or more");
}

RunReport MatchAll(const Options& options, const Workspace& workspace, size_t num_pictures,
                   ColmapDatabase* database) {
  if (MatchesAllPairs(options, num_pictures)) {
    ExhaustiveMatcherOptions exhaustive;
    exhaustive.database_path = workspace.database.string();
    exhaustive.matching = options.matching;
    exhaustive.run = options.run;
    return MatchExhaustively(exhaustive, database);
  }
  SequentialMatcherOptions sequential;
  sequential.database_path = workspace.database.string();
  sequential.pairs = options.pairs;
  sequential.matching = options.matching;
  sequential.run = options.run;
  return MatchSequentially(sequential, database);
}

// SeaPoints and matches of all pictures; then once more with SI-SeaPoints beside them for those
// that are untied, and their partners. An earlier run that found these already, among the same
// pictures, spares the first pass.
void ExtractAndMatch(const Options& options, const Workspace& workspace, const PictureSet& pictures,
                     const Stage& second_chance, ColmapDatabase* database, WorkspaceState* state,
                     RunReport* report) {
  const FeatureExtractorOptions extractor = ExtractorOptions(options, workspace);
  const auto pass = [&](const std::set<std::string>& second_chance_names) {
    const RunReport extracted = ExtractPictures(extractor, pictures, second_chance_names, database);
    report->images_in = extracted.images_in;
    report->inputs = extracted.inputs;
    AddPart(extracted, report);
    AddPart(MatchAll(options, workspace, pictures.readable.size(), database), report);
  };
  const auto known = ResultIfDone<SecondChance>(*state, second_chance);
  pass(known ? known->untied : std::set<std::string>());
  if (known && known->pictures == HashOf(report->inputs)) return;
  if (known && !known->untied.empty()) pass({});
  state->Forget(second_chance.name);
  if (options.extraction.num_levels > 1) return;
  const auto found =
      RunStage<SecondChance>(state, second_chance, [&]() -> StageOutput<SecondChance> {
        return {{FindSecondChancePictures(*database), HashOf(report->inputs)}, {}};
      });
  if (found.untied.empty()) return;
  LogInfo(std::to_string(found.untied.size()) +
          " pictures are untied, or may tie one that is: SI-SeaPoints for them too");
  pass(found.untied);
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

MaskedPicture ReadMasked(const fs::path& folder, const PictureMasks& masks,
                         const std::string& name) {
  MaskedPicture read = {ReadGrayImage(folder / name), {}};
  read.mask = masks.Decode(name, masks.Open(name), read.picture.width, read.picture.height);
  return read;
}

// An earlier run was interrupted between the rows and the record of them.
bool IsTiedAlready(const ColmapDatabase& database, const std::set<uint32_t>& ids) {
  for (const uint32_t id : ids) {
    const auto fingerprint = FeaturesFingerprint(database, id);
    if (fingerprint && fingerprint->find(kTiltedMark) != std::string::npos) return true;
  }
  return false;
}

// The groups that these pictures are in now; empty when it is one.
std::map<uint32_t, uint32_t> GroupsOf(const ColmapDatabase& database,
                                      const std::set<uint32_t>& ids) {
  std::map<uint32_t, uint32_t> groups;
  std::set<uint32_t> different;
  for (const auto& [id, group] : TiedGroups(database)) {
    if (ids.count(id) == 0) continue;
    groups[id] = group;
    different.insert(group);
  }
  if (different.size() < 2) groups.clear();
  return groups;
}

int64_t TieAll(TiltedPairsJob job, const std::set<uint32_t>& ids, ColmapDatabase* database) {
  int64_t num_tied = 0;
  DatabaseTransaction transaction(database);
  for (const double tilt_deg : kTiltsDeg) {
    job.tilt_deg = tilt_deg;
    job.groups = GroupsOf(*database, ids);
    if (!job.groups.empty()) num_tied += TieByTiltedViews(job, database);
  }
  transaction.Commit();
  return num_tied;
}

// What the second chance has not tied either gets a third one: views from above, a tilt after the
// other, as long as its pictures hang together in more than one group.
void TieTheRest(const Options& options, const Workspace& workspace, const Stage& second_chance,
                ColmapDatabase* database, WorkspaceState* state, RunReport* report) {
  const auto found = ResultIfDone<SecondChance>(*state, second_chance);
  if (!found || found->untied.empty()) return;
  const Stage stage = {"tilted_views", kTiltedPairsVersion,
                       StageFingerprint(second_chance) + found->pictures, ""};
  std::set<uint32_t> ids;
  for (const DatabaseImage& image : ReadImages(*database)) {
    if (found->untied.count(image.name) > 0) ids.insert(image.image_id);
  }
  RunStage<int64_t>(state, stage, [&]() -> StageOutput<int64_t> {
    if (ids.empty() || IsTiedAlready(*database, ids)) return {0, {}};
    StageTimer timer(report, stage.name);
    TiltedPairsJob job;
    job.read = [&, masks = PictureMasks(options.reader.mask_path)](const std::string& name) {
      return ReadMasked(workspace.images, masks, name);
    };
    job.extraction = options.extraction;
    job.matching = options.matching;
    job.num_threads = options.run.num_threads;
    const int64_t num_tied = TieAll(job, ids, database);
    LogInfo(std::to_string(num_tied) + " pairs of pictures were tied by views from above");
    return {num_tied, {}};
  });
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
  const Stage second_chance = SecondChanceStage(options, begin);
  ExtractAndMatch(options, workspace, pictures, second_chance, &database, &state, &report);
  FindMarkersOfDive(options, workspace, &state, &report);
  TieTheRest(options, workspace, second_chance, &database, &state, &report);
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
