#include "densify/kernels/patch_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

using patch::kBefore;
using patch::kSize;
using patch::Placement;
using patch::Sums;
using patch::Template;

// Random grey values, 1..255, some of them at the ends; the buffer ends with the last pixel, so
// that a sanitizer sees whatever is read beyond.
GrayImage RandomPicture(int width, int height, std::mt19937* generator) {
  GrayImage picture(width, height);
  for (uint8_t& value : picture.data) {
    const unsigned random = (*generator)();
    value = static_cast<uint8_t>(random % 8 == 0 ? (random & 8 ? 255 : 1) : 1 + random / 8 % 255);
  }
  return picture;
}

// By their names: a Sums has no padding, but a failure shall name what differs.
void ExpectSame(const Sums& one, const Sums& other) {
  EXPECT_EQ(one.gray, other.gray);
  EXPECT_EQ(one.gray_gray, other.gray_gray);
  EXPECT_EQ(one.across, other.across);
  EXPECT_EQ(one.down, other.down);
  EXPECT_EQ(one.across_across, other.across_across);
  EXPECT_EQ(one.across_down, other.across_down);
  EXPECT_EQ(one.down_down, other.down_down);
  EXPECT_EQ(one.gray_across, other.gray_across);
  EXPECT_EQ(one.gray_down, other.gray_down);
  EXPECT_EQ(one.other, other.other);
  EXPECT_EQ(one.other_other, other.other_other);
  EXPECT_EQ(one.gray_other, other.gray_other);
  EXPECT_EQ(one.across_other, other.across_other);
  EXPECT_EQ(one.down_other, other.down_other);
}

// The definition of patch::SumTemplate and patch::SumOther, a pixel at a time.
class Oracle {
 public:
  explicit Oracle(const Template& of) : of_(of) {}

  Sums OfTemplate() const {
    Sums sums;
    for (size_t k = 0; k < patch::kPixels; ++k) {
      const int32_t gray = of_.gray[k], across = of_.across[k], down = of_.down[k];
      sums.gray += gray;
      sums.across += across;
      sums.down += down;
      sums.gray_gray += gray * gray;
      sums.across_across += across * across;
      sums.across_down += across * down;
      sums.down_down += down * down;
      sums.gray_across += gray * across;
      sums.gray_down += gray * down;
    }
    return sums;
  }

  void AddOther(const GrayImage& picture, const Placement& placement, Sums* sums) const {
    size_t k = 0;
    for (int j = -kBefore; j < kSize - kBefore; ++j) {
      for (int i = -kBefore; i < kSize - kBefore; ++i, ++k) {
        const int32_t other =
            Bilinear(picture, placement.x + i * placement.x_across + j * placement.x_down,
                     placement.y + i * placement.y_across + j * placement.y_down) -
            128;
        sums->other += other;
        sums->other_other += other * other;
        sums->gray_other += of_.gray[k] * other;
        sums->across_other += of_.across[k] * other;
        sums->down_other += of_.down[k] * other;
      }
    }
  }

 private:
  // Weights in 256ths, rounded down; the value to the nearest, both exact in doubles.
  static int32_t Bilinear(const GrayImage& picture, int32_t x, int32_t y) {
    const double at_x = std::floor(x / 256.0) / 256, at_y = std::floor(y / 256.0) / 256;
    const int column = static_cast<int>(std::floor(at_x)), row = static_cast<int>(std::floor(at_y));
    const double u = at_x - column, v = at_y - row;
    const auto mix = [&](int line) {
      return (1 - u) * picture.At(column, line) + u * picture.At(column + 1, line);
    };
    return static_cast<int32_t>(std::floor((1 - v) * mix(row) + v * mix(row + 1) + 0.5));
  }

  const Template& of_;
};

// nullopt where a pixel that the patch or its gradient needs is not there.
std::optional<Template> DefinedTemplate(const GrayImage& gray, int x, int y) {
  bool is_whole = true;
  const auto at = [&](int column, int row) -> int32_t {
    const int32_t value = gray.Contains(column, row) ? gray.At(column, row) : 0;
    is_whole = is_whole && value > 0;
    return value;
  };
  Template defined;
  size_t k = 0;
  for (int row = y - kBefore; row < y - kBefore + kSize; ++row) {
    for (int column = x - kBefore; column < x - kBefore + kSize; ++column, ++k) {
      defined.gray[k] = at(column, row) - 128;
      defined.across[k] = at(column + 1, row) - at(column - 1, row);
      defined.down[k] = at(column, row + 1) - at(column, row - 1);
    }
  }
  return is_whole ? std::optional(defined) : std::nullopt;
}

