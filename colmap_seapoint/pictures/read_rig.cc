#include "colmap_seapoint/pictures/read_rig.h"

#include <filesystem>
#include <map>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kNoRig[] = "none";

struct RigFolders {
  std::string left, right;
};

std::string WithoutSlashes(std::string folder) {
  while (!folder.empty() && folder.back() == '/') folder.pop_back();
  return folder;
}

RigFolders Split(const std::string& rig) {
  const size_t comma = rig.find(',');
  if (comma == std::string::npos) return {};
  return {WithoutSlashes(rig.substr(0, comma)), WithoutSlashes(rig.substr(comma + 1))};
}

bool NamesFolders(const std::string& rig) { return !rig.empty() && rig != kNoRig; }

std::map<std::string, std::string> ReadSimultaneousNames(const RigFolders& folders,
                                                         const std::string& image_path) {
  std::vector<std::string> names[2];
  const std::string both[2] = {folders.left, folders.right};
  for (int i = 0; i < 2; ++i) {
    const fs::path path = fs::path(image_path) / both[i];
    if (!fs::is_directory(path)) {
      throw Error(path.string(), "there is no such folder of pictures",
                  "give --rig LEFT,RIGHT, two folders inside --image_path");
    }
    names[i] = ListImages(path);
  }
  auto simultaneous = SimultaneousNames(names[0], names[1]);
  if (!simultaneous.empty()) return simultaneous;
  throw Error(image_path,
              "no picture of " + folders.left + " (" + std::to_string(names[0].size()) +
                  " pictures) has a simultaneous one in " + folders.right + " (" +
                  std::to_string(names[1].size()) + " pictures)",
              "give simultaneous pictures the same name in both folders, or names that differ "
              "only by digits and as many pictures in both");
}

// Newer versions of COLMAP may write them otherwise, which is no reason to refuse a model.
std::vector<Frame> ReadFramesIfSound(const std::string& model_path, const SparseModel& model) {
  try {
    return ReadFrames(model_path, model);
  } catch (const Error& error) {
    LogWarning(std::string(error.what()) + "; no stereo rig is taken from it");
    return {};
  }
}

}  // namespace

const char kRigHelp[] =
    "stereo rig: LEFT,RIGHT, two folders inside image_path whose pictures of the same name (or, "
    "where only digits differ, in the same order) were taken at the same moment; empty = from the "
    "model's frames, if it has any; none = no rig";

std::string CheckRig(const std::string& rig) {
  if (!NamesFolders(rig)) return "";
  const RigFolders folders = Split(rig);
  if (IsSafeImageName(folders.left) && IsSafeImageName(folders.right) &&
      folders.left != folders.right && folders.right.find(',') == std::string::npos) {
    return "";
  }
  return "rig is '" + rig + "', it must be LEFT,RIGHT: two different folders inside image_path";
}

void CheckRigFolders(const std::string& rig, const std::string& image_path) {
  if (NamesFolders(rig)) ReadSimultaneousNames(Split(rig), image_path);
}

StereoRig ReadRig(const std::string& rig, const std::string& image_path,
                  const std::string& model_path, const SparseModel& model) {
  if (rig == kNoRig) return {};
  if (!NamesFolders(rig)) {
    StereoRig from_frames = RigFromFrames(model, ReadFramesIfSound(model_path, model));
    if (from_frames.NumPairs() > 0) {
      LogInfo("Stereo rig: " + std::to_string(from_frames.NumPairs()) +
              " frames of the model hold a left and a right picture");
    }
    return from_frames;
  }
  const RigFolders folders = Split(rig);
  StereoRig from_names =
      RigFromNames(model, folders.left, folders.right, ReadSimultaneousNames(folders, image_path));
  if (from_names.NumPairs() > 0) return from_names;
  LogWarning("no two simultaneous pictures of " + folders.left + " and " + folders.right +
             " are in the model: its pictures are taken as a sequence");
  return {};
}

}  // namespace colmap_seapoint
