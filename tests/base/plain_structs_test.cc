// Errors, rasters, timers, the options of every run, and the version.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/base/timer.h"
#include "colmap_seapoint/base/version.h"

namespace colmap_seapoint {
namespace {

TEST(Error, OneLineOfWhereWhatAndRemedy) {
  const Error error("a.jpg", "is empty", "copy it again");
  EXPECT_STREQ(error.what(), "a.jpg: is empty; copy it again");
  EXPECT_EQ(error.Finding(), "is empty");
}

TEST(Error, AFaultOfTheUserIsNoneOfTheInput) {
  EXPECT_THROW(throw UsageError("no such option"), UsageError);
  try {
    throw UsageError("no such option");
  } catch (const Error&) {
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no such option");
  }
}

TEST(SeapointCheck, NamesTheConditionAndThePlace) {
  const int two = 2;
  EXPECT_NO_THROW(SEAPOINT_CHECK(two == 2));
  try {
    SEAPOINT_CHECK(two == 3);
    FAIL();
  } catch (const std::logic_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("two == 3"), std::string::npos) << text;
    EXPECT_NE(text.find("plain_structs_test.cc:"), std::string::npos) << text;
  }
}

TEST(Image, RowsFromTheTopChannelsTogether) {
  Image<uint8_t> image(4, 3, 2, 9);
  EXPECT_FALSE(image.Empty());
  EXPECT_EQ(image.data.size(), 24u);
  EXPECT_EQ(image.Stride(), 8u);
  EXPECT_EQ(std::count(image.data.begin(), image.data.end(), 9), 24);
  image.At(3, 2, 1) = 7;
  EXPECT_EQ(image.data.back(), 7);
  image.At(1, 0) = 6;
  EXPECT_EQ(image.data[2], 6);
  EXPECT_EQ(image.Row(2), image.data.data() + 16);
  const Image<uint8_t>& same = image;
  EXPECT_EQ(same.At(3, 2, 1), 7);
  EXPECT_EQ(same.Row(1), image.data.data() + 8);
}

TEST(Image, Contains) {
  const GrayImage image(4, 3);
  for (int y = -1; y <= 3; ++y) {
    for (int x = -1; x <= 4; ++x) {
      EXPECT_EQ(image.Contains(x, y), x >= 0 && x < 4 && y >= 0 && y < 3) << x << " " << y;
    }
  }
  EXPECT_TRUE(GrayImage().Empty());
  EXPECT_FALSE(GrayImage().Contains(0, 0));
}

TEST(Timer, WallAndCpuOfWhatRan) {
  Timer timer;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_GE(timer.WallSeconds(), 0.02);
  EXPECT_LT(timer.CpuSeconds(), timer.WallSeconds());  // asleep
  Timer busy;
  while (busy.CpuSeconds() < 0.02) {
  }
  EXPECT_GE(busy.WallSeconds(), 0.015);
  EXPECT_GE(ProcessCpuSeconds(), 0.02);
}

class RunOptionsTest : public testing::Test {
 protected:
  RunOptionsTest() { options_.Bind(&table_); }

  RunOptions options_;
  OptionTable table_;
};

TEST_F(RunOptionsTest, Defaults) {
  EXPECT_EQ(options_.random_seed, 0);
  EXPECT_EQ(options_.num_threads, -1);
  EXPECT_EQ(options_.log_level, 2);
}

TEST_F(RunOptionsTest, LegalValuesArrive) {
  EXPECT_EQ(table_.Set("random_seed", "7"), "");
  EXPECT_EQ(table_.Set("num_threads", "1024"), "");
  EXPECT_EQ(table_.Set("log_level", "3"), "");
  EXPECT_EQ(options_.random_seed, 7);
  EXPECT_EQ(options_.num_threads, 1024);
  EXPECT_EQ(options_.log_level, 3);
}

TEST_F(RunOptionsTest, IllegalOnesAreRefusedByName) {
  const std::pair<const char*, const char*> illegal[] = {{"random_seed", "-1"},
                                                         {"num_threads", "-2"},
                                                         {"num_threads", "1025"},
                                                         {"num_threads", "two"},
                                                         {"log_level", "4"}};
  for (const auto& [name, value] : illegal) {
    const std::string problem = table_.Set(name, value);
    EXPECT_NE(problem.find(name), std::string::npos) << problem;
    EXPECT_NE(problem.find(value), std::string::npos) << problem;
  }
  EXPECT_EQ(options_.num_threads, -1);
}

TEST(CommandResult, CompleteUnlessSomebodySaysOtherwise) {
  EXPECT_TRUE(CommandResult().is_complete);
  EXPECT_EQ(CommandResult().text, "");
}

TEST(Version, ThreeNumbers) {
  int major = -1, minor = -1, patch = -1;
  char rest = 0;
  EXPECT_EQ(std::sscanf(Version().c_str(), "%d.%d.%d%c", &major, &minor, &patch, &rest), 3)
      << Version();
}

}  // namespace
}  // namespace colmap_seapoint
