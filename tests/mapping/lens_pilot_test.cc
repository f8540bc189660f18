// A survey's lens from some of its pictures, by a mapper whose answer is written down beforehand.
#include "colmap_seapoint/mapping/lens_pilot.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/scripted_colmap.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr char kMapper[] = "mapper";

class LensPilotTest : public testing::Test {
 protected:
  LensPilotTest() {
    WriteSurveyDatabase(survey_, dir_ / "database.db");
    call_.command = kMapper;
    call_.database_path = dir_ / "database.db";
    call_.image_path = dir_ / "images";
    call_.output_path = dir_ / "pilot";
    call_.log_path = dir_ / "pilot.log";
    fs::create_directories(call_.output_path);
  }

  std::map<uint32_t, Camera> Learn() { return LearnLenses(colmap_.Program(), call_, true, 2); }

  TempDir dir_;
  ScriptedColmap colmap_{dir_ / "bin"};
  const SparseModel survey_ = ExactSurvey(ExactLens(), 40);
  MapperCall call_;
};

TEST_F(LensPilotTest, FindsTheLensOfTheSurvey) {
  colmap_.Leaves(kMapper, 1, "0", Disturbed(ExactSurvey(ExactLens(), 30)));
  const auto lenses = Learn();
  ASSERT_EQ(lenses.size(), 1u);
  EXPECT_LT(LargestDifference(lenses.begin()->second, ExactLens()), 0.5);
}

TEST_F(LensPilotTest, AsksForSixtyPictures) {
  Learn();
  const std::string names = colmap_.ImageList(kMapper, 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), '\n'), 60);
}

TEST_F(LensPilotTest, SaysNothingWhereTheModelIsSmallOrMissing) {
  EXPECT_TRUE(Learn().empty());
  colmap_.Leaves(kMapper, 2, "0", Disturbed(ExactSurvey(ExactLens(), 4)));
  EXPECT_TRUE(Learn().empty());
  colmap_.Ends(kMapper, 3, "killed", 1);
  colmap_.Leaves(kMapper, 3, "0", Disturbed(ExactSurvey(ExactLens(), 30)));
  EXPECT_TRUE(Learn().empty());
}

}  // namespace
}  // namespace colmap_seapoint
