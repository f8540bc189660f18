// partial_densifier killed at any moment: nothing under a final name, and the same command again
// ends with the bytes of a run that nothing disturbed, for any number of threads.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

class DensifyResume : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", 8);
    WriteSparseModelBinary(folder_ / "model", StripModel(8));
  }

  CliResult Densify(const std::string& output, int num_threads = 2,
                    const CliOptions& options = {}) const {
    return RunProgram(SEAPOINT_PROGRAM,
                      {"partial_densifier", "--image_path", (folder_ / "images").string(),
                       "--input_path", (folder_ / "model").string(), "--output_path",
                       (folder_ / output).string(), "--num_threads", std::to_string(num_threads)},
                      options);
  }

  // What does not tell of time: pairs.csv and run.json hold seconds.
  std::map<std::string, std::string> Clouds(const std::string& output) const {
    std::map<std::string, std::string> clouds;
    for (const auto& [name, bytes] : ReadTree(folder_ / output)) {
      if (name == "fused.ply" || name == "fused.ply.vis") clouds[name] = bytes;
    }
    return clouds;
  }

  std::set<std::string> Names(const std::string& output) const {
    std::set<std::string> names;
    if (!std::filesystem::exists(folder_ / output)) return names;
    for (const auto& [name, bytes] : ReadTree(folder_ / output)) names.insert(name);
    return names;
  }

  TemporaryFolder folder_;
};

TEST_F(DensifyResume, KilledAtManyMoments) {
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Densify("whole").exit_code, 0);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::set<std::string> whole = Names("whole");
  ASSERT_EQ(whole, (std::set<std::string>{".colmap_seapoint", "fused.ply", "fused.ply.vis",
                                          "pairs.csv", "run.json", "units.json"}));
  const auto expected = Clouds("whole");
  constexpr int kNumKills = 8;
  int num_killed = 0, num_half_way = 0;
  for (int i = 1; i <= kNumKills; ++i) {
    CliOptions options;
    const double moment = seconds * i / (kNumKills + 1);
    options.kill_when = [&](double now) { return now > moment; };
    if (Densify("killed", 2, options).signal_number == SIGKILL) {
      ++num_killed;
      std::set<std::string> left;
      for (const std::string& name : Names("killed")) {
        if (!IsLeftover(name)) left.insert(name);
      }
      num_half_way += static_cast<int>(HoldsTemporaryFile(folder_ / "killed"));
      // A cloud under its final name is whole.
      for (const auto& [name, bytes] : Clouds("killed")) {
        EXPECT_TRUE(bytes == expected.at(name)) << name << " after " << moment << " s";
      }
      // The report comes last: with it, all is there.
      if (left.count("run.json") > 0) {
        EXPECT_EQ(left, whole);
      }
    }
    // Over its own leftovers, with another number of threads.
    const CliResult again = Densify("killed", 1 + i % 3);
    ASSERT_EQ(again.exit_code, 0) << again.Text();
    EXPECT_TRUE(Clouds("killed") == expected) << "killed after " << moment << " s";
    EXPECT_EQ(Names("killed"), whole) << "leftovers of the killed run";
    std::filesystem::remove_all(folder_ / "killed");
  }
  EXPECT_GE(num_killed, kNumKills / 2);
  EXPECT_GE(num_half_way, 1);
}

// What a killed run leaves of an earlier, finished one is that one's cloud, whole.
TEST_F(DensifyResume, KilledOverAFinishedRunKeepsItsCloud) {
  ASSERT_EQ(Densify("dense").exit_code, 0);
  const auto before = Clouds("dense");
  CliOptions options;
  options.kill_when = [&](double) { return HoldsTemporaryFile(folder_ / "dense"); };
  ASSERT_EQ(Densify("dense", 2, options).signal_number, SIGKILL);
  EXPECT_TRUE(Clouds("dense") == before);
  ASSERT_EQ(Densify("dense", 1).exit_code, 0);
  EXPECT_TRUE(Clouds("dense") == before);
  EXPECT_FALSE(HoldsTemporaryFile(folder_ / "dense"));
}

}  // namespace
}  // namespace colmap_seapoint
