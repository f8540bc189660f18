#include "colmap_seapoint/pipeline/reconstruct.h"

#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/mapping/run_mapper.h"
#include "colmap_seapoint/mapping/second_chance.h"
#include "colmap_seapoint/pictures/read_rig.h"
#include "colmap_seapoint/pipeline/densify.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/pipeline/prepare_database.h"
#include "colmap_seapoint/pipeline/scale_models.h"
#include "densify/densify_sequence.h"
#include "colmap_seapoint/pipeline/workspace_state.h"
#include "colmap_seapoint/report/reconstruction_summary.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Pictures with a verified pair.
std::vector<std::string> MatchedPictures(const fs::path& database_path) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadWrite);
  std::set<uint32_t> ids;
  for (const ImagePair& pair : database.ReadVerifiedPairs()) ids.insert({pair.first, pair.second});
  std::vector<std::string> names;
  for (const DatabaseImage& image : database.ReadImages()) {
    if (ids.count(image.image_id) > 0) names.push_back(image.name);
  }
  return names;
}

// One run: the paths of the workspace, what is known so far, and one function a stage.
class Reconstruction {
 public:
  explicit Reconstruction(const AutomaticReconstructorOptions& options)
      : options_(options),
        colmap_(FindColmap(options.colmap_path)),
        first_round_(OptionsOfRound(Round::kFirst)),
        later_rounds_(OptionsOfRound(Round::kLater)),
        workspace_(fs::absolute(options.workspace_path).lexically_normal()),
        image_path_(fs::absolute(options.image_path).lexically_normal()),
        database_path_(workspace_ / "database.db"),
        state_(workspace_),
        report_(StartReport("automatic_reconstructor", options, options.run)) {
    CheckWritableDir(workspace_ / "report");
    for (const auto& option : options.mapper) report_.options.push_back(option);
  }

  void ExtractFeatures();
  void MatchFeatures();
  // True when pictures were found that deserve SI-SeaPoints: extract and match once more.
  bool FindSecondChances();
  void MapSparsely();
  void ScaleModels();
  void DensifyModels();
  CommandResult WriteReport();

 private:
  MapperOptions OptionsOfRound(Round round) const;
  std::optional<MapperOptions> GlobalRound() const;
  std::string PicturesFingerprint(const std::vector<ReadablePicture>& pictures) const;
  bool MatchesAllPairs() const;
  bool FindsLens() const;
  std::string SecondChanceFingerprint(const std::string& pictures_fingerprint,
                                      const std::vector<ReadablePicture>& pictures) const;
  std::string MapperFingerprint() const;
  void AddReport(const RunReport& part);
  void ReadModels();
  RunReport DensifyOnce(const fs::path& model, const std::string& name,
                        const std::string& scaling_fingerprint);
  void RemoveStaleClouds(size_t num_models);

  const AutomaticReconstructorOptions& options_;
  ColmapProgram colmap_;
  MapperOptions first_round_, later_rounds_;
  fs::path workspace_, image_path_, database_path_;
  WorkspaceState state_;
  RunReport report_;
  size_t num_readable_ = 0;
  std::vector<std::string> matched_pictures_;
  std::string second_chance_fingerprint_, mapper_fingerprint_;
  std::vector<ModelSummary> models_;
};

// Where the lens is ours to find, the models are adjusted by us afterwards (adjust_lens.h); where
// it is given, the mapper's own adjustment is the last one.
MapperOptions Reconstruction::OptionsOfRound(Round round) const {
  const std::string effort = FindsLens() ? options_.quality : "archive";
  return colmap_seapoint::OptionsOfRound(colmap_, round, effort, options_.run.random_seed,
                                         options_.mapper);
}

std::optional<MapperOptions> Reconstruction::GlobalRound() const {
  if (options_.quality != "field" || !FindsLens() || !options_.mapper.empty()) return std::nullopt;
  return OptionsOfGlobalMapper(colmap_, options_.run.random_seed);
}

