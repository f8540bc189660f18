#include "colmap_seapoint/cameras/camera_identity.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

ExifCamera GoPro(const std::string& serial = "") {
  ExifCamera camera;
  camera.maker = "GoPro";
  camera.model = "HERO9 Black";
  camera.serial = serial;
  camera.focal_mm = 3;
  return camera;
}

TEST(CameraIdentityTest, EveryPropertyOfALensCounts) {
  const std::string key = CameraKey(GoPro("C3441"));
  EXPECT_EQ(CameraKey(GoPro("C3441")), key);
  const auto differs = [&](const auto& change) {
    ExifCamera camera = GoPro("C3441");
    change(&camera);
    return CameraKey(camera) != key;
  };
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->maker = "GoPr"; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->model = "HERO10 Black"; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->lens = "wide"; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->serial = "C3442"; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->focal_mm = 3.5; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->focal_35mm = 15; }));
  EXPECT_TRUE(differs([](ExifCamera* camera) { camera->digital_zoom = 1.5; }));
  // No zoom is said in two ways, and what is no property of a lens does not count.
  EXPECT_FALSE(differs([](ExifCamera* camera) { camera->digital_zoom = 1; }));
  EXPECT_FALSE(differs([](ExifCamera* camera) { camera->taken_width = 1; }));
}

TEST(CameraIdentityTest, ASerialNumberTellsACameraInAnyFolder) {
  EXPECT_EQ(FolderFamily("morning", GoPro("C3441")), FolderFamily("evening/a", GoPro("C3441")));
  for (const char* none : {"", "0000000", "n/a", "   ", "XXXXXXXX", "12"}) {
    EXPECT_EQ(FolderFamily("morning", GoPro(none)), "morning") << none;
  }
  ExifCamera nameless = GoPro("C3441");
  nameless.model = "";
  EXPECT_EQ(FolderFamily("morning", nameless), "morning");
}

TEST(CameraIdentityTest, ACameraGoesOnInTheNextFolder) {
  const auto family = [](const std::string& folder) { return FolderFamily(folder, GoPro()); };
  EXPECT_EQ(family("100GOPRO"), family("101GOPRO"));
  EXPECT_EQ(family("DCIM/100GOPRO"), family("DCIM/999GOPRO"));
  EXPECT_EQ(family("100_PANA"), family("101_PANA"));
  EXPECT_NE(family("100GOPRO"), family("100MEDIA"));
  // Two cards in two folders, two cameras of a kind, and dives.
  EXPECT_NE(family("left/100GOPRO"), family("right/100GOPRO"));
  EXPECT_NE(family("cam1"), family("cam2"));
  EXPECT_NE(family("dive_001"), family("dive_002"));
  EXPECT_NE(family("100GOPRO/a"), family("101GOPRO/a"));
  EXPECT_NE(family("001GOPRO"), family("002GOPRO"));
  EXPECT_NE(family("100GOPR"), family("101GOPR"));
  EXPECT_EQ(family(""), "");
  // Whose EXIF says nothing may be anybody's.
  EXPECT_EQ(FolderFamily("100GOPRO", {}), "100GOPRO");
}

}  // namespace
}  // namespace colmap_seapoint
