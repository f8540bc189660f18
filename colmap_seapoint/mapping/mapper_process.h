// One run of COLMAP's mapper, or of its global one, as a child.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct MapperCall {
  std::string command;  // "mapper" or "global_mapper"
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  std::filesystem::path input_path;   // of the model that is continued, and of nothing else (the
                                      // list of pictures is put there); empty = begun anew
  std::filesystem::path output_path;  // an empty folder; gets 0/, 1/ ..., or the continued model
  MapperOptions options;
  std::vector<std::string> pictures;  // the only ones to be mapped; empty = all
  size_t num_pictures = 0;            // that there are to be mapped, for the progress line
  std::filesystem::path log_path;
  bool must_succeed = false;
};

struct MapperEnd {
  bool is_usable = false;  // what it left, which may be nothing
  std::string text;        // how it ended, and its last message
};

// Runs it. That it finds no model is no failure, though COLMAP exits with 1 for it and says so.
// When it fails otherwise: Error if it must succeed, for a full disk, say, must not lead to other
// models than the next run would find; else a warning, since what earlier runs have found stands.
// Throws UsageError when it refuses an option's value.
MapperEnd RunMapperProcess(const ColmapProgram& colmap, const MapperCall& call);

// Model folders below `sparse`, in natural order; empty when there is no such folder.
std::vector<std::filesystem::path> ListModels(const std::filesystem::path& sparse);

}  // namespace colmap_seapoint
