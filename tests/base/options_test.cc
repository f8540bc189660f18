#include "colmap_seapoint/base/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace colmap_seapoint {
namespace {

struct Values {
  bool flag = true;
  int count = 2500;
  double share = 0.6;
  std::string mode = "partial";
  std::string path;

  OptionTable Table() {
    OptionTable table;
    table.Add("Group.flag", &flag, "a flag", "ours");
    table.Add("Group.count", &count, "how many", "paper 2.3", 1, 100000);
    table.Add("Group.share", &share, "a share", "ours", 0, 1);
    table.Add("Group.mode", &mode, "which", "ours", {"partial", "complete"});
    table.AddRequired("image_path", &path, "folder");
    return table;
  }
};

TEST(OptionTable, TakesDefaultsWhenAdded) {
  Values values;
  const OptionTable table = values.Table();
  ASSERT_EQ(table.Options().size(), 5u);
  EXPECT_EQ(table.Find("Group.flag")->default_value, "1");
  EXPECT_EQ(table.Find("Group.count")->default_value, "2500");
  EXPECT_EQ(table.Find("Group.share")->default_value, "0.6");
  EXPECT_EQ(table.Find("Group.mode")->default_value, "partial");
  EXPECT_TRUE(table.Find("image_path")->required);
  EXPECT_EQ(table.Find("Group.nothing"), nullptr);
}

TEST(OptionTable, SetsEveryType) {
  Values values;
  const OptionTable table = values.Table();
  EXPECT_EQ(table.Set("Group.flag", "0"), "");
  EXPECT_EQ(table.Set("Group.count", "100000"), "");
  EXPECT_EQ(table.Set("Group.share", "1e-3"), "");
  EXPECT_EQ(table.Set("Group.mode", "complete"), "");
  EXPECT_EQ(table.Set("image_path", "a b"), "");
  EXPECT_FALSE(values.flag);
  EXPECT_EQ(values.count, 100000);
  EXPECT_EQ(values.share, 1e-3);
  EXPECT_EQ(values.mode, "complete");
  EXPECT_EQ(values.path, "a b");
  EXPECT_EQ(OptionValueText(table.Find("Group.share")->target), "0.001");
}

TEST(OptionTable, RefusalsNameOptionValueAndRuleAndChangeNothing) {
  Values values;
  const OptionTable table = values.Table();
  EXPECT_EQ(table.Set("Group.flag", "yes"), "--Group.flag yes: must be 0 or 1");
  EXPECT_EQ(table.Set("Group.count", "0"), "--Group.count 0: must lie between 1 and 100000");
  EXPECT_EQ(table.Set("Group.count", "100001"),
            "--Group.count 100001: must lie between 1 and 100000");
  EXPECT_EQ(table.Set("Group.share", "1.01"), "--Group.share 1.01: must lie between 0 and 1");
  EXPECT_EQ(table.Set("Group.mode", "half"), "--Group.mode half: must be one of partial complete");
  EXPECT_EQ(table.Set("Group.none", "1"), "--Group.none: there is no such option");
  for (const char* text : {"", " ", "3.5", "3x", "0x10", "99999999999999", "--3", "+-3"}) {
    EXPECT_EQ(table.Set("Group.count", text).find("--Group.count "), 0u) << text;
  }
  for (const char* text : {"", "nan", "inf", "-0.1", "0,5", "0.5 "}) {
    EXPECT_EQ(table.Set("Group.share", text).find("--Group.share "), 0u) << text;
  }
  EXPECT_TRUE(values.flag);
  EXPECT_EQ(values.count, 2500);
  EXPECT_EQ(values.share, 0.6);
  EXPECT_EQ(values.mode, "partial");
}

TEST(OptionTable, CheckSeesMissingAndIllegalValues) {
  Values values;
  const OptionTable table = values.Table();
  EXPECT_EQ(table.Check(), "--image_path is required");
  values.path = "x";
  EXPECT_EQ(table.Check(), "");
  values.count = -1;
  EXPECT_EQ(table.Check(), "--Group.count -1: must lie between 1 and 100000");
  values.count = 1;
  values.share = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(table.Check(), "--Group.share nan: must lie between 0 and 1");
}

TEST(OptionTable, NumbersAsAPersonWritesThem) {
  double value = 1e6;
  EXPECT_EQ(OptionValueText(&value), "1000000");
  value = -3;
  EXPECT_EQ(OptionValueText(&value), "-3");
  value = 0.1;
  EXPECT_EQ(OptionValueText(&value), "0.1");
  value = 1e300;
  EXPECT_EQ(OptionValueText(&value), "1e+300");
}

TEST(OptionTable, ADoubleBindingIsABug) {
  Values values;
  OptionTable table = values.Table();
  EXPECT_THROW(table.Add("Group.flag", &values.flag, "again", "ours"), std::logic_error);
}

// COLMAP's project files hold true and false for what is a switch there.
TEST(OptionTableSwitch, OfThreeValuesTakesColmapsWords) {
  int value = -1;
  OptionTable table;
  table.Add("per_folder", &value, "a switch", "COLMAP", -1, 1);
  EXPECT_EQ(table.Set("per_folder", "false"), "");
  EXPECT_EQ(value, 0);
  EXPECT_EQ(table.Set("per_folder", "true"), "");
  EXPECT_EQ(value, 1);
  EXPECT_EQ(table.Set("per_folder", "-1"), "");
  EXPECT_EQ(value, -1);
  EXPECT_NE(table.Set("per_folder", "yes"), "");
}

TEST(EditDistanceTest, LettersChangedAddedOrLeftOut) {
  EXPECT_EQ(EditDistance("", ""), 0u);
  EXPECT_EQ(EditDistance("", "abc"), 3u);
  EXPECT_EQ(EditDistance("tg5_port", "tg6_port"), 1u);
  EXPECT_EQ(EditDistance("flat", "float"), 1u);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3u);
}

}  // namespace
}  // namespace colmap_seapoint
