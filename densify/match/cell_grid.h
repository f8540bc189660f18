// A picture divided into square cells, and what is known of each before a pair is densified: the
// resolution at which overlap (paper 2.5) and coverage (ours) are kept.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

struct CellGrid {
  int cell = 1;  // pixels
  int width = 0, height = 0;

  CellGrid() = default;
  CellGrid(int picture_width, int picture_height, int cell_size)
      : cell(cell_size),
        width((picture_width + cell_size - 1) / cell_size),
        height((picture_height + cell_size - 1) / cell_size) {}

  size_t Size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  // The cell of a pixel position, which is clamped into the picture.
  size_t IndexOf(double x, double y) const {
    const int a = std::clamp(static_cast<int>(x) / cell, 0, width - 1);
    const int b = std::clamp(static_cast<int>(y) / cell, 0, height - 1);
    return static_cast<size_t>(b) * static_cast<size_t>(width) + static_cast<size_t>(a);
  }
  Eigen::Vector2d Center(size_t index) const {
    const size_t a = index % static_cast<size_t>(width), b = index / static_cast<size_t>(width);
    return {(static_cast<double>(a) + 0.5) * cell, (static_cast<double>(b) + 0.5) * cell};
  }
};

// Pixels between the samples of a picture: `step` when it is not 0, else what gives about 0.75
// million samples a picture.
int SampleStep(const Camera& camera, int step);

// The cells of a picture that is sampled so: 4 x 4 samples each, 8 pixels wide at least.
CellGrid CellsOf(const Camera& camera, int step);

// The cells of picture 1 that earlier pairs have reconstructed, in one of two ways. Either vector
// may be empty: then no cell is known in that way.
struct KnownCells {
  CellGrid grid;
  std::vector<uint8_t> closed;  // 1: nothing is matched there (paper 2.5, the overlap mask)
  // Distance of the known surface from the camera's centre, world units, 0 where none is known
  // (ours): there only what differs from that surface is reconstructed.
  std::vector<float> covered_range;
  // Where the surface runs away from the camera within a cell, the distance of its farthest part;
  // empty: as covered_range.
  std::vector<float> covered_far = {};

  bool IsClosed(size_t cell) const { return !closed.empty() && closed[cell] != 0; }
  bool IsCovered(size_t cell) const { return !covered_range.empty() && covered_range[cell] > 0; }
  float FarthestCovered(size_t cell) const {
    return covered_far.empty() ? covered_range[cell] : covered_far[cell];
  }
  bool IsNew(size_t cell) const { return !IsClosed(cell) && !IsCovered(cell); }
};

}  // namespace colmap_seapoint
