// Folders that cannot be written and disks that are full.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class BadDisk : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", 4);
    WriteSparseModelBinary(folder_ / "model", StripModel(4));
  }

  std::vector<std::string> Extract(const fs::path& database) const {
    return {"feature_extractor", "--database_path", database.string(), "--image_path",
            (folder_ / "images").string()};
  }
  std::vector<std::string> Densify(const fs::path& output) const {
    return {"partial_densifier",
            "--image_path",
            (folder_ / "images").string(),
            "--input_path",
            (folder_ / "model").string(),
            "--output_path",
            output.string()};
  }
  std::vector<std::string> Reconstruct(const fs::path& workspace) const {
    return {"automatic_reconstructor",
            "--image_path",
            (folder_ / "images").string(),
            "--workspace_path",
            workspace.string(),
            "--colmap_path",
            FAKE_COLMAP};
  }

  void ExpectFailure(const CliResult& result, const std::string& word) {
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    EXPECT_EQ(result.LastErrorLine().find("error: "), 0u) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(word), std::string::npos) << result.Text();
    EXPECT_EQ(result.LastErrorLine().find("internal"), std::string::npos) << result.Text();
  }

  TemporaryFolder folder_;
};

TEST_F(BadDisk, NoWritePermission) {
  CliOptions options;
  options.as_nobody = getuid() == 0;
  const CliResult probe = RunProgram(SEAPOINT_PROGRAM, {"version"}, options);
  if (probe.exit_code != 0) GTEST_SKIP() << "an unprivileged user cannot run the program";
  fs::create_directories(folder_ / "closed");
  fs::permissions(folder_ / "closed", fs::perms::owner_read | fs::perms::owner_exec |
                                          fs::perms::others_read | fs::perms::others_exec);
  const fs::path closed = folder_ / "closed";
  for (const auto& arguments : {Extract(closed / "database.db"), Densify(closed / "dense"),
                                Densify(closed), Reconstruct(closed / "workspace")}) {
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments, options);
    ExpectFailure(result, closed.string());
    EXPECT_TRUE(fs::is_empty(closed));
  }
}

TEST_F(BadDisk, OutputIsAFile) {
  WriteBytes(folder_ / "file", "precious");
  for (const auto& arguments : {Densify(folder_ / "file"), Reconstruct(folder_ / "file"),
                                Extract(folder_ / "file" / "d")}) {
    ExpectFailure(RunProgram(SEAPOINT_PROGRAM, arguments), (folder_ / "file").string());
  }
  EXPECT_EQ(ReadBytes(folder_ / "file"), "precious");
}

// No file may grow beyond a limit, which every command meets at another moment.
TEST_F(BadDisk, NoRoomForAFile) {
  CliOptions options;
  options.max_file_bytes = 50000;
  ASSERT_EQ(RunProgram(SEAPOINT_PROGRAM, Densify(folder_ / "dense")).exit_code, 0);
  const std::string earlier = ReadBytes(folder_ / "dense" / "fused.ply");
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Extract(folder_ / "database.db"), options),
                (folder_ / "database.db").string());
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Densify(folder_ / "dense"), options), "fused.ply");
  EXPECT_TRUE(ReadBytes(folder_ / "dense" / "fused.ply") == earlier);
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Reconstruct(folder_ / "workspace"), options),
                "database.db");
}

class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder);
    mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=300k") == 0;
    if (!mounted_) why_ = std::strerror(errno);
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  bool Mounted() const { return mounted_; }
  const std::string& Why() const { return why_; }

 private:
  fs::path folder_;
  bool mounted_ = false;
  std::string why_;
};

TEST_F(BadDisk, FullDisk) {
  const SmallDisk disk(folder_ / "disk");
  if (!disk.Mounted()) GTEST_SKIP() << "a small disk cannot be mounted here: " << disk.Why();
  const fs::path database = folder_ / "disk" / "database.db";
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Extract(database)), database.string());
  // What was committed before is whole.
  { EXPECT_EQ(ReadImages(ColmapDatabase(database, ColmapDatabase::Mode::kReadOnly)).size(), 4u); }
  for (const auto& entry : fs::directory_iterator(folder_ / "disk")) fs::remove_all(entry.path());
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Densify(folder_ / "disk" / "dense")), "fused.ply");
  EXPECT_FALSE(fs::exists(folder_ / "disk" / "dense" / "fused.ply"));
  ExpectFailure(RunProgram(SEAPOINT_PROGRAM, Reconstruct(folder_ / "disk" / "workspace")), "disk");
}

}  // namespace
}  // namespace colmap_seapoint
