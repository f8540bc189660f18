#include "densify/match/cell_grid.h"

#include <cmath>

#include "densify/kernels/node_step.h"

namespace colmap_seapoint {

namespace {

constexpr double kSamplesPerPicture = 0.75e6;
constexpr int kSamplesPerCell = 4;          // along each side
constexpr int kMinCell = 2 * kMinNodeStep;  // pixels: a cell holds nodes

}  // namespace

int SampleStep(const Camera& camera, int step) {
  if (step > 0) return step;
  const double pixels = static_cast<double>(camera.width) * camera.height;
  return std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / kSamplesPerPicture))));
}

CellGrid CellsOf(const Camera& camera, int step) {
  const int cell = std::max(kMinCell, kSamplesPerCell * SampleStep(camera, step));
  return CellGrid(camera.width, camera.height, cell);
}

}  // namespace colmap_seapoint
