#include "colmap_seapoint/watch/small_copy.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

TEST(SmallCopy, IsOfMeans) {
  ColorImage picture(1301, 1002, 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      for (int c = 0; c < 3; ++c) picture.At(x, y, c) = static_cast<uint8_t>((x + 2 * y + c) % 200);
    }
  }
  const ColorImage copy = SmallCopy(picture);
  EXPECT_EQ(copy.width, 650);
  EXPECT_EQ(copy.height, 501);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(copy.At(10, 5, c), (20 + 20 + c) + 2);  // 1.5, rounded
}

TEST(SmallCopy, OfASmallPictureIsThatPicture) {
  ColorImage picture(1119, 30, 3);
  picture.At(1118, 29, 2) = 7;
  const ColorImage copy = SmallCopy(picture);
  EXPECT_EQ(copy.width, 1119);
  EXPECT_EQ(copy.At(1118, 29, 2), 7);
}

}  // namespace
}  // namespace colmap_seapoint
