// The unmodified `colmap mapper` as a stage: database -> sparse models.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/io/run_report.h"

namespace colmap_seapoint {

struct ColmapProgram {
  std::filesystem::path path;
  std::string version;                      // its own first line, "COLMAP 3.8 (...)"
  std::vector<std::string> mapper_options;  // sorted names, without "--"
  bool HasMapperOption(const std::string& name) const;
};

// Finds `colmap` (a path, or a name on PATH) and asks it for its mapper's options, since their
// names move between versions. Throws Error when it is missing or does not answer.
ColmapProgram FindColmap(const std::string& colmap);

// The options that we give: those that suit SeaPoints and this version, then the user's, which
// win. Throws UsageError for one of the user's that this mapper does not know.
std::map<std::string, std::string> MapperOptions(
    const ColmapProgram& colmap, int random_seed,
    const std::map<std::string, std::string>& user_options);

struct MapperJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  std::filesystem::path output_path;  // holds 0/, 1/ ... afterwards
  std::filesystem::path log_path;
  std::map<std::string, std::string> options;
  int num_images = 0;  // for the progress
};

// Writes into <output_path>.tmp (removed first when an earlier run left it) and renames when the
// mapper is done. Throws Error when the mapper fails or finds no model: what and what to do.
void RunMapper(const ColmapProgram& colmap, const MapperJob& job);

// Model folders below `sparse`, by number.
std::vector<std::filesystem::path> ListModels(const std::filesystem::path& sparse);

}  // namespace colmap_seapoint
