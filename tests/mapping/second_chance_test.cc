#include "colmap_seapoint/mapping/second_chance.h"

#include <map>

#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

using Names = std::set<std::string>;

// img1.jpg ... img12.jpg, in an order of ids that is not that of the names; all with SeaPoints.
class SecondChanceTest : public testing::Test {
 protected:
  SecondChanceTest() {
    const uint32_t camera = AddCamera(&database_, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    for (int i = 12; i >= 1; --i) {
      ids_[i] = AddImage(&database_, "img" + std::to_string(i) + ".jpg", camera);
      WriteFeatures(&database_, ids_[i], MakeFeatures(40, ids_[i]), "picture");
    }
  }

  void Tie(int i, int j, uint32_t num_inliers) {
    FeatureMatches matches;
    for (uint32_t k = 0; k < num_inliers; ++k) matches.push_back({k, k});
    WriteMatches(&database_, ids_[i], ids_[j], matches, MakeGeometry(matches));
  }

  Names Find() { return FindSecondChancePictures(database_); }

  TempDir dir_;
  const std::filesystem::path path_ = dir_ / "database.db";
  ColmapDatabase database_{path_, ColmapDatabase::Mode::kCreateIfMissing};
  std::map<int, uint32_t> ids_;
};

TEST_F(SecondChanceTest, NobodyWhereAllAreTied) {
  for (int i = 1; i <= 12; i += 2) Tie(i, i + 1, 30);
  EXPECT_EQ(Find(), Names());
}

TEST_F(SecondChanceTest, AnUntiedPictureAndItsNeighboursInNaturalOrder) {
  for (const int i : {1, 3, 5, 7}) Tie(i, i + 1, 35);
  Tie(11, 12, 30);
  Tie(10, 12, 30);
  Tie(9, 10, 29);  // one match too few
  EXPECT_EQ(Find(), (Names{"img8.jpg", "img9.jpg", "img10.jpg"}));
}

TEST_F(SecondChanceTest, FirstAndLastHaveOneNeighbour) {
  for (const int i : {2, 4, 6, 8, 10}) Tie(i, i + 1, 40);
  EXPECT_EQ(Find(), (Names{"img1.jpg", "img2.jpg", "img11.jpg", "img12.jpg"}));
}

TEST_F(SecondChanceTest, OneStrongPairAmongWeakOnesIsEnough) {
  for (int i = 1; i < 12; ++i) Tie(i, i + 1, 12);
  for (int i = 1; i <= 12; i += 2) Tie(i, (i + 2) % 12 + 1, 31);
  EXPECT_EQ(Find(), Names());
}

TEST_F(SecondChanceTest, PicturesWithoutSeaPointsDoNotCount) {
  for (const int i : {1, 3, 5, 10}) Tie(i, i + 1, 35);
  Tie(9, 12, 35);
  // Neither is img7.jpg chosen, nor does it stand between img6.jpg and img8.jpg.
  WriteFeatures(&database_, ids_[7], Features(), "picture");
  EXPECT_EQ(Find(), (Names{"img6.jpg", "img8.jpg", "img9.jpg"}));
}

}  // namespace
}  // namespace colmap_seapoint
