#include "colmap_seapoint/workspace/workspace_database.h"

#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (!error) return;
  throw Error(path.string(), "cannot be removed (" + error.message() + ")",
              "check the folder's permissions");
}

// Removes the database together with SQLite's journals, because a left-over journal would be played
// into the new database.
void RemoveDatabase(const fs::path& path) {
  for (const char* suffix : {"-wal", "-shm", "-journal", ""}) Remove(path.string() + suffix);
}

void CopyFeatures(const ColmapDatabase& from, const std::vector<RegisteredPicture>& pictures,
                  ColmapDatabase* to) {
  std::map<std::string, uint32_t> old_ids;
  for (const DatabaseImage& image : ReadImages(from)) old_ids[image.name] = image.image_id;
  DatabaseTransaction transaction(to);
  for (const RegisteredPicture& picture : pictures) {
    const auto old_id = old_ids.find(picture.name);
    if (old_id == old_ids.end()) continue;
    const auto fingerprint = FeaturesFingerprint(from, old_id->second);
    const auto features = ReadFeatures(from, old_id->second);
    if (fingerprint && features) WriteFeatures(to, picture.image_id, *features, *fingerprint);
  }
  transaction.Commit();
}

// Made in the folder of the records and renamed: a run that is killed meanwhile begins anew.
void BeginAnew(const fs::path& path, const fs::path& state_folder,
               const std::vector<ReadablePicture>& pictures, const ImageReaderOptions& reader) {
  LogInfo("Pictures, cameras or matching changed: the database is begun anew, SeaPoints are kept");
  const fs::path fresh_path = state_folder / "fresh.db";
  RemoveDatabase(fresh_path);
  {
    // Plays its journal in; a run that was stopped early has left it empty.
    const ColmapDatabase old(path, ColmapDatabase::Mode::kCreateIfMissing);
    ColmapDatabase fresh(fresh_path, ColmapDatabase::Mode::kCreateIfMissing);
    // The extraction reports what is left out here.
    RunReport ignored;
    const auto registered = RegisterPictures(pictures, reader, &fresh, &ignored);
    CopyFeatures(old, registered, &fresh);
    fresh.Finish();
  }
  RemoveDatabase(path);
  fs::rename(fresh_path, path);
}

// Whether all that the database was begun with is among the inputs, and models were made of it.
bool HasGrown(const DatabaseInputs& inputs, const Stage& stage, const WorkspaceState& state) {
  const auto begun = state.Read(stage.name);
  if (!begun || !state.Read("mapper")) return false;
  try {
    const auto& were = begun->at("result");
    if (were.at("options") != inputs.options) return false;
    const std::set<std::string> are(inputs.pictures.begin(), inputs.pictures.end());
    for (const std::string picture : were.at("pictures")) {
      if (are.count(picture) == 0) return false;
    }
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;  // an earlier version kept nothing of it
  }
}

}  // namespace

ColmapDatabase OpenWorkspaceDatabase(const fs::path& database_path,
                                     const std::vector<ReadablePicture>& pictures,
                                     const ImageReaderOptions& reader, const Stage& stage,
                                     const DatabaseInputs& inputs, WorkspaceState* state) {
  state->Folder()->Claim({database_path.filename().string()});
  if (!ReadIfDone(*state, stage)) {
    if (fs::exists(database_path) && HasGrown(inputs, stage, *state)) {
      LogInfo("Pictures came in: those that were there keep their SeaPoints and matches");
    } else if (fs::exists(database_path)) {
      BeginAnew(database_path, state->StateFolder(), pictures, reader);
    }
    FinishStage(stage, {{"options", inputs.options}, {"pictures", inputs.pictures}}, {}, state);
  }
  return ColmapDatabase(database_path, ColmapDatabase::Mode::kCreateIfMissing);
}

std::string DatabaseFingerprint(const ColmapDatabase& database) {
  std::string text;
  for (const DatabaseImage& image : ReadImages(database)) {
    text += std::to_string(image.image_id) + " " + std::to_string(image.camera_id) + " " +
            image.name + " " + FeaturesFingerprint(database, image.image_id).value_or("") + "\n";
  }
  ContentHash hash;
  hash.Add(text.data(), text.size());
  for (const auto& [camera_id, camera] : ReadCameras(database)) {
    const int numbers[] = {static_cast<int>(camera_id), static_cast<int>(camera.model),
                           camera.width, camera.height, camera.has_prior_focal_length ? 1 : 0};
    hash.Add(numbers, sizeof(numbers));
    hash.Add(camera.params.data(), camera.params.size() * sizeof(double));
  }
  return hash.Text();
}

}  // namespace colmap_seapoint
