#include "densify/completeness/surface/smooth_surface.h"

#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr int kReach = 2;
constexpr double kMinAgreeing = 3;
constexpr double kStep = 0.5;  // cells' sides

int NumAgreeing(const GroundLayer& layer, int x, int y, double cell_side) {
  const GroundCell* cell = layer.cells.Find(x, y);
  if (cell == nullptr || !cell->is_coherent) return 0;
  int num_agreeing = 0;
  for (int k = 0; k < 9; ++k) {
    const GroundCell* next = layer.cells.Find(x + k % 3 - 1, y + k / 3 - 1);
    if (k == 4 || next == nullptr || !next->is_coherent) continue;
    num_agreeing += std::abs(next->height - cell->height) <= kStep * cell_side ? 1 : 0;
  }
  return num_agreeing;
}

}  // namespace

bool IsSmoothAround(const GroundLayer& layer, int x, int y, double cell_side) {
  int num_agreeing = 0, num_cells = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      num_agreeing += NumAgreeing(layer, x + dx, y + dy, cell_side);
      ++num_cells;
    }
  }
  return num_agreeing >= kMinAgreeing * num_cells;
}

}  // namespace colmap_seapoint
