#include "colmap_seapoint/base/natural_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace colmap_seapoint {
namespace {

TEST(NaturalLess, CountsAsAPersonDoes) {
  EXPECT_TRUE(NaturalLess("img2.jpg", "img10.jpg"));
  EXPECT_FALSE(NaturalLess("img10.jpg", "img2.jpg"));
  EXPECT_TRUE(NaturalLess("a1/b9", "a1/b10"));
  EXPECT_TRUE(NaturalLess("a9/b", "a10/a"));
  EXPECT_TRUE(NaturalLess("img", "img1"));
  EXPECT_TRUE(NaturalLess("1", "a"));
  EXPECT_TRUE(NaturalLess("99999999999999999999998", "99999999999999999999999"));
  EXPECT_TRUE(NaturalLess("a07b2", "a7b10"));
}

TEST(NaturalLess, IsAStrictTotalOrder) {
  const std::string names[] = {"",     "0", "00", "7",   "07",  "7a",  "07a", "7a1",
                               "7a01", "a", "a0", "a00", "a-1", "a/1", "A1",  "10"};
  for (const std::string& a : names) {
    EXPECT_FALSE(NaturalLess(a, a));
    for (const std::string& b : names) {
      EXPECT_EQ(a != b, NaturalLess(a, b) != NaturalLess(b, a)) << a << " " << b;
      for (const std::string& c : names) {
        if (NaturalLess(a, b) && NaturalLess(b, c)) {
          EXPECT_TRUE(NaturalLess(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

TEST(NaturalLess, SortsAWholeFolderAsItWasTaken) {
  std::vector<std::string> names;
  for (int i = 1; i <= 120; ++i) names.push_back("dive/IMG_" + std::to_string(i) + ".JPG");
  std::vector<std::string> shuffled = names;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  ASSERT_NE(shuffled, names);
  std::sort(shuffled.begin(), shuffled.end(), NaturalLess);
  EXPECT_EQ(shuffled, names);
}

TEST(NaturalLess, BytesBeyondAsciiComeLast) {
  EXPECT_TRUE(NaturalLess("z", "\xc3\xbc"));
  EXPECT_FALSE(NaturalLess("\xc3\xbc", "z"));
}

}  // namespace
}  // namespace colmap_seapoint
