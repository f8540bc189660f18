#include "colmap_seapoint/cameras/sensor_table.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

// By the makers' data sheets: 1/2.3 inch (6.17 x 4.55 mm), full frame (35.9 x 24 mm), one inch
// (13.2 x 8.8 mm), Four Thirds (17.3 x 13 mm).
TEST(SensorTableTest, KnownCameras) {
  const auto tough = FindSensor("OLYMPUS CORPORATION", "TG-6");
  ASSERT_TRUE(tough);
  EXPECT_NEAR(tough->diagonal_mm, 7.67, 0.15);
  EXPECT_TRUE(tough->is_four_thirds);
  const auto full = FindSensor("SONY", "ILCE-7M3");
  ASSERT_TRUE(full);
  EXPECT_NEAR(full->diagonal_mm, 43.2, 0.5);
  EXPECT_FALSE(full->is_four_thirds);
  const auto inch = FindSensor("SONY", "DSC-RX100M5");
  ASSERT_TRUE(inch);
  EXPECT_NEAR(inch->diagonal_mm, 15.86, 0.2);
  EXPECT_FALSE(inch->is_four_thirds);
  const auto micro = FindSensor("Panasonic", "DMC-GF6");
  ASSERT_TRUE(micro);
  EXPECT_NEAR(micro->diagonal_mm, 21.6, 0.3);
  EXPECT_TRUE(micro->is_four_thirds);
}

TEST(SensorTableTest, FirmsChangeTheirNamesAndTheirLetters) {
  const auto one = FindSensor("OLYMPUS IMAGING CORP.", "TG-4");
  ASSERT_TRUE(one);
  EXPECT_EQ(one->diagonal_mm, FindSensor("Olympus Corporation", "tg-4")->diagonal_mm);
  EXPECT_TRUE(FindSensor("NIKON CORPORATION", "NIKON D850"));
}

TEST(SensorTableTest, OthersAreNotKnown) {
  EXPECT_FALSE(FindSensor("", ""));
  EXPECT_FALSE(FindSensor("", "TG-6"));
  EXPECT_FALSE(FindSensor("SONY", "TG-6"));
  EXPECT_FALSE(FindSensor("Sea", "Eye"));
  EXPECT_FALSE(FindSensor("SONY", std::string(100000, 'x')));
}

}  // namespace
}  // namespace colmap_seapoint
