// The map before, kept beside the stages' records while the next one is made of it: a run that is
// killed meanwhile goes on with the same one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/workspace/stage_runner.h"

namespace colmap_seapoint {

// What a map is made of: what it continues, and what continues it, begins with the same.
struct MapOrigin {
  std::string name;                   // of the model: "0"
  std::string options;                // of map and cloud, with their versions
  std::vector<std::string> pictures;  // posed_pictures.h
  std::filesystem::path cloud;
  std::string cloud_hash;
  std::filesystem::path folder;  // of the map
};

struct FormerMap {
  std::filesystem::path memory;  // map_memory_file.h
  std::filesystem::path folder;  // of its rasters
};

// Moves the rasters of the map in origin.folder to where they stay until ForgetFormerMap(). nullopt
// where there is no map to continue: none was remembered of these options, of these pictures' first
// ones and at least half as many, and of the cloud's first points; or its files are not as they
// were.
std::optional<FormerMap> KeepFormerMap(const MapOrigin& origin, WorkspaceState* state);

// Where the map of that origin leaves its memory.
std::filesystem::path MemoryPathOf(const MapOrigin& origin, const WorkspaceState& state);

// After the map was made, and its memory written.
void RememberMap(const MapOrigin& origin, WorkspaceState* state);

// What the last map of the model continued is needed no more; with `all` nor is it to be continued.
void ForgetFormerMap(const std::string& name, bool all, WorkspaceState* state);

}  // namespace colmap_seapoint
