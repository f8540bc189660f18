#include "colmap_seapoint/cameras/camera_presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <sstream>

namespace colmap_seapoint {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

TEST(CameraPresetsTest, FocalLengthsAreThoseOfPublishedFieldsOfView) {
  // GoPro wide: 118 degrees across in 16 to 9, of an equidistant lens.
  const CameraPreset& wide = *FindCameraPreset("gopro_wide_dome");
  EXPECT_EQ(wide.model, CameraModel::kOpenCVFisheye);
  EXPECT_NEAR(0.5 / wide.focal / kDegree, 118.0 / 2, 5);
  // 25 mm of 35 mm film, by the diagonal: 82 degrees.
  const CameraPreset& tough = *FindCameraPreset("tg6_flatport");
  EXPECT_NEAR(2 * std::atan(0.5 * 1.25 / tough.focal) / kDegree,
              2 * std::atan(0.5 * 43.27 / 25) / kDegree, 0.5);
  const CameraPreset& full = *FindCameraPreset("a7_28mm_dome");
  EXPECT_NEAR(2 * std::atan(0.5 * std::hypot(1, 2.0 / 3) / full.focal) / kDegree, 75, 0.5);
}

TEST(CameraPresetsTest, AFlatPortNarrowsTheViewAndADomeDoesNot) {
  EXPECT_NEAR(WaterFactor(Port::kFlat), 1.333, 0.01);
  EXPECT_EQ(WaterFactor(Port::kDome), 1);
  EXPECT_EQ(FindCameraPreset("flatport")->focal, 0);
  EXPECT_TRUE(FindCameraPreset("flatport")->believes_exif);
}

TEST(CameraPresetsTest, AnUnknownNameGivesTheNearest) {
  EXPECT_EQ(FindCameraPreset(""), nullptr);
  EXPECT_EQ(FindCameraPreset("gopro_wide"), nullptr);
  const std::string text = UnknownPreset("tg5_flatport");
  EXPECT_EQ(text.find("--camera_preset tg5_flatport: there is no such camera; the nearest are "
                      "tg6_flatport, "),
            0u)
      << text;
  EXPECT_NE(text.find("--camera_preset list"), std::string::npos);
}

TEST(CameraPresetsTest, TheListHoldsEachOnce) {
  std::istringstream list(CameraPresetList());
  std::string line;
  std::getline(list, line);  // the headings
  std::set<std::string> names;
  while (std::getline(list, line)) {
    const std::string name = line.substr(0, line.find(' '));
    ASSERT_NE(FindCameraPreset(name), nullptr) << line;
    EXPECT_TRUE(names.insert(name).second) << name;
    const CameraPreset& preset = *FindCameraPreset(name);
    EXPECT_TRUE(preset.focal == 0 || (preset.focal > 0.3 && preset.focal < 3)) << name;
    EXPECT_TRUE(preset.focal > 0 || preset.believes_exif) << name;
  }
  EXPECT_GE(names.size(), 10u);
}

}  // namespace
}  // namespace colmap_seapoint
