#include "colmap_seapoint/pipeline/densify.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <tuple>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/cloud/seen_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/mapping/mapper_process.h"
#include "colmap_seapoint/pictures/model_inputs.h"
#include "colmap_seapoint/pictures/model_pictures.h"
#include "colmap_seapoint/pictures/picture_scale.h"
#include "colmap_seapoint/pictures/read_rig.h"
#include "colmap_seapoint/pipeline/write_maps.h"
#include "colmap_seapoint/report/debug_figures.h"
#include "colmap_seapoint/report/pairs_csv.h"
#include "colmap_seapoint/workspace/earlier_outputs.h"
#include "colmap_seapoint/workspace/output_paths.h"
#include "densify/sequence_scope.h"

namespace colmap_seapoint {
namespace {

// Of "2/4"; nullopt for what is no such part.
std::optional<std::pair<int, int>> ParseBlock(const std::string& text) {
  int block = 0, num_blocks = 0, end = 0;
  if (std::sscanf(text.c_str(), "%6d/%6d%n", &block, &num_blocks, &end) != 2) return std::nullopt;
  if (static_cast<size_t>(end) != text.size()) return std::nullopt;
  if (block < 1 || block > num_blocks) return std::nullopt;
  return std::pair(block, num_blocks);
}

void CheckBlock(const PartialDensifierOptions& options) {
  if (options.block.empty()) return;
  if (!ParseBlock(options.block)) {
    throw UsageError("--block " + options.block + ": must be k/N, the k-th of N parts, as 2/4");
  }
  if (CanBeDensifiedInParts(options.densification)) return;
  throw UsageError(
      "--block: takes --PartialDensification.mode partial, redundancy all, completion 1, and "
      "neither "
      "write_maps nor write_debug");
}

void Validate(const PartialDensifierOptions& options) {
  CheckOutputPaths(options);
  for (const std::string& problem :
       {options.densification.Check(), options.extraction.Check(), CheckRig(options.rig)}) {
    if (!problem.empty()) throw UsageError(problem);
  }
  CheckBlock(options);
  if (!std::filesystem::is_directory(options.image_path)) {
    throw Error(options.image_path, "there is no such folder", "check --image_path");
  }
  if (options.densification.write_maps) {
    CheckMapFolders(options.image_path, options.input_path, options.output_path);
  }
}

// The model as the pictures see it. With maps in the order of its image ids, as sparse/ beside the
// cloud has it: fused.ply.vis counts pictures in that order.
SparseModel ReadModel(const PartialDensifierOptions& options,
                      ModelContent content = ModelContent::kPosesAndPoints) {
  SparseModel model = ReadSparseModel(options.input_path, content);
  if (options.densification.write_maps) SortImagesById(&model);
  for (const auto& [id, camera] : model.cameras) {
    if (camera.model != CameraModel::kEquirectangular) continue;
    throw Error(options.input_path,
                "camera " + std::to_string(id) +
                    " is EQUIRECTANGULAR: two panoramas cannot be rectified to one another",
                "cut its pictures into perspective ones and give their model");
  }
  const int num_scaled =
      ScaleCamerasToPictures(options.image_path, options.run.num_threads, &model);
  if (num_scaled > 0) {
    LogInfo(std::to_string(num_scaled) +
            " pictures are of another resolution than the model's cameras, which are scaled to "
            "them");
  }
  return model;
}

std::vector<std::string> NamesOf(const SparseModel& model) {
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  return names;
}

// Seconds of each stage over all pairs: wall time on the threads that did the work.
void LogPairSeconds(const SequenceReport& sequence) {
  double rectification = 0, propagation = 0;
  for (const PairReport& pair : sequence.pairs) {
    rectification += pair.rectification_seconds;
    propagation += pair.propagation_seconds;
  }
  LogDebug("rectification " + DurationText(rectification) + ", propagation " +
           DurationText(propagation) + " (sums over pairs)");
}

// The earlier cloud's points into the new one, and what they cover. Those of a pair stand together.
EarlierSurface TakeOver(const EarlierCloud& earlier, const std::filesystem::path& path,
                        const SparseModel& model, int step, CloudWriter* cloud) {
  EarlierSurface surface;
  surface.num_pictures = earlier.num_pictures;
  if (earlier.num_pictures == 0) return surface;
  std::vector<Eigen::Vector3f> points;
  std::array<uint32_t, 2> pair = {};
  const auto finish_pair = [&] {
    if (points.empty()) return;
    const PosedImage& image = model.images.at(pair[0]);
    const Camera& camera = model.cameras.at(image.camera_id);
    surface.footprints.emplace_back(
        FootprintOf(points, {static_cast<int>(pair[0]), camera, image.cam_from_world},
                    CellsOf(camera, step), SampleStep(camera, step)));
    points.clear();
  };
  ReadSeenCloud(path, [&](const CloudPoint& point, uint32_t image_idx1, uint32_t image_idx2) {
    const std::array<uint32_t, 2> of_point = {image_idx1, image_idx2};
    if (of_point != pair) finish_pair();
    pair = of_point;
    points.push_back(point.xyz);
    cloud->Add(point, pair.data(), 2);
  });
  finish_pair();
  return surface;
}

SequenceScope ScopeOf(const PartialDensifierOptions& options, const EarlierCloud& earlier,
                      const SparseModel& model, CloudWriter* cloud) {
  SequenceScope scope;
  scope.earlier = TakeOver(earlier, std::filesystem::path(options.output_path) / "fused.ply", model,
                           options.densification.step, cloud);
  if (const auto block = ParseBlock(options.block)) {
    std::tie(scope.block, scope.num_blocks) = *block;
  }
  return scope;
}

SequenceReport Densify(const PartialDensifierOptions& options, const SparseModel& model,
                       const StereoRig& rig, const SequenceScope& scope, ModelPictures* pictures,
                       CloudWriter* cloud, MapWriter* maps) {
  std::unique_ptr<Progress> progress;
  DebugFigures figures(std::filesystem::path(options.output_path) / "debug", model);
  SequenceCallbacks callbacks;
  callbacks.sink = [&](const PartialCloud& part) {
    const std::array<uint32_t, 2> seen_by = {static_cast<uint32_t>(part.image_idx1),
                                             static_cast<uint32_t>(part.image_idx2)};
    if (maps != nullptr) maps->AddPair(part, cloud->NumPoints());
    for (const DensePoint& point : part.points) {
      cloud->Add({point.xyz, point.normal, point.rgb, point.confidence}, seen_by.data(), 2);
    }
  };
  callbacks.progress = [&](int64_t done, int64_t total) {
    if (!progress) {
      progress =
          std::make_unique<Progress>("Making the cloud, steps", total, 0, Work::kDensification);
    }
    progress->Update(done);
  };
  if (options.densification.write_debug) {
    callbacks.debug = [&](const PairDebug& pair) { figures.Write(pair); };
  }
  SequenceReport sequence =
      DensifyInScope(model, pictures, options.densification,
                     EffectiveNumThreads(options.run.num_threads), callbacks, rig, scope);
  if (progress) progress->Finish();
  if (sequence.num_triangulated > 0) {
    LogInfo("no point of the model is seen by two pictures: " +
            std::to_string(sequence.num_triangulated) +
            " were triangulated from matches, for densification only");
  }
  return sequence;
}

void FillReport(const SparseModel& model, const SequenceReport& sequence, RunReport* report) {
  std::set<int> used;
  for (const PairReport& pair : sequence.pairs) {
    if (!pair.skipped.empty()) continue;
    ++report->pairs;
    used.insert({pair.image_idx1, pair.image_idx2});
  }
  for (const LeftOutPicture& picture : sequence.left_out) {
    LeaveOut(model.images.at(static_cast<size_t>(picture.image_idx)).name, picture.reason, report);
  }
  report->images_used = static_cast<int64_t>(used.size());
}

// Before anything is computed. The maps' names are the pictures', which are claimed once they are
// read (StartMaps()).
void ClaimOutputs(const PartialDensifierOptions& options, OutputFolder* folder) {
  AdoptEarlierOutputs(folder);
  std::vector<std::string> names = CloudNames();
  if (options.densification.write_debug) names.emplace_back("debug");
  folder->Claim(names);
}

// Before anything else: a folder of other masks would be noticed in the cloud only.
void CheckMasks(const PartialDensifierOptions& options,
                const std::vector<std::filesystem::path>& models) {
  if (options.mask_path.empty()) return;
  std::vector<std::string> names;
  for (const std::filesystem::path& path : models) {
    const auto of_model = NamesOf(ReadSparseModel(path, ModelContent::kPosesAndPoints));
    names.insert(names.end(), of_model.begin(), of_model.end());
  }
  PictureMasks(options.mask_path).Check(names, "--mask_path");
}

// The models that one run of the mapper left: each has its own frame and gets its own folder.
CommandResult DensifySideBySide(const PartialDensifierOptions& options,
                                const std::vector<std::filesystem::path>& models,
                                ColmapDatabase* database) {
  std::vector<PartialDensifierOptions> jobs(models.size(), options);
  for (size_t i = 0; i < models.size(); ++i) {
    jobs[i].input_path = models[i].string();
    jobs[i].output_path =
        (std::filesystem::path(options.output_path) / models[i].filename()).string();
    // The last one is not to be refused after hours of work on the others.
    OutputFolder folder(jobs[i].output_path, "--output_path");
    ClaimOutputs(jobs[i], &folder);
  }
  CommandResult result;
  int64_t num_points = 0;
  for (const PartialDensifierOptions& one : jobs) {
    LogInfo("Model " + one.input_path);
    const RunReport report = DensifyModel(one, database);
    num_points += report.points;
    if (report.points == 0) {
      LogWarning(one.input_path + " is left out: no pair of its pictures gave a point; see " +
                 one.output_path + "/pairs.csv");
    }
    result.is_complete &= report.points > 0 && report.left_out.empty();
  }
  if (num_points > 0) return result;
  throw Error(options.input_path, "no pair of any of its models gave a point",
              "see why in the pairs.csv below " + options.output_path);
}

// nullptr without PartialDensification.write_maps. Their sparse/ is written at once: it takes the
// model's features too, which are forgotten again before densification.
std::unique_ptr<MapWriter> StartMaps(const PartialDensifierOptions& options,
                                     const SparseModel& model, OutputFolder* folder) {
  if (!options.densification.write_maps) return nullptr;
  folder->Claim(DenseMapNames(NamesOf(model)));
  auto maps = std::make_unique<MapWriter>(
      model, options.image_path, PictureMasks(options.mask_path), options.output_path,
      options.densification, EffectiveNumThreads(options.run.num_threads));
  maps->WriteModel(ReadModel(options, ModelContent::kTriangulated));
  return maps;
}

}  // namespace

void PartialDensifierOptions::Bind(OptionTable* table) {
  table->AddRequired("image_path", &image_path, "folder of the pictures");
  table->AddRequired("input_path", &input_path,
                     "COLMAP model, binary or text; or a folder of several, each densified into "
                     "a folder of its name");
  table->AddRequired("output_path", &output_path,
                     "folder for fused.ply, fused.ply.vis, pairs.csv, units.json and run.json");
  table->Add("database_path", &database_path,
             "COLMAP database with SeaPoints and matches; empty = they are found again", "ours");
  table->Add("mask_path", &mask_path,
             "folder of masks <image name>.png, no point where a mask is 0; empty = none",
             "COLMAP (there StereoFusion.mask_path)");
  table->Add("rig", &rig, kRigHelp, "paper 4");
  table->Add("block", &block,
             "k/N: only the pairs that begin in the k-th of N parts of the track, each part on a "
             "machine of its own; cloud_merger joins the clouds; empty = all",
             "ours");
  densification.Bind(table);
  extraction.Bind(table);
  matching.Bind(table);
  run.Bind(table);
  table->MarkOutput("output_path");
}

RunReport DensifyModel(const PartialDensifierOptions& options, ColmapDatabase* database,
                       const EarlierCloud& earlier) {
  Validate(options);
  RunReport report = StartReport("partial_densifier", options, options.run);
  OutputFolder folder(options.output_path, "--output_path");
  const std::filesystem::path& output = folder.Path();
  ClaimOutputs(options, &folder);
  const ModelUnits units = ReadModelUnits(options.input_path).value_or(ModelUnits());
  report.units = UnitsWord(units);
  SequenceReport sequence;
  {
    auto timer = std::make_unique<StageTimer>(&report, "partial_densifier");
    const SparseModel model = ReadModel(options);
    report.images_in = static_cast<int64_t>(model.images.size());
    ModelPictures pictures(model, options.image_path, PictureMasks(options.mask_path), database,
                           options.extraction, options.matching);
    CheckModelPictures(pictures, model, options.image_path, options.input_path);
    if (database != nullptr && pictures.NumInDatabase() == 0) {
      LogWarning(options.database_path +
                 " holds SeaPoints of no picture of the model: they are "
                 "found again");
    }
    const StereoRig rig = ReadRig(options.rig, options.image_path, options.input_path, model);
    const std::unique_ptr<MapWriter> maps = StartMaps(options, model, &folder);
    CloudWriter cloud(output / "fused.ply");
    const SequenceScope scope = ScopeOf(options, earlier, model, &cloud);
    const std::string rows =
        earlier.num_pictures > 0 ? RowsOfPairsCsv(output / "pairs.csv") : std::string();
    sequence = Densify(options, model, rig, scope, &pictures, &cloud, maps.get());
    report.inputs = DescribeModelInputs(pictures, model.images.size(), options.input_path,
                                        options.run.num_threads);
    FillReport(model, sequence, &report);
    report.pairs += earlier.num_pairs;
    LogPairSeconds(sequence);
    report.points = static_cast<int64_t>(cloud.NumPoints());
    WritePairsCsv(output / "pairs.csv", model, sequence, rows);
    if (report.points > 0) cloud.Finish();
    WriteModelUnits(output, units);
    if (maps != nullptr && report.points > 0) {
      timer = nullptr;
      timer = std::make_unique<StageTimer>(&report, "write_maps");
      maps->WriteMaps(sequence.left_out, &report);
    }
  }
  WriteRunReport(output / "run.json", report);
  if (report.points > 0) {
    LogInfo(std::to_string(report.points) + " points of " + std::to_string(report.pairs) +
            " pairs in " + (output / "fused.ply").string() + " (" + UnitsText(units) + ")");
  }
  return report;
}

CommandResult RunPartialDensifier(const PartialDensifierOptions& options) {
  Validate(options);
  std::optional<ColmapDatabase> database;
  if (!options.database_path.empty()) {
    database.emplace(options.database_path, ColmapDatabase::Mode::kReadOnly);
  }
  ColmapDatabase* const open = database ? &*database : nullptr;
  if (!IsSparseModel(options.input_path)) {
    const auto models = ListModels(options.input_path);
    CheckMasks(options, models);
    if (!models.empty()) return DensifySideBySide(options, models, open);
  } else {
    CheckMasks(options, {options.input_path});
  }
  const RunReport report = DensifyModel(options, open);
  if (report.points > 0) return ResultOf(report);
  throw Error(options.input_path, "no pair of its pictures gave a point",
              "see why in " + options.output_path + "/pairs.csv");
}

}  // namespace colmap_seapoint
