#include "colmap_seapoint/pipeline/tie_pictures.h"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/io/image/picture_masks.h"
#include "colmap_seapoint/mapping/second_chance.h"
#include "colmap_seapoint/pairing/tilted_pairs.h"
#include "colmap_seapoint/pipeline/job_size.h"
#include "colmap_seapoint/pipeline/match.h"
#include "feature/match_features.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Options = AutomaticReconstructorOptions;

// What became of the second chance: not known before all was tried.
enum class Outcome { kOpen, kTied, kInVain };

// A picture is told from another one of its name by its content, which the extraction hashes
// anyway: size and time may be the same (a restored copy), and times differ where nothing did (a
// moved survey).
struct SecondChance {
  std::set<std::string> untied;  // names
  std::string pictures;          // a hash of all pictures that they were found among
  TieCount before;               // how well the pictures hung together before it
  Outcome outcome = Outcome::kOpen;

  // Names of those that have SI-SeaPoints.
  std::set<std::string> Pictures() const {
    return outcome == Outcome::kInVain ? std::set<std::string>() : untied;
  }
};

void to_json(nlohmann::ordered_json& json, const SecondChance& chance) {
  json = {{"untied", chance.untied},
          {"pictures", chance.pictures},
          {"num_groups", chance.before.num_groups},
          {"num_between", chance.before.num_between},
          {"outcome", chance.outcome}};
}

void from_json(const nlohmann::ordered_json& json, SecondChance& chance) {
  json.at("untied").get_to(chance.untied);
  json.at("pictures").get_to(chance.pictures);
  json.at("num_groups").get_to(chance.before.num_groups);
  json.at("num_between").get_to(chance.before.num_between);
  json.at("outcome").get_to(chance.outcome);
}

std::string HashOf(const std::vector<RunReport::Input>& pictures) {
  std::string text;
  for (const RunReport::Input& picture : pictures) text += picture.name + " " + picture.hash + "\n";
  return HashText(text);
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

class PictureTies {
 public:
  PictureTies(const Options& options, const Workspace& workspace, const PictureSet& pictures,
              const Stage& database_stage, ColmapDatabase* database, WorkspaceState* state,
              RunReport* report)
      : options_(options),
        workspace_(workspace),
        pictures_(pictures),
        stage_({"second_chance", kMatchingVersion,
                StageFingerprint(database_stage) +
                    OptionsFingerprint(OptionValues(options.extraction)),
                ""}),
        database_(database),
        state_(state),
        report_(report) {}

  void Run() {
    auto chance = ResultIfDone<SecondChance>(*state_, stage_);
    Pass(chance ? chance->Pictures() : std::set<std::string>());
    if (!chance || chance->pictures != HashOf(report_->inputs)) {
      if (chance && !chance->Pictures().empty()) Pass({});
      state_->Forget(stage_.name);
      if (options_.extraction.num_levels > 1) return;
      chance = FindUntied();
      if (chance->outcome == Outcome::kOpen) Pass(chance->Pictures());
    }
    if (chance->outcome != Outcome::kOpen) return;
    TieByViews(*chance);
    Judge(&*chance);
  }

 private:
  // SeaPoints and matches of all pictures, and SI-SeaPoints beside them for those of these names.
  void Pass(const std::set<std::string>& names) {
    const RunReport extracted =
        ExtractPictures(ExtractorOptions(options_, workspace_), pictures_, names, database_);
    report_->images_in = extracted.images_in;
    report_->inputs = extracted.inputs;
    AddPart(extracted, report_);
    AddPart(MatchAll(options_, workspace_, pictures_.readable.size(), database_), report_);
  }

  SecondChance FindUntied() {
    SecondChance chance = {FindSecondChancePictures(*database_), HashOf(report_->inputs), {}};
    if (chance.untied.empty()) {
      chance.outcome = Outcome::kInVain;
    } else {
      chance.before = CountTies(*database_);
      LogInfo(std::to_string(chance.untied.size()) +
              " pictures are untied, or may tie one that is: SI-SeaPoints for them too");
    }
    FinishStage(stage_, chance, {}, state_);
    return chance;
  }

  // A tilt after the other, as long as the pictures hang together in more than one group.
  void TieByViews(const SecondChance& chance) {
    const Stage stage = {"tilted_views", kTiltedPairsVersion,
                         StageFingerprint(stage_) + chance.pictures, ""};
    std::set<uint32_t> ids;
    for (const DatabaseImage& image : ReadImages(*database_)) {
      if (chance.untied.count(image.name) > 0) ids.insert(image.image_id);
    }
    RunStage<int64_t>(state_, stage, [&]() -> StageOutput<int64_t> {
      if (ids.empty() || IsTiedAlready(*database_, ids)) return {0, {}};
      StageTimer timer(report_, stage.name);
      TiltedPairsJob job;
      job.read = [&, masks = PictureMasks(options_.reader.mask_path)](const std::string& name) {
        return ReadMasked(workspace_.images, masks, name);
      };
      job.extraction = options_.extraction;
      job.matching = options_.matching;
      job.num_threads = options_.run.num_threads;
      const int64_t num_tied = TieAll(job, ids, database_);
      LogInfo(std::to_string(num_tied) + " pairs of pictures were tied by views from above");
      return {num_tied, {}};
    });
  }

  void Judge(SecondChance* chance) {
    const bool has_tied = TiesMore(CountTies(*database_), chance->before);
    chance->outcome = has_tied ? Outcome::kTied : Outcome::kInVain;
    FinishStage(stage_, *chance, {}, state_);
    if (has_tied) return;
    LogInfo("Nothing ties them: the pictures are as they were before");
    Pass({});
  }

  const Options& options_;
  const Workspace& workspace_;
  const PictureSet& pictures_;
  Stage stage_;  // all that decides which are untied, but for what the pictures hold
  ColmapDatabase* database_;
  WorkspaceState* state_;
  RunReport* report_;
};

}  // namespace

FeatureExtractorOptions ExtractorOptions(const Options& options, const Workspace& workspace) {
  FeatureExtractorOptions extractor;
  extractor.database_path = workspace.database.string();
  extractor.image_path = workspace.images.string();
  extractor.reader = options.reader;
  extractor.extraction = options.extraction;
  extractor.run = options.run;
  return extractor;
}

void ExtractAndTie(const Options& options, const Workspace& workspace, const PictureSet& pictures,
                   const Stage& database_stage, ColmapDatabase* database, WorkspaceState* state,
                   RunReport* report) {
  PictureTies(options, workspace, pictures, database_stage, database, state, report).Run();
}

}  // namespace colmap_seapoint
