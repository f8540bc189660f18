// Where pictures were taken: from a table, from EXIF, from the database.
#include "colmap_seapoint/pairing/spatial_pairs.h"
#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

class PlaceImagesTest : public testing::Test {
 protected:
  PlaceImagesTest() {
    const uint32_t camera = AddCamera(&database_, MakeCamera(CameraModel::kPinhole, 50, 64, 48));
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) AddImage(&database_, name, camera);
    images_ = ReadImages(database_);
  }

  std::vector<PlacedImage> Place(const std::string& image_path = "") {
    report_ = RunReport();
    return PlaceImages(images_, options_, image_path, path_.string(), database_, &report_);
  }

  void WriteTable(const std::string& text) {
    WriteBytes(dir_ / "positions.csv", text);
    options_.positions_path = (dir_ / "positions.csv").string();
  }

  // COLMAP 3.8's own columns, as our database has them.
  void SetPrior(uint32_t image_id, double x, double y, double z) {
    Execute(path_, "UPDATE images SET prior_tx = " + std::to_string(x) +
                       ", prior_ty = " + std::to_string(y) + ", prior_tz = " + std::to_string(z) +
                       " WHERE image_id = " + std::to_string(image_id));
  }

  TempDir dir_;
  const std::filesystem::path path_ = dir_ / "database.db";
  ColmapDatabase database_{path_, ColmapDatabase::Mode::kCreateIfMissing};
  std::vector<DatabaseImage> images_;
  SpatialPairOptions options_;
  RunReport report_;
};

TEST_F(PlaceImagesTest, ATableOfMetres) {
  WriteTable("image,x,y,z\nc.jpg,7,8,9\na.jpg,1,2,3\nother.jpg,0,0,0\n");
  testing::internal::CaptureStderr();
  const auto placed = Place();
  const std::string said = testing::internal::GetCapturedStderr();
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[0].image_id, 1u);
  EXPECT_EQ(placed[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(placed[1].image_id, 3u);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].name, "b.jpg");
  EXPECT_NE(report_.left_out[0].reason.find("has no line in"), std::string::npos);
  EXPECT_EQ(report_.images_used, 2);
  EXPECT_NE(said.find("1 of its pictures are not in the database: other.jpg"), std::string::npos)
      << said;
}

TEST_F(PlaceImagesTest, ATableOfDegreesBecomesMetresAboutTheFirst) {
  WriteTable("image,lat,lon,alt\na.jpg,60,5,1\nb.jpg,60.001,5,1\nc.jpg,60,5.001,4\n");
  const auto placed = Place();
  ASSERT_EQ(placed.size(), 3u);
  EXPECT_LT(placed[0].position.norm(), 1e-6);
  EXPECT_NEAR(placed[1].position.y(), 111.4, 0.1);
  EXPECT_NEAR(placed[2].position.x(), 55.8, 0.1);
  EXPECT_NEAR(placed[2].position.z(), 3, 1e-3);
}

TEST_F(PlaceImagesTest, ATableOfOtherPicturesIsAnError) {
  WriteTable("image,x,y,z\nx.jpg,1,2,3\n");
  EXPECT_ERROR(Place(), "the position of no picture is known");
}

TEST_F(PlaceImagesTest, PositionsOfTheDatabase) {
  SetPrior(1, 0, 0, 0);  // COLMAP's way to say that EXIF tells nothing
  SetPrior(2, 60, 5, -3);
  SetPrior(3, 60.001, 5, -3);
  const auto placed = Place();
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_NEAR((placed[1].position - placed[0].position).y(), 111.4, 0.1);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].reason, "has no position in the database");
  options_.is_gps = false;  // metres: as they are, and a zero is a place
  const auto metres = Place();
  ASSERT_EQ(metres.size(), 3u);
  EXPECT_EQ(metres[2].position, Eigen::Vector3d(60.001, 5, -3));
}

TEST_F(PlaceImagesTest, PositionsThatAreNoDegrees) {
  SetPrior(1, 512345, 4312361, -12);
  EXPECT_ERROR(Place(), "is no latitude and longitude; give --SpatialMatching.is_gps 0");
}

TEST_F(PlaceImagesTest, NothingIsKnown) {
  EXPECT_ERROR(Place(), "the position of no picture is known");
  EXPECT_ERROR(Place((dir_ / "none").string()), "there is no such folder");
  // Pictures without EXIF.
  std::filesystem::create_directories(dir_ / "images");
  for (const DatabaseImage& image : images_) WriteBytes(dir_ / "images" / image.name, "x");
  EXPECT_ERROR(Place((dir_ / "images").string()), "the position of no picture is known");
}

}  // namespace
}  // namespace colmap_seapoint
