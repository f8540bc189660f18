// A system that gives fewer threads than were asked for: the results are the same.
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class FewThreads : public testing::Test {
 protected:
  struct Results {
    std::map<std::string, TableRows> tables;
    std::string cloud;
  };

  void SetUp() override {
    WriteStrip(folder_ / "images", 12);
    WriteSparseModelBinary(folder_ / "model", StripModel(12));
    fs::permissions(folder_.Path(), fs::perms::all);
  }

  void Run(std::vector<std::string> arguments, const CliOptions& options) const {
    arguments.insert(arguments.end(), {"--num_threads", "1024", "--log_level", "1"});
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments, options);
    EXPECT_EQ(result.exit_code, 0) << result.Text();
    EXPECT_EQ(result.err, "");
  }

  Results RunAll(const std::string& name, const CliOptions& options) const {
    const std::string images = folder_ / "images", database = folder_ / (name + ".db"),
                      dense = folder_ / name;
    Run({"feature_extractor", "--database_path", database, "--image_path", images}, options);
    Run({"exhaustive_matcher", "--database_path", database}, options);
    Run({"partial_densifier", "--image_path", images, "--input_path", folder_ / "model",
         "--output_path", dense, "--database_path", database},
        options);
    return {ReadTables(database), ReadBytes(dense + "/fused.ply")};
  }

  void ExpectSame(const Results& a, const Results& b) const {
    EXPECT_EQ(a.tables, b.tables);
    EXPECT_EQ(a.cloud, b.cloud);
    EXPECT_GT(a.cloud.size(), 10000u);
    EXPECT_EQ(a.tables.at("two_view_geometries").size(), 12u * 11u / 2u);
  }

  TemporaryFolder folder_;
};

TEST_F(FewThreads, NoneBesideTheFirst) {
  CliOptions options;
  options.as_nobody = getuid() == 0;  // root has no such limit
  if (RunProgram(SEAPOINT_PROGRAM, {"version"}, options).exit_code != 0) {
    GTEST_SKIP() << "an unprivileged user cannot run the program";
  }
  options.max_processes = 1;
  ExpectSame(RunAll("one", options), RunAll("many", {}));
}

// Maps go through OpenCV, whose own threads would fail.
TEST_F(FewThreads, NoneForTheLibrariesEither) {
  const auto densify = [&](const std::string& name, const CliOptions& options) {
    Run({"partial_densifier", "--image_path", folder_ / "images", "--input_path", folder_ / "model",
         "--output_path", folder_ / name, "--PartialDensification.write_maps", "1"},
        options);
    return ReadTree((folder_ / name) / "stereo");
  };
  CliOptions options;
  options.as_nobody = getuid() == 0;
  if (RunProgram(SEAPOINT_PROGRAM, {"version"}, options).exit_code != 0) {
    GTEST_SKIP() << "an unprivileged user cannot run the program";
  }
  options.max_processes = 1;
  const auto one = densify("one", options);
  EXPECT_GT(one.size(), 20u);
  EXPECT_TRUE(one == densify("many", {}));
}

TEST_F(FewThreads, StacksThatTheAddressSpaceCannotHold) {
  CliOptions options;
  options.max_address_bytes = 1L << 30;  // of 8 MB each
  ExpectSame(RunAll("few", options), RunAll("many", {}));
}

}  // namespace
}  // namespace colmap_seapoint
