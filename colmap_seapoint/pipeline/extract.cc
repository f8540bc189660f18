#include "colmap_seapoint/pipeline/extract.h"

#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/pairing/tilted_pairs.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/workspace/output_paths.h"
#include "feature/extract_features.h"

namespace colmap_seapoint {
namespace {

constexpr char kCommand[] = "feature_extractor";
// Prefix of the fingerprint of a picture that could not be read, so that the next run tries it
// again.
constexpr char kUnreadable[] = "unreadable:";
constexpr char kNoSeaPoint[] = "has no SeaPoint: it shows no texture, or its mask covers it";

struct Extracted {
  bool is_unchanged = false;
  std::string reason;  // why it cannot be used; empty = it can
  std::string fingerprint;
  RunReport::Input input;
  Features features;
};

std::filesystem::path ReportPath(const FeatureExtractorOptions& options) {
  return options.database_path + "." + kCommand + ".run.json";
}

// Finds the SeaPoints of one picture. All that they depend on is fixed for the run, except the
// picture itself.
class Extractor {
 public:
  Extractor(const FeatureExtractorOptions& options, std::set<std::string> second_chance_names)
      : options_(options),
        masks_(options.reader.mask_path),
        second_chance_names_(std::move(second_chance_names)),
        hash_of_options_(OptionsFingerprint(OptionValues(options.extraction))) {}

  // Called from several threads at once. `stored`: the fingerprint in the database. The picture is
  // read once: what is hashed is what is decoded.
  Extracted Extract(const std::string& name, const std::optional<std::string>& stored) const {
    const auto picture_path = std::filesystem::path(options_.image_path) / name;
    const bool is_second_chance = second_chance_names_.count(name) > 0;
    Extracted result;
    std::string mask_hash;
    try {
      const PictureFile file(picture_path);
      result.input = {name, file.Size(), file.Hash()};
      const std::optional<PictureFile> mask = masks_.Open(name);
      if (mask) mask_hash = mask->Hash();
      result.fingerprint = Fingerprint(result.input, mask_hash, is_second_chance);
      result.is_unchanged =
          stored == result.fingerprint || stored == result.fingerprint + kTiltedMark;
      if (result.is_unchanged) return result;
      // Its SeaPoints take less than decoding it does.
      const MemoryShare share(2 * file.BytesToDecode());
      const GrayImage picture = file.DecodeGray();
      const GrayImage mask_picture = masks_.Decode(name, mask, picture.width, picture.height);
      result.features = is_second_chance
                            ? ExtractSecondChance(picture, mask_picture, options_.extraction)
                            : ExtractFeatures(picture, mask_picture, options_.extraction).features;
      if (result.features.points.empty()) result.reason = kNoSeaPoint;
    } catch (const Error& error) {
      if (result.input.name.empty()) result.input = DescribeInput(name, picture_path);
      result.reason = error.Finding();
      result.fingerprint = kUnreadable + Fingerprint(result.input, mask_hash, is_second_chance);
    }
    return result;
  }

 private:
  std::string Fingerprint(const RunReport::Input& picture, const std::string& mask_hash,
                          bool is_second_chance) const {
    return kExtractionVersion + (":" + std::to_string(picture.size)) + ":" + picture.hash + ":" +
           mask_hash + ":" + hash_of_options_ + (is_second_chance ? kSecondChanceMark : "");
  }

