// What a user may set of the choice of a video's frames; the ranges stand in the .cc file.
#pragma once

#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

struct FrameSelectionOptions {
  double overlap = 0.78;  // of a frame with the last chosen one, 0 to 1, at which it is due

  void Bind(OptionTable* table);
};

}  // namespace colmap_seapoint
