// How far a picture that has just come in overlaps the last ones (the paper's section 4: when the
// overlap falls to critical levels, whoever steers is told to slow down or to go back to a known
// place). It needs nothing but the pictures' own SeaPoints: no model, no database.
#pragma once

#include <cstddef>
#include <deque>
#include <string>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/frames/frame_view.h"

namespace colmap_seapoint {

// Below it, ground along a track is seen by one picture alone.
inline constexpr double kLeastOverlap = 0.5;

struct NewOverlap {
  bool is_first = false;  // nothing to compare it with
  double overlap = 0;     // 0 to 1, the largest with one of the last pictures
  std::string warning;    // what to do about it; empty: it is enough
};

class OverlapWatch {
 public:
  // The picture becomes the last one. Cost: 10 CPU ms a megapixel, and 4 for each of the last three
  // pictures.
  NewOverlap Add(const std::string& name, const GrayImage& picture);

 private:
  struct Seen {
    std::string name;
    FrameView view;
  };
  std::deque<Seen> last_;
};

}  // namespace colmap_seapoint
