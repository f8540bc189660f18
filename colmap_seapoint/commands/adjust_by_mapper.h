// A global bundle adjustment by `colmap mapper`, where `colmap bundle_adjuster` would not repeat.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/commands/colmap_program.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {

struct MapperAdjustment {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;
  std::filesystem::path output_path;  // an empty folder; gets the model
  std::filesystem::path log_path;
};

// Takes one picture out of `model` and has the mapper register it again, with these options: that
// ends with a global adjustment of the whole model. The result may lack pictures: look.
SubprocessResult AdjustByMapper(const ColmapProgram& colmap, const SparseModel& model,
                                const MapperAdjustment& adjustment);

}  // namespace colmap_seapoint
