// A small survey and the commands on it, for tests of what goes wrong.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {

class Faults : public testing::Test {
 protected:
  using Arguments = std::vector<std::string>;
  static constexpr int kNumPictures = 3;

  void SetUp() override {
    WriteStrip(folder_ / "images", kNumPictures);
    WriteSparseModelBinary(folder_ / "model", StripModel(kNumPictures));
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  Arguments Extract(const std::string& database = "d.db") const {
    return {"feature_extractor", "--database_path", Path(database), "--image_path", Path("images")};
  }
  Arguments Match() const { return {"exhaustive_matcher", "--database_path", Path("d.db")}; }
  Arguments Densify(const std::string& output = "dense") const {
    return {"partial_densifier", "--image_path",  Path("images"), "--input_path",
            Path("model"),       "--output_path", Path(output)};
  }
  Arguments Reconstruct(const std::string& workspace = "workspace") const {
    return {"automatic_reconstructor", "--image_path",  Path("images"), "--workspace_path",
            Path(workspace),           "--colmap_path", FAKE_COLMAP};
  }

  static CliResult Run(const Arguments& arguments, const CliOptions& options = {},
                       const Arguments& more = {}) {
    Arguments all = arguments;
    all.insert(all.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, all, options);
  }

  // Exit code 1, and a last line that says this and blames nobody.
  static void ExpectFailure(const CliResult& result, const std::string& word) {
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    const std::string line = result.LastErrorLine();
    EXPECT_EQ(line.find("error: "), 0u) << result.Text();
    EXPECT_NE(line.find(word), std::string::npos) << result.Text();
    EXPECT_EQ(line.find("internal"), std::string::npos) << result.Text();
    EXPECT_EQ(line.find("damaged"), std::string::npos) << result.Text();
  }

  TemporaryFolder folder_;
};

}  // namespace colmap_seapoint
