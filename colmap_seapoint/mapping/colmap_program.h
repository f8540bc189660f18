// The user's COLMAP: where it is, which it is, which options its mapper knows.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

using MapperOptions = std::map<std::string, std::string>;  // "Mapper.min_model_size" -> "3"

struct ColmapProgram {
  std::filesystem::path path;
  double timeout_seconds = 0;               // that one run of it may take; 0 = no limit
  std::string version;                      // its own first line, "COLMAP 3.8 (...)"
  bool has_global_mapper = false;           // 4.0 and later
  std::vector<std::string> mapper_options;  // names of both mappers, sorted, without "--"
  bool HasMapperOption(const std::string& name) const;
};

inline constexpr char kGlobalMapper[] = "global_mapper";

// Finds `colmap` (a path, or a name on PATH) and asks it for the options of its mappers, since
// their names change between versions. Throws Error when it is missing or does not answer as COLMAP
// does. Cost: two or three starts of the program, each within timeout_seconds.
ColmapProgram FindColmap(const std::string& colmap, double timeout_seconds = 0);

// Why this COLMAP cannot map pictures of a camera model: it is older than the model; "" when it
// can, or does not say which version it is.
std::string CameraModelProblem(const ColmapProgram& colmap, const CameraModelInfo& model);

// Appends "--name" and "value" for every option, in the order of their names.
void AppendOptions(const MapperOptions& options, std::vector<std::string>* arguments);

enum class Round { kFirst, kLater };

// What the mapper is given in a round: what suits SeaPoints (relaxed in later rounds) and what the
// effort asks for (how often it adjusts its models: "field" seldom, "survey" less than COLMAP does,
// "archive" as COLMAP does), as far as this version knows the options; then the user's options,
// which win. Throws UsageError for an option of the user's that this mapper does not know.
MapperOptions OptionsOfRound(const ColmapProgram& colmap, Round round, const std::string& effort,
                             int random_seed, const MapperOptions& user_options);

// The same for the global mapper, which has no rounds and no effort; nullopt where this COLMAP has
// none.
std::optional<MapperOptions> OptionsOfGlobalMapper(const ColmapProgram& colmap, int random_seed);

}  // namespace colmap_seapoint
