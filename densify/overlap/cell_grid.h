// A picture divided into square cells: the resolution at which overlap and coverage are kept.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

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

}  // namespace colmap_seapoint
