#include "colmap_seapoint/workspace/output_paths.h"

#include <string>
#include <variant>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/temporary_file.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/same_file.h"

namespace colmap_seapoint {
namespace {

// The path that the option gives; "" for others, and for one that is not given.
std::string PathOf(const OptionInfo& option) {
  static constexpr char kEnd[] = "_path";
  const size_t length = sizeof(kEnd) - 1;
  const std::string& name = option.name;
  if (name.size() < length || name.compare(name.size() - length, length, kEnd) != 0) return "";
  const auto* text = std::get_if<std::string*>(&option.target);
  return text == nullptr ? "" : **text;
}

}  // namespace

using Names = std::vector<std::string>;

Names CloudNames() { return {"fused.ply", "fused.ply.vis", "pairs.csv", kUnitsFile, "run.json"}; }

Names DenseMapNames(const Names& pictures) {
  Names names = {"stereo/fusion.cfg", "stereo/patch-match.cfg"};
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    names.push_back("sparse/" + std::string(file));
  }
  for (const std::string& picture : pictures) {
    for (const auto& path : {UndistortedImagePath("", picture), DepthMapPath("", picture),
                             NormalMapPath("", picture)}) {
      names.push_back(path.generic_string());
    }
  }
  return names;
}

Names ScaledModelNames() {
  Names names = ModelFileNames();
  names.insert(names.end(), {"scale.json", kUnitsFile, "run.json"});
  return names;
}

Names DifferenceNames() {
  return {"input_to_reference.ply", "reference_to_input.ply", "differences.png"};
}

std::filesystem::path FolderOf(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

void CheckOutputPaths(const OptionTable& table) {
  for (const OptionInfo& output : table.Options()) {
    const std::string path = PathOf(output);
    if (!output.is_output || path.empty()) continue;
    for (const OptionInfo& other : table.Options()) {
      const std::string other_path = PathOf(other);
      if (&other == &output || other_path.empty() || !IsSameFile(path, other_path)) continue;
      throw UsageError(output.name + " is the " + other.name + " (" + path +
                       "): it would be written over; name another place");
    }
  }
}

void CheckRunReport(const std::filesystem::path& path) {
  RemoveLeftovers(FolderOf(path));
  CheckReplaceable(path, "\"command\": \"", "move it away, or choose another --database_path");
}

}  // namespace colmap_seapoint