  const FeatureExtractorOptions& options_;
  PictureMasks masks_;
  std::set<std::string> second_chance_names_;
  std::string hash_of_options_;
};

void Validate(const FeatureExtractorOptions& options) {
  CheckOutputPaths(options);
  CheckRunReport(ReportPath(options));
  for (const std::string& problem : {options.reader.Check(), options.extraction.Check()}) {
    if (!problem.empty()) throw UsageError(problem);
  }
}

// Throws before anything is written.
void RefuseForeignKeypoints(const std::string& database_path,
                            const std::vector<ReadablePicture>& pictures,
                            const ColmapDatabase& database) {
  std::map<std::string, uint32_t> ids;
  for (const DatabaseImage& image : ReadImages(database)) ids[image.name] = image.image_id;
  for (const ReadablePicture& picture : pictures) {
    const auto id = ids.find(picture.name);
    if (id == ids.end() || !HasFeatures(database, id->second)) continue;
    if (FeaturesFingerprint(database, id->second) && ReadFeatures(database, id->second)) continue;
    throw Error(database_path, "holds keypoints of other software for " + picture.name,
                "choose a new --database_path: they are never overwritten, and one database holds "
                "one kind of keypoints (partial_densifier needs none of ours in it)");
  }
}

void ExtractAll(const Extractor& extractor, int num_threads,
                const std::vector<RegisteredPicture>& pictures, ColmapDatabase* database,
                RunReport* report) {
  std::vector<std::optional<std::string>> stored;
  for (const RegisteredPicture& picture : pictures) {
    stored.push_back(FeaturesFingerprint(*database, picture.image_id));
  }
  const auto count = static_cast<int64_t>(pictures.size());
  int64_t num_unchanged = 0;
  Progress progress("SeaPoints of pictures", count, 0, Work::kPictures);
  OrderedPipeline<Extracted>(
      num_threads, count, 2 * num_threads,
      [&](int64_t i) {
        const auto index = static_cast<size_t>(i);
        return extractor.Extract(pictures[index].name, stored[index]);
      },
      [&](int64_t i, Extracted&& result) {
        const RegisteredPicture& picture = pictures[static_cast<size_t>(i)];
        if (result.is_unchanged) {
          ++num_unchanged;
          const auto features = ReadFeatures(*database, picture.image_id);
          if (!features || features->points.empty()) result.reason = kNoSeaPoint;
        } else {
          DatabaseTransaction transaction(database);
          WriteFeatures(database, picture.image_id, result.features, result.fingerprint);
          transaction.Commit();
        }
        if (result.reason.empty()) ++report->images_used;
        if (!result.reason.empty()) LeaveOut(picture.name, result.reason, report);
        report->inputs.push_back(std::move(result.input));
        progress.Update(i + 1);
      });
  progress.Finish();
  if (num_unchanged > 0) {
    LogInfo(std::to_string(num_unchanged) + " pictures were there already and are unchanged");
  }
}

// Writes the report; throws Error when no picture is usable.
void Finish(const FeatureExtractorOptions& options, const RunReport& report) {
  WriteRunReport(ReportPath(options), report);
  if (report.images_used > 0) return;
  throw Error(options.image_path,
              "none of its " + std::to_string(report.images_in) + " pictures can be used (" +
                  report.left_out.front().name + ": " + report.left_out.front().reason + ")",
              "copy them from the camera's card once more");
}

}  // namespace

void FeatureExtractorOptions::Bind(OptionTable* table) {
  table->AddRequired("database_path", &database_path,
                     "COLMAP database; created when it does not exist");
  table->AddRequired("image_path", &image_path, "folder of the pictures, sub-folders included");
  table->Add("image_list_path", &image_list_path,
             "text file with the names of the pictures to take, one a line; empty = all", "COLMAP");
  reader.Bind(table);
  extraction.Bind(table);
  run.Bind(table);
  table->MarkOutput("database_path");
}

PictureSet ReadPictureSet(const FeatureExtractorOptions& options) {
  Validate(options);
  RunReport report = StartReport(kCommand, options, options.run);
  PictureSet pictures;
  const auto names = ListPictures(options.image_path, options.image_list_path, &report);
  pictures.readable = ReadHeaders(options.image_path, names, options.run.num_threads, &report);
  pictures.num_listed = report.images_in;
  pictures.left_out = report.left_out;
  if (pictures.readable.empty()) Finish(options, report);
  PictureMasks(options.reader.mask_path).Check(names, "--ImageReader.mask_path");
  return pictures;
}

RunReport ExtractPictures(const FeatureExtractorOptions& options, const PictureSet& pictures,
                          const std::set<std::string>& second_chance_names,
                          ColmapDatabase* database) {
  RunReport report = StartReport(kCommand, options, options.run);
  report.images_in = pictures.num_listed;
  report.left_out = pictures.left_out;
  {
    StageTimer timer(&report, kCommand);
    RefuseForeignKeypoints(options.database_path, pictures.readable, *database);
    const auto registered = RegisterPictures(pictures.readable, options.reader, database, &report);
    ExtractAll(Extractor(options, second_chance_names),
               EffectiveNumThreads(options.run.num_threads), registered, database, &report);
    database->Finish();
  }
  Finish(options, report);
  return report;
}

CommandResult RunFeatureExtractor(const FeatureExtractorOptions& options) {
  const PictureSet pictures = ReadPictureSet(options);
  const RunLock lock = LockFile(options.database_path, "--database_path");
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kCreateIfMissing);
  return ResultOf(ExtractPictures(options, pictures, {}, &database));
}

}  // namespace colmap_seapoint
