// A second dive: the passes of completeness_reporter's gaps.geojson, photographed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct DivePasses {
  // Poses and names ("pass_<gap>_<number>.<image_format>"); ids are still to be given. As many a
  // line as the pass says, evenly from end to end, the camera down, ahead up in the picture; as
  // unsteady as a survey's, by `jitter` and `seed`.
  std::vector<PosedImage> images;
  // Of walls and undersides: the file does not say to which side the camera is tilted.
  int num_tilted = 0;
};

// Throws Error for what is no gaps.geojson of ours in the model's own frame.
DivePasses PlanPasses(const std::filesystem::path& gaps_geojson, const std::string& image_format,
                      int seed, double jitter);

}  // namespace colmap_seapoint