bool Reconstruction::MatchesAllPairs() const {
  if (options_.matcher != "auto") return options_.matcher == "exhaustive";
  return num_readable_ <= kMaxImagesForAllPairs;
}

// Of all that decides which rows the database holds, but for the SeaPoints.
std::string Reconstruction::PicturesFingerprint(
    const std::vector<ReadablePicture>& pictures) const {
  std::string text = kMatchingVersion;
  text += OptionsFingerprint(OptionValues(options_.reader));
  text += OptionsFingerprint(OptionValues(options_.matching));
  text += MatchesAllPairs() ? "exhaustive"
                            : OptionsFingerprint(OptionValues(options_.pairs)) +
                                  std::to_string(options_.run.random_seed);
  for (const ReadablePicture& picture : pictures) {
    const ImageInfo& info = picture.info;
    text += "\n" + picture.name + " " + std::to_string(info.width) + " " +
            std::to_string(info.height) + " " + std::to_string(info.focal_length_px.value_or(0)) +
            " " + info.camera_key;
  }
  return HashText(text);
}

void Reconstruction::AddReport(const RunReport& part) {
  report_.stages.insert(report_.stages.end(), part.stages.begin(), part.stages.end());
  // A picture can be left out of several models: it is named once.
  std::set<std::string> named;
  for (const auto& left_out : report_.left_out) named.insert(left_out.name);
  for (const auto& left_out : part.left_out) {
    if (named.insert(left_out.name).second) report_.left_out.push_back(left_out);
  }
}

void Reconstruction::ExtractFeatures() {
  FeatureExtractorOptions extractor;
  extractor.database_path = database_path_.string();
  extractor.image_path = image_path_.string();
  extractor.reader = options_.reader;
  extractor.extraction = options_.extraction;
  extractor.run = options_.run;
  const auto prepare = [&](const std::vector<ReadablePicture>& pictures) {
    num_readable_ = pictures.size();
    const std::string fingerprint = PicturesFingerprint(pictures);
    PrepareDatabase(database_path_, pictures, options_.reader, fingerprint, &state_);
    second_chance_fingerprint_ = SecondChanceFingerprint(fingerprint, pictures);
    // Known from an earlier run already, or found by this one.
    std::set<std::string> names;
    if (const auto known = state_.ReadIfDone("second_chance", second_chance_fingerprint_)) {
      for (const RunReport::Input& picture : known->inputs) names.insert(picture.name);
    }
    return names;
  };
  const RunReport part = ExtractPictures(extractor, prepare);
  report_.images_in = part.images_in;
  report_.inputs = part.inputs;
  AddReport(part);
}

// Of all that decides which pictures stay untied. A picture counts as another one when its size or
// its time of change differs: to look once more costs time only.
std::string Reconstruction::SecondChanceFingerprint(
    const std::string& pictures_fingerprint, const std::vector<ReadablePicture>& pictures) const {
  std::string text = pictures_fingerprint + OptionsFingerprint(OptionValues(options_.extraction));
  for (const ReadablePicture& picture : pictures) {
    std::error_code error;
    const fs::path path = image_path_ / picture.name;
    text += "\n" + std::to_string(fs::file_size(path, error)) + " " +
            std::to_string(fs::last_write_time(path, error).time_since_epoch().count());
  }
  return HashText(text);
}

bool Reconstruction::FindSecondChances() {
  if (options_.extraction.num_levels > 1) return false;
  const std::string& fingerprint = second_chance_fingerprint_;
  if (state_.ReadIfDone("second_chance", fingerprint)) return false;
  RunReport found;
  for (const std::string& name : FindSecondChancePictures(database_path_)) {
    found.inputs.push_back({name, 0, ""});
  }
  const size_t count = found.inputs.size();
  state_.Finish("second_chance", fingerprint, found);
  if (count == 0) return false;
  LogInfo(std::to_string(count) +
          " pictures are untied, or next to one that is: SI-SeaPoints for them");
  return true;
}

