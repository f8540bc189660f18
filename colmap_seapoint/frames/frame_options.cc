#include "colmap_seapoint/frames/frame_options.h"

namespace colmap_seapoint {

void FrameSelectionOptions::Bind(OptionTable* table) {
  table->Add("FrameSelection.overlap", &overlap,
             "of a video: the overlap with the last chosen frame, 0 to 1, at which the next one is "
             "due; the sharpest near that place is taken",
             "paper 1, ours", 0.5, 0.95);
}

}  // namespace colmap_seapoint
