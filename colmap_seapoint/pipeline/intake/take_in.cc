#include "colmap_seapoint/pipeline/intake/take_in.h"

#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "colmap_seapoint/io/image/image_folder.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pipeline/intake/decode_copies.h"
#include "colmap_seapoint/pipeline/intake/take_frames.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kTakeInStage[] = "take_in";

// Below the workspace; another one where the user keeps his pictures in the first.
fs::path FolderForPictures(const Workspace& workspace, WorkspaceState* state) {
  std::error_code ignored;
  const char* name =
      fs::equivalent(workspace.images, workspace.root / "images", ignored) ? "pictures" : "images";
  state->Folder()->Claim({name});
  return workspace.root / name;
}

// What an earlier run made of other pictures.
void RemoveOthers(const std::set<std::string>& names, OutputFolder* folder) {
  for (const fs::path& path : FilesOfOurs(folder->Path())) {
    const std::string name = path.lexically_relative(folder->Path()).generic_string();
    if (names.count(name) == 0) folder->Remove(name);
  }
}

std::vector<Clip> ClipsOf(const fs::path& given, const FolderListing& listing) {
  if (fs::is_directory(given)) return OrderClips(given, listing.videos);
  return OrderClips(given.parent_path(), {given.filename().string()});
}

}  // namespace

void TakeInPictures(const TakeInOptions& options, Workspace* workspace, WorkspaceState* state,
                    RunReport* report) {
  const fs::path given = workspace->images;
  const FolderListing listing = fs::is_directory(given) ? ListFolder(given) : FolderListing();
  const bool has_pictures = !listing.pictures.empty() || !listing.camera_pictures.empty();
  const bool is_video = !fs::is_directory(given) || (!has_pictures && !listing.videos.empty());
  if (!is_video && listing.camera_pictures.empty()) return;

  const StageTimer timer(report, kTakeInStage);
  const fs::path target = FolderForPictures(*workspace, state);
  OutputFolder folder(target, "--workspace_path");
  std::set<std::string> names;
  FolderListing others = listing;
  (is_video ? others.videos : others.camera_pictures).clear();
  LeaveOutOtherFiles(others, report);
  if (is_video) {
    names = TakeFrames(ClipsOf(given, listing), options.frames, options.num_threads, &folder, state,
                       report);
  } else {
    names = DecodeCopies(given, listing, options.num_threads, &folder, state, report);
  }
  RemoveOthers(names, &folder);
  workspace->images = target;
}

}  // namespace colmap_seapoint