void Reconstruction::MatchFeatures() {
  SequentialMatcherOptions sequential;
  sequential.database_path = database_path_.string();
  sequential.pairs = options_.pairs;
  sequential.matching = options_.matching;
  sequential.run = options_.run;
  ExhaustiveMatcherOptions exhaustive;
  exhaustive.database_path = sequential.database_path;
  exhaustive.matching = options_.matching;
  exhaustive.run = options_.run;
  AddReport(MatchesAllPairs() ? MatchExhaustively(exhaustive) : MatchSequentially(sequential));
  matched_pictures_ = MatchedPictures(database_path_);
}

// Not where the user says what the lens is, or what of it is to be refined.
bool Reconstruction::FindsLens() const {
  if (!options_.reader.camera_params.empty()) return false;
  const auto refinement = options_.mapper.lower_bound("Mapper.ba_refine");
  return refinement == options_.mapper.end() || refinement->first.rfind("Mapper.ba_refine", 0) != 0;
}

// The mapper's work depends on what the database holds, and on the mapper.
std::string Reconstruction::MapperFingerprint() const {
  const auto begun = state_.Read("database");
  return HashText(
      kMapperVersion + DatabaseFingerprint(database_path_) + (begun ? begun->fingerprint : "") +
      colmap_.version + (FindsLens() ? "lens" : "") +
      (options_.adjust_principal_point ? "adjusted" : "") + (GlobalRound() ? "global" : "") +
      OptionsFingerprint({first_round_.begin(), first_round_.end()}) +
      OptionsFingerprint({later_rounds_.begin(), later_rounds_.end()}));
}

void Reconstruction::MapSparsely() {
  if (matched_pictures_.empty()) {
    throw Error(options_.image_path, "no two of its pictures show the same place",
                "take pictures that overlap more, or raise --SeaPointExtraction.max_num_features");
  }
  mapper_fingerprint_ = MapperFingerprint();
  const fs::path sparse = workspace_ / "sparse";
  RunReport part;
  if (const auto done = state_.ReadIfDone("mapper", mapper_fingerprint_);
      done && !ListModels(sparse).empty()) {
    LogInfo("The models in " + sparse.string() + " are there already");
    part = *done;
  } else {
    state_.Forget("mapper");
    {
      StageTimer timer(&part, "mapper");
      RunMapper(colmap_, {database_path_, image_path_, sparse, workspace_ / "report", GlobalRound(),
                          first_round_, later_rounds_, FindsLens(), options_.adjust_principal_point,
                          matched_pictures_});
    }
    state_.Finish("mapper", mapper_fingerprint_, part);
  }
  AddReport(part);
  ReadModels();
}

void Reconstruction::ReadModels() {
  std::set<std::string> registered;
  for (const fs::path& path : ListModels(workspace_ / "sparse")) {
    ModelSummary model;
    model.name = path.filename().string();
    model.path = path;
    const SparseModel read = ReadSparseModel(path, ModelContent::kPosesAndPoints);
    for (const PosedImage& image : read.images) {
      model.pictures.push_back(image.name);
      registered.insert(image.name);
    }
    models_.push_back(std::move(model));
  }
  report_.images_used = static_cast<int64_t>(registered.size());
  std::set<std::string> named;
  for (const auto& left_out : report_.left_out) named.insert(left_out.name);
  for (const RunReport::Input& input : report_.inputs) {
    if (registered.count(input.name) > 0 || named.count(input.name) > 0) continue;
    LeaveOut(input.name, "is in no model: the mapper could not register it", &report_);
  }
}

// Into sparse_scaled/<k>: the mapper's own models stay as they are.
void Reconstruction::ScaleModels() {
  ModelScalerOptions scaler;
  scaler.image_path = image_path_.string();
  scaler.rig = options_.rig;
  scaler.sources = options_.scale;
  scaler.run = options_.run;
  AddReport(ScaleAllModels(scaler, workspace_, mapper_fingerprint_, &state_, &models_));
  for (const ModelSummary& model : models_) {
    report_.units = report_.units.empty() || report_.units == model.units_word
                        ? model.units_word
                        : "metres and arbitrary, see summary.txt";
  }
}

