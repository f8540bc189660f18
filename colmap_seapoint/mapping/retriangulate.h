// The points of a model anew, its poses and lens as they are (ours, by colmap point_triangulator).
//
// While the mapper held the distortion, the corners of the pictures, which the lens bends most, lay
// too far off to be taken; once the lens is known they come in. And what then lies more than 1.5
// pixels off (kMaxError) is another corner beside the right one: SeaPoints lie right to 0.1 to 0.4
// pixels. On the demo survey the distortion k1 that the next adjustment finds comes from 1.5 %
// beside the truth to 0.4 %.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct TriangulationJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;           // as the mapper had them; its error limits, where given, stay
  std::filesystem::path log_path;  // without "_triangulation.log"
  bool must_succeed = false;
};

struct Triangulation {
  std::optional<SparseModel> model;  // as COLMAP wrote it; nullopt: it cannot be used
  std::string fault;                 // why it cannot be used, else ""
  bool has_failed = false;           // COLMAP ended with an error, or left no whole model
};

// `folder` holds `before` and stays as it is; COLMAP works in <folder>.triangulated meanwhile. The
// result is used when it has the same pictures and at least half as many points. That it finds
// little is no failure; when it fails otherwise (a full disk, killed): Error if it must succeed,
// else a warning, as with the mapper (mapper_process.h). Throws Error when COLMAP cannot be started
// or the log cannot be written. The same result every time: one thread.
Triangulation Retriangulate(const ColmapProgram& colmap, const TriangulationJob& job,
                            const std::filesystem::path& folder, const SparseModel& before);

}  // namespace colmap_seapoint