// At every pixel of small pictures, some with a hole, and around them.
TEST(PatchKernelsTest, TemplatesAreWhole) {
  std::mt19937 generator(1);
  int num_whole = 0, num_not = 0;
  for (int trial = 0; trial < 60; ++trial) {
    GrayImage gray = RandomPicture(3 + trial % 27, 3 + trial * 7 % 24, &generator);
    for (int hole = 0; hole < trial % 3; ++hole) gray.data[generator() % gray.data.size()] = 0;
    for (int y = -12; y < gray.height + 12; ++y) {
      for (int x = -12; x < gray.width + 12; ++x) {
        Template made;
        const auto defined = DefinedTemplate(gray, x, y);
        ASSERT_EQ(MakeTemplate(gray, x, y, &made), defined.has_value()) << x << " " << y;
        ++(defined ? num_whole : num_not);
        if (!defined) continue;
        ASSERT_EQ(made.gray, defined->gray);
        ASSERT_EQ(made.across, defined->across);
        ASSERT_EQ(made.down, defined->down);
      }
    }
  }
  EXPECT_GT(num_whole, 1000);
  EXPECT_GT(num_not, 1000);
}

// The lowest and the highest that the patch reaches from its middle, along one axis.
std::array<int32_t, 2> ReachOf(int32_t across, int32_t down) {
  std::array<int32_t, 2> reach = {0, 0};
  for (const int i : {-kBefore, kSize - 1 - kBefore}) {
    for (const int j : {-kBefore, kSize - 1 - kBefore}) {
      reach[0] = std::min(reach[0], i * across + j * down);
      reach[1] = std::max(reach[1], i * across + j * down);
    }
  }
  return reach;
}

// Of the positions where the patch lies a pixel within `size` pixels: the first one, the last one
// or any.
int32_t PlaceWithin(int size, const std::array<int32_t, 2>& reach, std::mt19937* generator) {
  const int32_t first = 65536 - reach[0], last = 65536 * (size - 1) - 1 - reach[1];
  switch ((*generator)() % 3) {
    case 0:
      return first;
    case 1:
      return last;
    default:
      return std::uniform_int_distribution<int32_t>(first, last)(*generator);
  }
}

// Turned by any angle, at half to twice the scale, squeezed a little, mirrored at times.
Placement RandomPlacement(const GrayImage& picture, std::mt19937* generator) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double angle = M_PI * unit(*generator), scale = std::exp2(std::round(unit(*generator)));
  const double squeeze = 1 + 0.2 * unit(*generator), mirror = (*generator)() % 4 ? 1 : -1;
  const auto fixed = [](double value) { return static_cast<int32_t>(std::lround(65536 * value)); };
  Placement placement;
  placement.x_across = fixed(scale * std::cos(angle));
  placement.y_across = fixed(scale * std::sin(angle));
  placement.x_down = fixed(-mirror * squeeze * scale * std::sin(angle));
  placement.y_down = fixed(mirror * squeeze * scale * std::cos(angle));
  placement.x =
      PlaceWithin(picture.width, ReachOf(placement.x_across, placement.x_down), generator);
  placement.y =
      PlaceWithin(picture.height, ReachOf(placement.y_across, placement.y_down), generator);
  return placement;
}

TEST(PatchKernelsTest, SumsEqualTheDefinitionWithAnyVectors) {
  std::mt19937 generator(2);
  for (int trial = 0; trial < 3000; ++trial) {
    SCOPED_TRACE(trial);
    const GrayImage gray = RandomPicture(10, 10, &generator);
    const GrayImage picture = RandomPicture(36 + trial % 5, 36 + trial % 7, &generator);
    const Placement placement = RandomPlacement(picture, &generator);
    Template of;
    ASSERT_TRUE(MakeTemplate(gray, 1 + kBefore, 1 + kBefore, &of));
    const Oracle oracle(of);
    Sums defined = oracle.OfTemplate();
    ForEachVectorTarget([&] { ExpectSame(SumTemplate(of), defined); });
    oracle.AddOther(picture, placement, &defined);
    ForEachVectorTarget([&] {
      Sums sums = SumTemplate(of);
      SumOther(of, picture, placement, &sums);
      ExpectSame(sums, defined);
    });
    if (HasFailure()) return;
  }
}

// The strongest contrast, in the picture's first, its last and its middle place.
TEST(PatchKernelsTest, StrongestContrastDoesNotOverflow) {
  GrayImage gray(10, 10);
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) gray.At(x, y) = (x + y) / 2 % 2 ? 255 : 1;
  }
  Template of;
  ASSERT_TRUE(MakeTemplate(gray, 5, 5, &of));
  for (const int32_t at : {5, 5 + 32767 - 12}) {
    GrayImage picture(at == 5 ? 10 : 32767, 10, 1, uint8_t{255});
    for (int y = 0; y < 10; ++y) {
      for (int x = 0; x < 10; ++x) picture.At(at - 5 + x, y) = gray.At(x, y);
    }
    const Placement placement = {65536 * at, 65536 * 5, 65536, 0, 0, 65536};
    Sums defined = Oracle(of).OfTemplate();
    Oracle(of).AddOther(picture, placement, &defined);
    EXPECT_EQ(defined.gray_other, defined.gray_gray);
    ForEachVectorTarget([&] {
      Sums sums = SumTemplate(of);
      SumOther(of, picture, placement, &sums);
      ExpectSame(sums, defined);
    });
  }
}

}  // namespace
}  // namespace colmap_seapoint