RunReport Reconstruction::DensifyOnce(const fs::path& model, const std::string& name,
                                      const std::string& scaling_fingerprint) {
  PartialDensifierOptions densifier;
  densifier.image_path = image_path_.string();
  densifier.input_path = model.string();
  densifier.output_path = (workspace_ / "dense" / name).string();
  densifier.database_path = database_path_.string();
  densifier.rig = options_.rig;
  densifier.densification = options_.densification;
  densifier.extraction = options_.extraction;
  densifier.matching = options_.matching;
  densifier.run = options_.run;
  const std::string stage = "dense_" + name;
  const std::string fingerprint =
      HashText(kDensificationVersion + mapper_fingerprint_ + name + "," + options_.rig + "," +
               scaling_fingerprint + OptionsFingerprint(OptionValues(options_.densification)));
  const fs::path output = densifier.output_path;
  auto done = state_.ReadIfDone(stage, fingerprint);
  const bool is_there =
      fs::exists(output / "fused.ply") &&
      (!options_.densification.write_maps || fs::exists(output / "stereo" / "fusion.cfg"));
  if (done && (done->points == 0 || is_there)) {
    LogInfo("The cloud in " + output.string() + " is there already");
    return *done;
  }
  state_.Forget(stage);
  RunReport report = DensifyModel(densifier);
  for (RunReport::Stage& part : report.stages) part.name += " " + name;
  state_.Finish(stage, fingerprint, report);
  return report;
}

// Of models that an earlier run had found and this one has not.
void Reconstruction::RemoveStaleClouds(size_t num_models) {
  std::error_code error;
  for (size_t k = num_models; state_.Read("dense_" + std::to_string(k)); ++k) {
    state_.Forget("dense_" + std::to_string(k));
    fs::remove_all(workspace_ / "dense" / std::to_string(k), error);
  }
}

void Reconstruction::DensifyModels() {
  CheckWritableDir(workspace_ / "dense");
  RemoveStaleClouds(models_.size());
  for (ModelSummary& model : models_) {
    model.densification = DensifyOnce(model.path, model.name, model.scaling_fingerprint);
    model.cloud_path = workspace_ / "dense" / model.name / "fused.ply";
    AddReport(model.densification);
    report_.pairs += model.densification.pairs;
    report_.points += model.densification.points;
    if (model.densification.points > 0) continue;
    LeaveOut("sparse/" + model.name,
             "no pair of this model gave a point; see dense/" + model.name + "/pairs.csv",
             &report_);
  }
  if (report_.points > 0) return;
  throw Error(workspace_.string(), "no pair of any model gave a point",
              "see why in dense/0/pairs.csv there");
}

CommandResult Reconstruction::WriteReport() {
  // Reading leaves SQLite's side files; the last writer to close the database takes them away.
  { const ColmapDatabase closing(database_path_, ColmapDatabase::Mode::kReadWrite); }
  const std::string summary = SummaryText(models_, report_);
  WriteTextFile(workspace_ / "report" / "summary.txt", summary);
  WriteRunReport(workspace_ / "report" / "run.json", report_);
  return {report_.left_out.empty(), summary + "report: " + (workspace_ / "report").string() + "\n"};
}

}  // namespace

CommandResult RunAutomaticReconstructor(const AutomaticReconstructorOptions& options) {
  options.Check();
  Reconstruction reconstruction(options);
  reconstruction.ExtractFeatures();
  reconstruction.MatchFeatures();
  if (reconstruction.FindSecondChances()) {
    reconstruction.ExtractFeatures();
    reconstruction.MatchFeatures();
  }
  reconstruction.MapSparsely();
  reconstruction.ScaleModels();
  reconstruction.DensifyModels();
  return reconstruction.WriteReport();
}

}  // namespace colmap_seapoint
