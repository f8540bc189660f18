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
    camera_ = AddCamera(&database_, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    for (int i = 12; i >= 1; --i) Add(i);
  }

  void Add(int i) {
    ids_[i] = AddImage(&database_, "img" + std::to_string(i) + ".jpg", camera_);
    WriteFeatures(&database_, ids_[i], MakeFeatures(40, ids_[i]), "picture");
  }

  void Tie(int i, int j, uint32_t num_inliers) {
    FeatureMatches matches;
    for (uint32_t k = 0; k < num_inliers; ++k) matches.push_back({k, k});
    WriteMatches(&database_, ids_[i], ids_[j], matches, MakeGeometry(matches));
  }

  void TryInVain(int i, int j) {
    TwoViewGeometry unverified;
    unverified.config = TwoViewConfig::kDegenerate;
    WriteMatches(&database_, ids_[i], ids_[j], {}, unverified);
  }

  Names Find() { return FindSecondChancePictures(database_); }

  TempDir dir_;
  const std::filesystem::path path_ = dir_ / "database.db";
  ColmapDatabase database_{path_, ColmapDatabase::Mode::kCreateIfMissing};
  uint32_t camera_ = 0;
  std::map<int, uint32_t> ids_;
};

TEST_F(SecondChanceTest, NobodyWhereAllAreTied) {
  for (int i = 1; i < 12; ++i) Tie(i, i + 1, 30);
  EXPECT_EQ(Find(), Names());
}

TEST_F(SecondChanceTest, AnUntiedPictureAndThoseItWasTriedWith) {
  for (int i = 1; i < 12; ++i) {
    if (i != 4 && i != 5) Tie(i, i + 1, 35);
  }
  Tie(4, 5, 29);  // one match too few
  TryInVain(5, 6);
  TryInVain(5, 11);
  TryInVain(7, 9);  // both are tied
  // 1 to 4 are no part of the largest group either, 6 to 12.
  EXPECT_EQ(Find(), (Names{"img1.jpg", "img2.jpg", "img3.jpg", "img4.jpg", "img5.jpg", "img6.jpg",
                           "img11.jpg"}));
}

TEST_F(SecondChanceTest, OfGroupsOfOneSizeTheOneOfTheSmallestIdIsTheTiedOne) {
  for (int i = 1; i < 12; ++i) {
    if (i != 6) Tie(i, i + 1, 40);
  }
  // Ids run against the names: 12 has the smallest.
  EXPECT_EQ(Find(),
            (Names{"img1.jpg", "img2.jpg", "img3.jpg", "img4.jpg", "img5.jpg", "img6.jpg"}));
}

TEST_F(SecondChanceTest, AGroupOfTwentyIsADiveOfItsOwn) {
  for (int i = 13; i <= 50; ++i) Add(i);
  for (int i = 1; i < 50; ++i) {
    if (i != 25 && i != 45) Tie(i, i + 1, 30);
  }
  EXPECT_EQ(Find(), (Names{"img46.jpg", "img47.jpg", "img48.jpg", "img49.jpg", "img50.jpg"}));
}

TEST_F(SecondChanceTest, ManyWeakPairsTieNothing) {
  for (int i = 1; i < 12; ++i) Tie(i, i + 1, 12);
  EXPECT_EQ(Find().size(), 12u);
}

TEST_F(SecondChanceTest, PicturesWithoutSeaPointsDoNotCount) {
  for (int i = 1; i < 12; ++i) {
    if (i != 6 && i != 7) Tie(i, i + 1, 35);
  }
  Tie(6, 8, 35);
  TryInVain(7, 8);
  WriteFeatures(&database_, ids_[7], Features(), "picture");
  EXPECT_EQ(Find(), Names());
}

TEST_F(SecondChanceTest, TiesAreGroupsAndWhatLiesBetweenThem) {
  for (int i = 1; i < 11; ++i) {
    if (i != 6) Tie(i, i + 1, 35);
  }
  Tie(6, 7, 20);
  WriteFeatures(&database_, ids_[12], Features(), "picture");
  const TieCount before = CountTies(database_);
  EXPECT_EQ(before.num_groups, 3u);
  EXPECT_EQ(before.num_between, 20u);
  EXPECT_FALSE(TiesMore(before, before));
  Tie(1, 5, 40);  // in one group already
  EXPECT_FALSE(TiesMore(CountTies(database_), before));
  Tie(6, 7, 15);
  EXPECT_FALSE(TiesMore(CountTies(database_), before));
  Tie(5, 8, 6);
  const TieCount more = CountTies(database_);
  EXPECT_EQ(more.num_between, 21u);
  EXPECT_TRUE(TiesMore(more, before));
  Tie(6, 7, 30);
  const TieCount tied = CountTies(database_);
  EXPECT_EQ(tied.num_groups, 2u);
  EXPECT_EQ(tied.num_between, 0u);
  EXPECT_TRUE(TiesMore(tied, more));
  EXPECT_FALSE(TiesMore(more, tied));
}

TEST(SecondChanceOfNothing, IsNobody) {
  TempDir dir;
  const ColmapDatabase database(dir / "empty.db", ColmapDatabase::Mode::kCreateIfMissing);
  EXPECT_EQ(FindSecondChancePictures(database), Names());
}

}  // namespace
}  // namespace colmap_seapoint
