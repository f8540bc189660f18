// The cloud as the page shows it: some of its points, in 9 bytes each.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

inline constexpr uint64_t kPagePoints = 300000;  // 3.6 MB of the page

// Which points of a cloud of `total` are shown: about `wanted` of them, spread as the cloud is, the
// same ones every time.
class PointChooser {
 public:
  PointChooser(uint64_t total, uint64_t wanted);
  bool Takes(uint64_t index) const;

 private:
  uint64_t limit_;  // of 2^32
};

struct ColoredPoint {
  Eigen::Vector3d xyz;  // world
  std::array<uint8_t, 3> rgb;
};

// Positions are low + step * code, in the plan (PlanFrame).
struct PackedCloud {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double step = 1;             // units
  std::vector<uint8_t> codes;  // three 16-bit numbers a point, little-endian
  std::vector<uint8_t> colors;
};

// What lies outside of all but a thousandth of the points at either end of an axis is left out, so
// that a stray one does not make the rest coarse.
PackedCloud PackCloud(const std::vector<ColoredPoint>& points,
                      const Eigen::Matrix3d& map_from_world);

}  // namespace colmap_seapoint
