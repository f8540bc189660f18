// What the choice of frames looks at: a reduced frame's SeaPoints and sharpness, and how far two
// frames show the same (the paper's spatial sampling, section 1: by overlap, not by time).
#pragma once

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct FrameView {
  int width = 0, height = 0;  // of the reduced frame
  Features features;          // in its pixels
  double sharpness = 0;       // Sharpness()
};

// Mean square of the brightness differences over two pixels, across and down: blur of either kind,
// defocus or motion, lowers it several times. Comparable between frames that show about the same.
double Sharpness(const GrayImage& gray);

// About 600 SeaPoints. Cost: about 6 CPU ms for 960x540.
FrameView ViewOf(const GrayImage& gray);

// How much of `first` is still seen in `second`, 0 to 1: the share of the frame's area that is in
// both, after the similarity transform that the matches tell, less what parallax moves the matches
// against each other (so a camera that circles an object, with all of it in view, sees less and
// less of what it saw). 0 when the two cannot be matched. Cost: about 4 CPU ms.
double OverlapOf(const FrameView& first, const FrameView& second);

}  // namespace colmap_seapoint
