#include "colmap_seapoint/disk/spare_data.h"

#include <string>
#include <system_error>

#include "colmap_seapoint/workspace/earlier_outputs.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

bool IsThere(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  return entries;
}

// All of these are the workspace's own (Workspace::Names).
std::vector<fs::path> HalfMade(const Workspace& workspace, JobPart part) {
  std::vector<fs::path> paths;
  const std::string database = workspace.database.string(), sparse = workspace.sparse.string();
  if (part != JobPart::kDatabase) paths.emplace_back(database + ".tmp");
  if (part != JobPart::kModels) {
    paths.emplace_back(sparse + ".tmp");
    paths.emplace_back(sparse + ".tmp.db");
  }
  return paths;
}

// Folders and files in state/, where all is ours (map_<model>_before, map_<model>_<hash>.memory).
std::vector<fs::path> MapMemories(const fs::path& state) {
  std::vector<fs::path> paths;
  for (const fs::path& path : EntriesOf(state)) {
    const std::string name = path.filename().string();
    const bool is_kept = name.size() > 7 && name.compare(name.size() - 7, 7, "_before") == 0;
    if (name.rfind("map_", 0) == 0 && (is_kept || path.extension() == ".memory")) {
      paths.push_back(path);
    }
  }
  return paths;
}

// Files in state/ (pipeline/completeness/facts_file.h).
std::vector<fs::path> PictureFacts(const fs::path& state) {
  std::vector<fs::path> paths;
  for (const fs::path& path : EntriesOf(state)) {
    if (path.filename().string().rfind("picture_facts_", 0) == 0) paths.push_back(path);
  }
  return paths;
}

void RemoveAll(const std::vector<fs::path>& paths) {
  std::error_code ignored;  // what stays is no worse than before
  for (const fs::path& path : paths) fs::remove_all(path, ignored);
}

void RemoveWatched(const fs::path& watched) {
  for (const fs::path& cloud : EntriesOf(watched / "dense")) RemoveOutputs(cloud);
  RemoveOutputs(watched);
}

void AddIfThere(const std::string& what, const std::vector<fs::path>& paths,
                std::vector<SpareData>* spare) {
  std::vector<fs::path> there;
  for (const fs::path& path : paths) {
    if (IsThere(path)) there.push_back(path);
  }
  if (there.empty()) return;
  spare->push_back({what, there.front(), [there] { RemoveAll(there); }});
}

}  // namespace

std::vector<SpareData> SpareDataOf(const Workspace& workspace, JobPart part) {
  std::vector<SpareData> spare;
  AddIfThere("what an interrupted run left half made", HalfMade(workspace, part), &spare);
  const fs::path watched = workspace.root / "watch";
  if (IsThere(watched / "database.db")) {
    spare.push_back({"database, models and clouds of the coarse survey in " + watched.string(),
                     watched, [watched] { RemoveWatched(watched); }});
  }
  if (part != JobPart::kReport) {
    AddIfThere("what was measured in the pictures", PictureFacts(workspace.root / "state"), &spare);
  }
  if (part != JobPart::kMaps) {
    AddIfThere("what maps are continued from when their survey grows",
               MapMemories(workspace.root / "state"), &spare);
  }
  return spare;
}

}  // namespace colmap_seapoint
