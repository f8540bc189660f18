#include "colmap_seapoint/pipeline/orthomosaic/map_maker.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "colmap_seapoint/pictures/model_inputs.h"
#include "colmap_seapoint/pictures/picture_scale.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_files.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_json.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_memory_file.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr double kFilesShare = 0.15;  // of the time: packing, hillshade and preview

void Validate(const OrthomosaicMakerOptions& options) {
  CheckOutputPaths(options);
  const std::string problem = options.map.Check();
  if (!problem.empty()) throw UsageError("--" + problem);
  if (!fs::is_directory(options.image_path)) {
    throw Error(options.image_path, "there is no such folder", "check --image_path");
  }
}

// A model in metres and the cloud from before, or the reverse, may well overlap.
void CheckSameUnits(const OrthomosaicMakerOptions& options,
                    const std::optional<ModelUnits>& units) {
  const auto of_cloud = ReadModelUnits(FolderOf(options.cloud_path));
  if (!of_cloud || UnitsText(of_cloud) == UnitsText(units)) return;
  throw Error(options.cloud_path,
              "is in other units than the model, as units.json beside it says (" +
                  UnitsText(of_cloud) + "; the model: " + UnitsText(units) + ")",
              "give the model that this cloud was made from (of a scaled cloud, the scaled model)");
}

// Before anything is computed.
void CheckReferenceSystem(const OrthomosaicMakerOptions& options,
                          const std::optional<ModelUnits>& units) {
  const std::string crs = units ? ReferenceSystem(*units) : "";
  if (!crs.empty()) WellKnownText(crs, (fs::path(options.input_path) / kUnitsFile).string());
}

SparseModel ReadModel(const OrthomosaicMakerOptions& options) {
  SparseModel model = ReadSparseModel(options.input_path, ModelContent::kPosesAndPoints);
  ScaleCamerasToPictures(options.image_path, options.run.num_threads, &model);
  std::vector<std::string> names;
  for (const PosedImage& image : model.images) names.push_back(image.name);
  if (!options.mask_path.empty()) PictureMasks(options.mask_path).Check(names, "--mask_path");
  return model;
}

// The model's pictures for the map; remembers which cannot be read, and why.
class PictureShelf {
 public:
  PictureShelf(ModelPictures* pictures, size_t num_pictures)
      : pictures_(*pictures), problems_(num_pictures) {}

  Picture Read(size_t i) {
    try {
      return pictures_.ReadPicture(static_cast<int>(i));
    } catch (const Error& error) {
      const std::lock_guard<std::mutex> lock(mutex_);
      problems_[i] = error.Finding();
      return {};
    }
  }

  void NameUnread(const SparseModel& model, RunReport* report) const {
    for (size_t i = 0; i < problems_.size(); ++i) {
      if (!problems_[i].empty()) LeaveOut(model.images[i].name, problems_[i], report);
    }
  }

 private:
  ModelPictures& pictures_;
  std::mutex mutex_;
  std::vector<std::string> problems_;  // by picture; empty: none
};

std::string Make(const OrthomosaicMakerOptions& options, OutputFolder* folder, RunReport* report) {
  const std::optional<ModelUnits> units = ReadModelUnits(options.input_path);
  report->units = UnitsWord(units);
  CheckSameUnits(options, units);
  CheckReferenceSystem(options, units);
  const SparseModel model = ReadModel(options);
  const size_t num_pictures = model.images.size();
  report->images_in = static_cast<int64_t>(num_pictures);
  ModelPictures pictures(model, options.image_path, PictureMasks(options.mask_path), nullptr, {},
                         {});
  CheckModelPictures(pictures, model, options.image_path, options.input_path);

  Progress progress("Making the map, pictures", report->images_in, 0, Work::kOrthomosaic);
  const auto advance = [&](double share) {
    progress.Update(static_cast<int64_t>(share * static_cast<double>(num_pictures)));
  };
  PictureShelf shelf(&pictures, num_pictures);
  OrthomosaicInputs inputs = {
      model,          options.cloud_path,
      units,          [&](size_t i) { return shelf.Read(i); },
      folder->Path(), [&](double share) { advance((1 - kFilesShare) * share); }};
  std::optional<MapMemory> before;
  if (options.former) before = ReadMapMemory(options.former->memory);
  if (before) inputs.before = &*before;
  MapFiles files(folder, units, num_pictures, options.run.num_threads,
                 options.former ? options.former->folder : fs::path());
  const OrthomosaicSummary map =
      MakeOrthomosaic(options.map.Options(options.run.num_threads), inputs, &files);
  files.Finish([&](double share) { advance(1 - kFilesShare * (1 - share)); });
  WriteTextFile(folder->Path() / kMapSourceTable, SourceTable(map, model));
  WriteTextFile(folder->Path() / kMapDescription, MapJson(map, files.Placement(), model));
  if (!options.memory_path.empty()) WriteMapMemory(options.memory_path, map.memory);
  progress.Finish();
  if (before) {
    LogInfo("The map of " + std::to_string(before->exposure.Gains().size()) +
            " pictures is continued: " + std::to_string(map.num_tiles_drawn) + " of " +
            std::to_string(map.num_tiles) + " tiles are drawn anew");
  }
  shelf.NameUnread(model, report);
  report->images_used = static_cast<int64_t>(map.pictures_used.size());
  report->inputs =
      DescribeModelInputs(pictures, num_pictures, options.input_path, options.run.num_threads);
  report->inputs.push_back(DescribeInput(options.cloud_path, options.cloud_path));
  return MapLine(map, files.Placement());
}

}  // namespace

void OrthomosaicMakerOptions::Bind(OptionTable* table) {
  table->AddRequired("image_path", &image_path, "folder of the pictures");
  table->AddRequired("input_path", &input_path, "COLMAP model, binary or text");
  table->AddRequired("cloud_path", &cloud_path, "cloud in the model's frame, PLY");
  table->AddRequired("output_path", &output_path,
                     "folder for orthomosaic.tif, dem.tif, source.tif, surface.tif, hillshade.png, "
                     "orthomosaic.jpg, map.json and run.json");
  table->Add("mask_path", &mask_path,
             "folder of masks <image name>.png, no colour from where a mask is 0; empty = none",
             "COLMAP (there StereoFusion.mask_path)");
  map.Bind(table);
  run.Bind(table);
  table->MarkOutput("output_path");
}

MadeMap MakeMap(const OrthomosaicMakerOptions& options) {
  Validate(options);
  MadeMap made;
  made.report = StartReport("orthomosaic", options, options.run);
  OutputFolder folder(options.output_path, "--output_path");
  folder.Claim(MapNames());
  {
    const StageTimer timer(&made.report, "orthomosaic");
    made.line = Make(options, &folder, &made.report);
  }
  WriteRunReport(folder.Path() / "run.json", made.report);
  return made;
}

CommandResult RunOrthomosaic(const OrthomosaicMakerOptions& options) {
  const MadeMap made = MakeMap(options);
  CommandResult result = ResultOf(made.report);
  result.text = made.line + "\n" + (fs::path(options.output_path) / kMapColors).string() + "\n";
  return result;
}

}  // namespace colmap_seapoint
