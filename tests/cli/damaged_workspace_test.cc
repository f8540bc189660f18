// Finished work that was damaged since is made again, and what a fresh run gives is there again.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class DamagedWorkspace : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", 3);
    ASSERT_EQ(Run("ws").exit_code, 0);
    whole_ = Clouds("ws");
  }

  // Few SeaPoints and coarse clouds.
  CliResult Run(const std::string& workspace) const {
    return RunProgram(
        SEAPOINT_PROGRAM,
        {"automatic_reconstructor", "--image_path", (folder_ / "images").string(),
         "--workspace_path", (folder_ / workspace).string(), "--colmap_path", FAKE_COLMAP,
         "--SeaPointExtraction.min_num_features", "300", "--SeaPointExtraction.max_num_features",
         "400", "--PartialDensification.step", "4"});
  }

  // What models, clouds and maps hold.
  std::map<std::string, std::string> Clouds(const std::string& workspace) const {
    std::map<std::string, std::string> files;
    for (const char* part : {"sparse", "dense", "map"}) {
      for (const auto& [name, bytes] : ReadTree(folder_ / workspace / part)) {
        const std::string end = fs::path(name).extension().string();
        if (end == ".bin" || end == ".ply" || end == ".vis" || end == ".tif" || end == ".png") {
          files[part + ("/" + name)] = bytes;
        }
      }
    }
    return files;
  }

  void ExpectWholeAgain(const std::string& what, const std::string& warning) const {
    const CliResult result = Run("ws");
    EXPECT_EQ(result.exit_code, 0) << what << "\n" << result.Text();
    EXPECT_NE(result.err.find(warning), std::string::npos) << what << "\n" << result.Text();
    EXPECT_TRUE(Clouds("ws") == whole_) << what;
    if (warning.empty()) return;
    const CliResult again = Run("ws");
    EXPECT_EQ(again.err.find(warning), std::string::npos) << what << "\n" << again.Text();
  }

  TemporaryFolder folder_;
  std::map<std::string, std::string> whole_;
};

TEST_F(DamagedWorkspace, ACutCloud) {
  fs::resize_file(folder_ / "ws/dense/0/fused.ply", 1000);
  ExpectWholeAgain("cut", "fused.ply holds 1000 bytes instead of");
}

TEST_F(DamagedWorkspace, ACloudOfTheSameSize) {
  std::string bytes = ReadBytes(folder_ / "ws/dense/0/fused.ply");
  bytes[bytes.size() / 2] ^= 1;
  WriteBytes(folder_ / "ws/dense/0/fused.ply", bytes);
  ExpectWholeAgain("one bit", "fused.ply does not hold what was written");
}

TEST_F(DamagedWorkspace, NoVisibility) {
  fs::remove(folder_ / "ws/dense/0/fused.ply.vis");
  ExpectWholeAgain("gone", "fused.ply.vis is gone");
}

TEST_F(DamagedWorkspace, AMap) {
  std::string bytes = ReadBytes(folder_ / "ws/map/0/dem.tif");
  bytes[bytes.size() / 2] ^= 1;
  WriteBytes(folder_ / "ws/map/0/dem.tif", bytes);
  ExpectWholeAgain("one bit", "dem.tif does not hold what was written");
  fs::remove(folder_ / "ws/map/0/hillshade.png");
  ExpectWholeAgain("gone", "hillshade.png is gone");
}

TEST_F(DamagedWorkspace, AModel) {
  fs::resize_file(folder_ / "ws/sparse/0/images.bin", 100);
  ExpectWholeAgain("cut", "images.bin holds 100 bytes instead of");
  fs::remove(folder_ / "ws/sparse/0/points3D.bin");
  ExpectWholeAgain("gone", "points3D.bin is gone");
}

TEST_F(DamagedWorkspace, ARecord) {
  for (const char* stage : {"database", "second_chance", "mapper", "dense_0", "map_0"}) {
    WriteBytes(folder_ / "ws/state" / (std::string(stage) + ".json"), "{\"fingerpr");
    ExpectWholeAgain(stage, "");
  }
}

// Of the same name, size and time.
TEST_F(DamagedWorkspace, AnotherPictureIsNoticed) {
  const auto replace = [&](int index, const std::string& extension) {
    const fs::path path = folder_ / "images" / ("img9" + extension);
    const bool was_there = fs::exists(path);
    const uint64_t size = was_there ? fs::file_size(path) : 0;
    const auto time = was_there ? fs::last_write_time(path) : fs::file_time_type();
    WriteImage(path, StripPicture(index));
    if (!was_there) return;
    fs::last_write_time(path, time);
    EXPECT_EQ(fs::file_size(path), size);
  };
  replace(20, ".bmp");  // shows nothing of the others: untied
  EXPECT_EQ(Run("ws").exit_code, 0);
  replace(4, ".bmp");  // the next one of the strip
  EXPECT_EQ(Run("ws").exit_code, 0);
  EXPECT_EQ(Run("fresh").exit_code, 0);
  EXPECT_TRUE(Clouds("ws") == Clouds("fresh"));
}

}  // namespace
}  // namespace colmap_seapoint
