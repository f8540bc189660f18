#include "feature/descriptor/rbrief_pattern.h"

#include <cmath>

namespace colmap_seapoint {

namespace {

// Drawn at random, at most 14 pixels long: the best of 60 draws on two synthetic surveys, a turbid
// one with caustics and snow and a clear one at two steps' distance. Low-contrast ground needs the
// wide disc; short tests survive relief and uneven light better than long ones.
constexpr std::array<RBriefTest, 8> kBaseTests = {{{{-2, 25}, {-11, 15}},
                                                   {{20, -20}, {22, -18}},
                                                   {{11, -29}, {20, -24}},
                                                   {{-4, -11}, {-2, -13}},
                                                   {{10, -27}, {7, -26}},
                                                   {{-2, -16}, {-3, -17}},
                                                   {{-5, 3}, {-5, 2}},
                                                   {{-7, 16}, {-19, 21}}}};

std::array<int8_t, 2> Turn(const std::array<int8_t, 2>& point, int steps) {
  const double c = std::cos(steps * kTurnStep), s = std::sin(steps * kTurnStep);
  return {static_cast<int8_t>(std::lround(c * point[0] - s * point[1])),
          static_cast<int8_t>(std::lround(s * point[0] + c * point[1]))};
}

std::array<RBriefTest, 256> MakePattern() {
  std::array<RBriefTest, 256> pattern{};
  for (size_t bit = 0; bit < pattern.size(); ++bit) {
    const RBriefTest& base = kBaseTests[bit / kNumTurns];
    const int steps = static_cast<int>(bit % kNumTurns);
    pattern[bit] = {Turn(base.first, steps), Turn(base.second, steps)};
  }
  return pattern;
}

}  // namespace

const std::array<RBriefTest, 256>& RBriefPattern() {
  static const std::array<RBriefTest, 256> pattern = MakePattern();
  return pattern;
}

}  // namespace colmap_seapoint
