#include "colmap_seapoint/pipeline/tie_pictures.h"

#include <filesystem>
#include <map>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/mapping/second_chance.h"
#include "colmap_seapoint/pairing/tilted_pairs.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

MaskedPicture ReadMasked(const fs::path& folder, const std::string& mask_folder,
                         const std::string& name) {
  MaskedPicture read = {ReadGrayImage(folder / name), {}};
  const fs::path mask = fs::path(mask_folder) / (name + ".png");
  std::error_code ignored;
  if (!mask_folder.empty() && fs::exists(mask, ignored)) read.mask = ReadGrayImage(mask);
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

}  // namespace

void TiePictures(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                 const std::set<std::string>& second_chance_names, const std::string& inputs,
                 ColmapDatabase* database, WorkspaceState* state, RunReport* report) {
  const Stage stage = {"tilted_views", kTiltedPairsVersion, inputs, ""};
  std::set<uint32_t> ids;
  for (const DatabaseImage& image : ReadImages(*database)) {
    if (second_chance_names.count(image.name) > 0) ids.insert(image.image_id);
  }
  RunStage<int64_t>(state, stage, [&]() -> StageOutput<int64_t> {
    if (ids.empty() || IsTiedAlready(*database, ids)) return {0, {}};
    StageTimer timer(report, stage.name);
    TiltedPairsJob job;
    job.read = [&](const std::string& name) {
      return ReadMasked(workspace.images, options.reader.mask_path, name);
    };
    job.extraction = options.extraction;
    job.matching = options.matching;
    job.num_threads = options.run.num_threads;
    const int64_t num_tied = TieAll(job, ids, database);
    LogInfo(std::to_string(num_tied) + " pairs of pictures were tied by views from above");
    return {num_tied, {}};
  });
}

}  // namespace colmap_seapoint
