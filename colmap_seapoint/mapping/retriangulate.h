// The points of a model anew, its poses and lens as they are (ours, by colmap point_triangulator).
// While the mapper held the distortion, what the lens bends most, in the corners, lay too far off
// to be taken; once the lens is known, it comes in. And what then lies more than kMaxError off is
// another corner beside the right one: SeaPoints lie right to 0.1 to 0.4 pixels. On the demo survey
// the distortion k1 that the next adjustment finds comes from 1.5 % beside the truth to 0.4 %.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct TriangulationJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;           // as the mapper had them; its error limits, where given, stay
  std::filesystem::path log_path;  // without ".log"
};

// The result takes the model's place when it has the same pictures and at least half as many
// points.
// "", or why the model is as it was. The same result every time: one thread.
std::string Retriangulate(const ColmapProgram& colmap, const TriangulationJob& job,
                          const std::filesystem::path& model);

}  // namespace colmap_seapoint
