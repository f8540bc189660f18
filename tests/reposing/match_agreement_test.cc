#include "colmap_seapoint/reposing/match_agreement.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

class MatchAgreementTest : public testing::Test {
 protected:
  void SetUp() override { WriteSurveyDatabase(model_, dir_ / "database.db"); }

  std::vector<PairAgreement> Check() const {
    return CheckMatches(ColmapDatabase(dir_ / "database.db", ColmapDatabase::Mode::kReadOnly),
                        model_);
  }

  TempDir dir_;
  SparseModel model_ = ExactSurvey(ExactLens(), 5);
};

TEST_F(MatchAgreementTest, OfExactPosesAllMatchesAgree) {
  const std::vector<PairAgreement> pairs = Check();
  ASSERT_GT(pairs.size(), 20u);
  for (const PairAgreement& pair : pairs) {
    for (const MatchAccount& account : {pair.account1, pair.account2}) {
      EXPECT_GT(account.num_matches, 0);
      EXPECT_LE(account.num_matches, 64);
      EXPECT_EQ(account.num_agreeing, account.num_matches);
    }
  }
  EXPECT_TRUE(MisplacedPictures(pairs, model_.images.size()).empty());
}

TEST_F(MatchAgreementTest, APictureThatSlidAlongItsStripIsFound) {
  // Along the epipolar lines of its own strip.
  model_.images[2].cam_from_world.translation += Eigen::Vector3d(0.2, 0, 0);
  EXPECT_EQ(MisplacedPictures(Check(), model_.images.size()), std::vector<uint32_t>{2});
}

TEST_F(MatchAgreementTest, NamesThePicturesThatStandWrongAndNoNeighbour) {
  model_.images[3].cam_from_world.translation += Eigen::Vector3d(0.1, 0.4, 0);
  model_.images[8].cam_from_world.translation += Eigen::Vector3d(-0.3, 0.2, 0.1);
  const auto misplaced = MisplacedPictures(Check(), model_.images.size());
  ASSERT_EQ(misplaced.size(), 2u);
  EXPECT_EQ(std::min(misplaced[0], misplaced[1]), 3u);
  EXPECT_EQ(std::max(misplaced[0], misplaced[1]), 8u);
}

TEST_F(MatchAgreementTest, APictureThatTheModelLacksIsNoMatter) {
  model_.images.erase(model_.images.begin() + 2);
  for (const PairAgreement& pair : Check()) {
    EXPECT_EQ(pair.account1.num_agreeing, pair.account1.num_matches);
    EXPECT_EQ(pair.account2.num_agreeing, pair.account2.num_matches);
  }
  model_.images[0].points2D.resize(3);  // fewer than the database has
  EXPECT_NO_THROW(Check());
}

TEST(MisplacedPicturesTest, AFewMatchesSayNothing) {
  EXPECT_TRUE(MisplacedPictures({{0, 1, {19, 0}, {19, 19}}}, 2).empty());
  EXPECT_EQ(MisplacedPictures({{0, 1, {20, 9}, {20, 20}}}, 2), std::vector<uint32_t>{0});
  EXPECT_TRUE(MisplacedPictures({{0, 1, {20, 10}, {20, 20}}}, 2).empty());
  EXPECT_TRUE(MisplacedPictures({}, 0).empty());
}

}  // namespace
}  // namespace colmap_seapoint
