// The inner loops of Refine: one tile of picture 1 against picture 2 warped by a predicted
// disparity. Vector code chosen at run time, the same result from every version.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "colmap_seapoint/base/image.h"
#include "densify/kernels/node_step.h"

namespace colmap_seapoint {
namespace tile {

inline constexpr int kMaxWindow = 15;
inline constexpr int kReach = 2;  // disparities tried on either side of the predicted one, pixels
inline constexpr int kWidth = 64, kHeight = 32;  // of a tile, pixels: at most
// Windows may be asked for half a window around a tile too.
inline constexpr int kWideWidth = kWidth + kMaxWindow - 1, kWideHeight = kHeight + kMaxWindow - 1;
inline constexpr int kRowStride = 96;  // floats between rows of results
inline constexpr int kNodesX = kWidth / kMinNodeStep + 2, kNodesY = kHeight / kMinNodeStep + 2;

// Predicted disparities of the tile's nodes and one row or column of nodes around; linear in
// between, and beyond the outermost. Node (0, 0) lies at pixel (-node_step / 2, -node_step / 2) of
// the tile. With a larger step only the first rows and columns are used.
struct Prediction {
  int node_step = kMinNodeStep;
  std::array<std::array<float, kNodesX>, kNodesY> disparity = {};

  int NodesX() const { return kWidth / node_step + 2; }
  int NodesY() const { return kHeight / node_step + 2; }
};

// Pictures rectified, as Rectify makes them: 0 outside the picture.
struct Pair {
  const GrayImage* gray1 = nullptr;
  const GrayImage* gray2 = nullptr;
  int column_shift = 0, row_shift = 0;  // column in gray2 = column in gray1 + shift - disparity
  int window = 9;                       // correlation window, pixels, odd
};

// The windows asked for: centred on the pixels of a rectangle, relative to the tile's first pixel;
// of its rows only first_row, first_row + row_step, ...
struct Region {
  int tile_x = 0, tile_y = 0;  // of the tile in gray1
  int x0 = 0, y0 = 0, width = 0, height = 0;
  int first_row = 0, row_step = 1;
};

// Of every window asked for, pixels of disparity but for the score.
struct Results {
  float* residual;
  float* score;
  float* deviation;
};

// The prediction at a pixel of the tile.
float PredictedAt(const Prediction& prediction, int x, int y);

// Zero-mean normalised cross-correlation of windows at the predicted disparity plus -kReach ..
// kReach, the window of picture 2 following the prediction's slope (slanted support). residual
// (true less predicted disparity), score, and deviation (of the residual): a row asked for every
// kRowStride floats; where there is no clear maximum, all 0. Exact integers up to the last
// division. If what the two windows differ in were noise of its own in each pixel, then 1 - score
// would be its share of the power, and residuals of n pixels would scatter by sqrt(2 (1 - score) /
// (n curvature)), curvature being that of the peak. That is the deviation; what it must be
// multiplied by where differences are not of that kind, is for the caller to know.
void Match(const Pair& pair, const Region& region, const Prediction& prediction,
           const Results& results);

}  // namespace tile
}  // namespace colmap_seapoint
