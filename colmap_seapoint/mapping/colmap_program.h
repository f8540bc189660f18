// The user's COLMAP: where it is, which it is, which options its mapper knows.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace colmap_seapoint {

using MapperOptions = std::map<std::string, std::string>;  // "Mapper.min_model_size" -> "3"

struct ColmapProgram {
  std::filesystem::path path;
  std::string version;                      // its own first line, "COLMAP 3.8 (...)"
  bool has_global_mapper = false;           // 4.0 and later
  std::vector<std::string> mapper_options;  // of both mappers; sorted names, without "--"
  bool HasMapperOption(const std::string& name) const;
};

inline constexpr char kGlobalMapper[] = "global_mapper";

// Finds `colmap` (a path, or a name on PATH) and asks it for its mapper's options, since their
// names move between versions. Throws Error when it is missing or does not answer.
ColmapProgram FindColmap(const std::string& colmap);

// "--name value" of every option, behind the arguments there are.
void AppendOptions(const MapperOptions& options, std::vector<std::string>* arguments);

enum class Round { kFirst, kLater };

// What the mapper is given in a round: what suits SeaPoints (of later rounds: relaxed) and the
// effort ("field", "survey" or "archive": how often it adjusts its models), as far as this version
// knows it, then the user's options, which win. Throws UsageError for one of the user's that this
// mapper does not know.
MapperOptions OptionsOfRound(const ColmapProgram& colmap, Round round, const std::string& effort,
                             int random_seed, const MapperOptions& user_options);

// nullopt where this COLMAP has no global mapper.
std::optional<MapperOptions> OptionsOfGlobalMapper(const ColmapProgram& colmap, int random_seed);

}  // namespace colmap_seapoint
