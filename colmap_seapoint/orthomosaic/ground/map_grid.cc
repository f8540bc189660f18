#include "colmap_seapoint/orthomosaic/ground/map_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/orthomosaic/ground/no_map.h"

namespace colmap_seapoint {
namespace {

constexpr double kTrim = 0.001;
constexpr double kMargin = 0.02;

struct Interval {
  double low, high;
};

Interval TrimmedInterval(std::vector<double> values) {
  const auto skip = static_cast<std::ptrdiff_t>(kTrim * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + skip, values.end());
  const double low = values[static_cast<size_t>(skip)];
  std::nth_element(values.begin(), values.end() - 1 - skip, values.end());
  const double high = values[values.size() - 1 - static_cast<size_t>(skip)];
  const double margin = kMargin * (high - low);
  return {low - margin, high + margin};
}

Interval ExtentAlong(const std::vector<Eigen::Vector3d>& sample, int axis) {
  std::vector<double> values;
  values.reserve(sample.size());
  for (const Eigen::Vector3d& xyz : sample) values.push_back(xyz[axis]);
  return TrimmedInterval(std::move(values));
}

[[noreturn]] void ThrowTooLarge(double width, double height, double pixel_size) {
  const double factor = std::max(width, height) / kMaxMapSide;
  std::ostringstream finding, remedy;
  finding << "would be of " << width << " x " << height << " pixels, more than " << kMaxMapSide
          << " a side";
  remedy.precision(3);
  remedy << "give a pixel size of " << 1.01 * factor * pixel_size << " or more (now " << pixel_size
         << "), or cut the cloud to what is to be mapped";
  throw NoMap("the map", finding.str(), remedy.str());
}

// The place of step `index` on Hilbert's curve through a square of `side` (a power of two) cells.
std::array<int, 2> HilbertPlace(int side, int64_t index) {
  int x = 0, y = 0;
  for (int s = 1; s < side; s *= 2, index /= 4) {
    const int right = static_cast<int>(index / 2) & 1;
    const int up = static_cast<int>(index ^ right) & 1;
    if (up == 0) {
      if (right == 1) {
        x = s - 1 - x;
        y = s - 1 - y;
      }
      std::swap(x, y);
    }
    x += s * right;
    y += s * up;
  }
  return {x, y};
}

}  // namespace

MapGrid::Box MapGrid::Tile(int tile_idx) const {
  const int x = tile_idx % NumTilesX() * tile_size, y = tile_idx / NumTilesX() * tile_size;
  return {x, y, std::min(tile_size, width - x), std::min(tile_size, height - y)};
}

MapGrid MakeMapGrid(const std::vector<Eigen::Vector3d>& sample, double pixel_size) {
  SEAPOINT_CHECK(!sample.empty() && std::isfinite(pixel_size) && pixel_size > 0);
  const Interval x = ExtentAlong(sample, 0), y = ExtentAlong(sample, 1);
  const double first_column = std::floor(x.low / pixel_size);
  const double first_row = std::floor(-y.high / pixel_size);
  const double width = std::floor(x.high / pixel_size) - first_column + 1;
  const double height = std::floor(-y.low / pixel_size) - first_row + 1;
  if (!(width <= kMaxMapSide && height <= kMaxMapSide)) ThrowTooLarge(width, height, pixel_size);
  MapGrid grid;
  grid.left = first_column * pixel_size;
  grid.top = -first_row * pixel_size;
  grid.pixel_size = pixel_size;
  grid.width = static_cast<int>(width);
  grid.height = static_cast<int>(height);
  return grid;
}

std::vector<int> TilesAlongCurve(const MapGrid& grid) {
  int side = 1;
  while (side < std::max(grid.NumTilesX(), grid.NumTilesY())) side *= 2;
  std::vector<int> tiles;
  tiles.reserve(static_cast<size_t>(grid.NumTiles()));
  for (int64_t i = 0; i < int64_t{side} * side; ++i) {
    const auto [x, y] = HilbertPlace(side, i);
    if (x < grid.NumTilesX() && y < grid.NumTilesY()) tiles.push_back(y * grid.NumTilesX() + x);
  }
  return tiles;
}

}  // namespace colmap_seapoint
