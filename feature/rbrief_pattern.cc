#include "feature/rbrief_pattern.h"

#include <random>

namespace colmap_seapoint {

namespace {

std::array<RBriefTest, 256> DrawPattern() {
  std::mt19937 generator(7);
  auto draw_point = [&generator] {
    const auto side = static_cast<uint32_t>(2 * kPatternRadius + 1);
    while (true) {
      const int x = static_cast<int>(generator() % side) - kPatternRadius;
      const int y = static_cast<int>(generator() % side) - kPatternRadius;
      if (x * x + y * y <= kPatternRadius * kPatternRadius) {
        return std::array<int8_t, 2>{static_cast<int8_t>(x), static_cast<int8_t>(y)};
      }
    }
  };
  std::array<RBriefTest, 256> pattern{};
  for (RBriefTest& test : pattern) {
    int squared_length = 0;
    do {
      test.first = draw_point();
      test.second = draw_point();
      const int dx = test.first[0] - test.second[0], dy = test.first[1] - test.second[1];
      squared_length = dx * dx + dy * dy;
    } while (squared_length == 0 || squared_length > kMaxTestLength * kMaxTestLength);
  }
  return pattern;
}

}  // namespace

const std::array<RBriefTest, 256>& RBriefPattern() {
  static const std::array<RBriefTest, 256> pattern = DrawPattern();
  return pattern;
}

}  // namespace colmap_seapoint
