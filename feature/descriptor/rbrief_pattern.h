// The 256 tests of rBRIEF (ours: in place of ORB's learned table): 8 tests, each in 32 turns of
// 11.25 degrees about the SeaPoint, the first four on the picture, the others on its half. So
// turning the picture by one step moves every bit of a 32-bit word to the next place: a descriptor
// is turned without looking at the picture again.
#pragma once

#include <array>
#include <cstdint>

namespace colmap_seapoint {

inline constexpr int kPatternRadius = 32;  // pixels: of the disc that holds all tests
inline constexpr int kNumTurns = 32;       // steps of a full turn
inline constexpr double kTurnStep = 6.283185307179586 / kNumTurns;  // radians, from x towards y

struct RBriefTest {
  std::array<int8_t, 2> first;  // x, y from the SeaPoint, pixels of the test's scale
  std::array<int8_t, 2> second;
};

// The tests from this one on read the picture at half its size.
inline constexpr int kFirstCoarseTest = 128;

// Test 32 w + k is test 32 w turned by k steps (to the nearest pixel).
const std::array<RBriefTest, 256>& RBriefPattern();

}  // namespace colmap_seapoint
