#include "colmap_seapoint/estimate/work_history.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class WorkHistory : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("work_history_" + std::string(test->name()));
    fs::remove_all(folder_);
    path_ = folder_ / "cache" / "history.json";
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_, path_;
};

RunRatios AllOf(double ratio) {
  RunRatios ratios;
  ratios.values.fill(ratio);
  return ratios;
}

TEST_F(WorkHistory, WithoutOneTheMachineIsAsExpected) {
  for (const double ratio : ReadMachineRatios(path_).values) EXPECT_EQ(ratio, 1);
}

TEST_F(WorkHistory, IsTheMedianOfTheLastRuns) {
  for (int i = 0; i < 3; ++i) AddRun(path_, AllOf(2));
  AddRun(path_, AllOf(90));
  EXPECT_EQ(ReadMachineRatios(path_)[Work::kPairs], 2);
  RunRatios only_pairs;
  only_pairs[Work::kPairs] = 5;
  for (int i = 0; i < 100; ++i) AddRun(path_, only_pairs);
  EXPECT_EQ(ReadMachineRatios(path_)[Work::kPairs], 5);
  EXPECT_EQ(ReadMachineRatios(path_)[Work::kPictures], 1);  // the runs that told of it are gone
  EXPECT_LT(fs::file_size(path_), 10000u);
}

TEST_F(WorkHistory, DamageIsNoError) {
  fs::create_directories(path_.parent_path());
  static_assert(kNumWorks == 14, "a row of the last text has a value for each");
  for (const char* text :
       {"", "{", "[]", "{\"ratios_of_runs\": 3}", "{\"ratios_of_runs\": [3, []]}",
        "{\"ratios_of_runs\": [[1e999, -1, \"x\", null, 0, 1e300, 1, 1]]}",
        "{\"ratios_of_runs\": [[-1, \"x\", null, 0, 1e300, -1, \"x\", null, 0, 1e300, 1, 1, "
        "1, 1]]}"}) {
    WriteTextFile(path_, text);
    for (const double ratio : ReadMachineRatios(path_).values) {
      EXPECT_GT(ratio, 0) << text;
      EXPECT_LE(ratio, 100) << text;
    }
    AddRun(path_, AllOf(2));
    EXPECT_GT(ReadMachineRatios(path_)[Work::kPairs], 0);
  }
  AddRun("/proc/no_such/history.json", AllOf(2));
  AddRun(folder_ / "cache" / "history.json" / "below_a_file", AllOf(2));
}

}  // namespace
}  // namespace colmap_seapoint
