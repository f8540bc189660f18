#include "colmap_seapoint/pipeline/orthomosaic/former_map.h"

#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/cloud_ranges.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/outputs/file_record.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_files.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_memory_file.h"
#include "colmap_seapoint/workspace/posed_pictures.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// A map is made from scratch when its survey has grown to more than so many times what frame, pixel
// size and brightness were found from.
constexpr size_t kMaxGrowth = 2;

struct MapRecord {
  std::vector<std::string> pictures;
  size_t first_pictures = 0;
  uint64_t num_points = 0;
  std::string points;  // their hash
  std::string memory;  // name of the file
  std::vector<FileRecord> rasters;
};

void to_json(nlohmann::ordered_json& json, const MapRecord& record) {
  nlohmann::ordered_json rasters = nlohmann::ordered_json::array();
  for (const FileRecord& file : record.rasters) {
    rasters.push_back({{"path", file.path}, {"size", file.size}, {"hash", file.hash}});
  }
  json = {{"pictures", record.pictures},     {"first_pictures", record.first_pictures},
          {"num_points", record.num_points}, {"points", record.points},
          {"memory", record.memory},         {"rasters", std::move(rasters)}};
}

void from_json(const nlohmann::ordered_json& json, MapRecord& record) {
  json.at("pictures").get_to(record.pictures);
  json.at("first_pictures").get_to(record.first_pictures);
  json.at("num_points").get_to(record.num_points);
  json.at("points").get_to(record.points);
  json.at("memory").get_to(record.memory);
  record.rasters.clear();
  for (const auto& file : json.at("rasters")) {
    record.rasters.push_back({file.at("path"), file.at("size"), file.at("hash")});
  }
}

Stage StageOf(const std::string& name, const std::string& options) {
  return {"map_to_continue_" + name, kOrthomosaicVersion, options, ""};
}

fs::path KeptFolder(const std::string& name, const WorkspaceState& state) {
  return state.StateFolder() / ("map_" + name + "_before");
}

std::string HashOfPoints(const fs::path& cloud, uint64_t num_points) {
  const CloudRanges ranges(cloud);
  if (ranges.NumPoints() < num_points) return "";
  return ranges.HashOfFirst(num_points);
}

// Moves what is still in the map's folder. False where one is neither here nor there as it was.
bool GatherRasters(const MapRecord& record, const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to, error);
  for (const FileRecord& file : record.rasters) {
    if (fs::exists(to / file.path, error) && RecordProblem(to, file).empty()) continue;
    if (!RecordProblem(from, file).empty()) return false;
    fs::rename(from / file.path, to / file.path, error);
    if (error) return false;
  }
  return true;
}

}  // namespace

std::optional<FormerMap> KeepFormerMap(const MapOrigin& origin, WorkspaceState* state) {
  const auto record = ResultIfDone<MapRecord>(*state, StageOf(origin.name, origin.options));
  if (!record || !BeginWith(origin.pictures, record->pictures)) return std::nullopt;
  if (origin.pictures.size() > kMaxGrowth * record->first_pictures) return std::nullopt;
  if (HashOfPoints(origin.cloud, record->num_points) != record->points) return std::nullopt;
  FormerMap former = {state->StateFolder() / record->memory, KeptFolder(origin.name, *state)};
  if (!GatherRasters(*record, origin.folder, former.folder)) return std::nullopt;
  return former;
}

fs::path MemoryPathOf(const MapOrigin& origin, const WorkspaceState& state) {
  std::string text = origin.options + origin.cloud_hash;
  for (const std::string& line : origin.pictures) text += "\n" + line;
  return state.StateFolder() / ("map_" + origin.name + "_" + HashText(text) + ".memory");
}

void RememberMap(const MapOrigin& origin, WorkspaceState* state) {
  const fs::path memory_path = MemoryPathOf(origin, *state);
  const MapMemory memory = ReadMapMemory(memory_path);
  MapRecord record;
  record.pictures = origin.pictures;
  record.first_pictures = memory.first_pictures;
  record.num_points = memory.num_points;
  record.points = HashOfPoints(origin.cloud, record.num_points);
  record.memory = memory_path.filename().string();
  std::vector<fs::path> rasters;
  for (const std::string& name : MapRasters()) rasters.push_back(origin.folder / name);
  record.rasters = RecordFiles(origin.folder, rasters);
  FinishStage(StageOf(origin.name, origin.options), record, {memory_path}, state);
}

void ForgetFormerMap(const std::string& name, bool all, WorkspaceState* state) {
  std::error_code ignored;
  fs::remove_all(KeptFolder(name, *state), ignored);
  const Stage stage = StageOf(name, "");
  if (all) state->Forget(stage.name);
  const auto record = state->Read(stage.name);
  const std::string memory = record ? record->value("/result/memory"_json_pointer, "") : "";
  for (const auto& entry : fs::directory_iterator(state->StateFolder(), ignored)) {
    const std::string file = entry.path().filename().string();
    const bool is_memory =
        file.rfind("map_" + name + "_", 0) == 0 && entry.path().extension() == ".memory";
    if (is_memory && file != memory) fs::remove(entry.path(), ignored);
  }
}

}  // namespace colmap_seapoint
