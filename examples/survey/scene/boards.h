// Boards with coded markers that lie on the seabed: the ends of scale bars.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/markers/marker_name.h"
#include "examples/survey/scene/height_field.h"

namespace colmap_seapoint {

// A level square: the marker, and around it a white margin one cell wide.
struct MarkerBoard {
  MarkerName name;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // world, metres
  double turn = 0;  // of the print, radians, counter-clockwise seen from above
  double size = 0;  // side of the black square, metres

  double HalfWidth() const;  // of the board, margin included, metres
  // The corners of the board, world.
  std::array<Eigen::Vector3d, 4> Corners() const;
  // The print's colour at a place, 0 (black) to 1; nullopt beside the board.
  std::optional<float> ShadeAt(double x, double y) const;
};

struct BoardOptions {
  uint64_t seed = 1;
  double bar_length = 1;     // metres between the centres on the map
  double marker_size = 0.1;  // metres
};

// A bar of two boards about each of the places, on the ground there: bar k has the markers 2 k and
// 2 k + 1 of tag36h11. They lie as high as the highest place below them.
std::vector<MarkerBoard> MakeBars(const std::vector<Eigen::Vector2d>& places,
                                  const BoardOptions& options, const HeightField& ground);

// The same ground with the boards on it, exactly level.
HeightField WithBoards(const HeightField& ground, const std::vector<MarkerBoard>& boards);

}  // namespace colmap_seapoint
