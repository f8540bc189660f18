// The 256 tests of rBRIEF (ours: drawn here instead of ORB's learned table). Both points lie in a
// disc, at most kMaxTestLength apart. Measured on real underwater strips against Gaussian patterns
// and shorter discs: low-contrast ground needs the wide disc, and short tests survive relief and
// uneven light better than long ones.
#pragma once

#include <array>
#include <cstdint>

namespace colmap_seapoint {

inline constexpr int kPatternRadius = 26;  // pixels
inline constexpr int kMaxTestLength = 16;  // pixels

struct RBriefTest {
  std::array<int8_t, 2> first;  // x, y from the SeaPoint, orientation 0
  std::array<int8_t, 2> second;
};

// The same table on every platform (std::mt19937 is specified to the bit).
const std::array<RBriefTest, 256>& RBriefPattern();

}  // namespace colmap_seapoint
