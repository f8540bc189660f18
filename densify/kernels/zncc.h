// Zero-mean normalised cross-correlation of square windows: exact integers up to the last division.
// It is blind to gain and offset, which differ between pictures under moving light. Vector code
// chosen at run time, the same result from every version.
#pragma once

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {
namespace zncc {

inline constexpr int kMaxWindow = 15;
inline constexpr int kMaxRun = 8;

// Scores, -1..1, of the window of picture 1 centred on (x1, y1) against the windows of picture 2
// centred on (x2, y2), (x2 + 1, y2) ... (x2 + count - 1, y2), count <= kMaxRun; -1 where either
// window has no texture, or the one of picture 2 a corner of 0: outside the picture. Windows are
// `size` pixels wide, odd, 5 .. kMaxWindow, and lie in the rasters; the 16 bytes behind a window's
// last one must exist, though they do not count. Cost: about 50 ns with windows of 7, any count.
void ScoreRun(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2, int y2,
              int size, int count, float* scores);

}  // namespace zncc
}  // namespace colmap_seapoint
