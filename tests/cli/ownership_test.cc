// What the user, or another program, made is never removed or overwritten; an output is no input;
// two runs do not write into one another.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

constexpr char kPrecious[] = "a season's work";

class Ownership : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", 4);
    WriteSparseModelBinary(folder_ / "model", StripModel(4));
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  // Few SeaPoints and coarse clouds.
  Arguments Reconstruct(const std::string& workspace, const Arguments& more = {}) const {
    Arguments arguments = {"automatic_reconstructor",
                           "--image_path",
                           Path("images"),
                           "--workspace_path",
                           Path(workspace),
                           "--colmap_path",
                           FAKE_COLMAP,
                           "--SeaPointExtraction.min_num_features",
                           "300",
                           "--SeaPointExtraction.max_num_features",
                           "400",
                           "--PartialDensification.step",
                           "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Arguments Densify(const std::string& output, const Arguments& more = {}) const {
    Arguments arguments = {"partial_densifier",
                           "--image_path",
                           Path("images"),
                           "--input_path",
                           Path("model"),
                           "--output_path",
                           Path(output),
                           "--PartialDensification.step",
                           "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Arguments Scale(const std::string& output, const Arguments& more = {}) const {
    WriteBytes(folder_ / "positions.csv",
               "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0,0\nimg4.png,3,0,0\n");
    Arguments arguments = {"model_scaler",       "--input_path", Path("model"),
                           "--output_path",      Path(output),   "--positions_path",
                           Path("positions.csv")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Arguments Compare(const std::string& output, const Arguments& more = {}) const {
    Arguments arguments = {"cloud_comparer",   "--input_path",          Path("cloud/fused.ply"),
                           "--reference_path", Path("cloud/fused.ply"), "--output_path",
                           Path(output)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  static void ExpectDone(const Arguments& arguments) {
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments);
    EXPECT_EQ(result.exit_code, 0) << result.Text();
  }
  // Refused with these words in the last line, and nothing below the folder is changed.
  void ExpectRefusal(const Arguments& arguments, const std::string& what, const std::string& remedy,
                     int exit_code = 1) const {
    const auto before = ReadTree(folder_.Path());
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(what), std::string::npos) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(remedy), std::string::npos) << result.Text();
    EXPECT_TRUE(ReadTree(folder_.Path()) == before) << result.Text();
  }

  TemporaryFolder folder_;
};

// COLMAP's own project: pictures, model and cloud, and no database any more.
TEST_F(Ownership, AProjectOfColmapIsRefusedAsWorkspace) {
  WriteSparseModelBinary(folder_ / "sparse/0", StripModel(4));
  WriteBytes(folder_ / "sparse/notes.txt", kPrecious);
  WriteBytes(folder_ / "dense/0/fused.ply", kPrecious);
  ExpectRefusal(Reconstruct("."), "sparse: was not made by colmap_seapoint", "--workspace_path");
  fs::remove_all(folder_ / "sparse");
  ExpectRefusal(Reconstruct("."), "dense: was not made by colmap_seapoint", "--workspace_path");
}

TEST_F(Ownership, EveryNameOfTheWorkspaceIsProtected) {
  for (const char* name : {"database.db", "sparse/x", "sparse.tmp/x", "sparse_scaled/x", "dense/x",
                           "report/summary.txt", "state/x.json", "database.db.tmp"}) {
    WriteBytes(folder_ / "ws" / name, kPrecious);
    ExpectRefusal(Reconstruct("ws"), "was not made by colmap_seapoint", "--workspace_path");
    fs::remove_all(folder_ / "ws");
  }
}

TEST_F(Ownership, NothingIsWrittenThroughALink) {
  WriteBytes(folder_ / "precious.log", kPrecious);
  fs::create_directories(folder_ / "ws/report");
  fs::create_symlink(folder_ / "precious.log", folder_ / "ws/report/mapper_1_thinned.log");
  ExpectRefusal(Reconstruct("ws"), "report: was not made by", "--workspace_path");
  // Put there later.
  fs::remove_all(folder_ / "ws");
  ExpectDone(Reconstruct("ws"));
  fs::remove(folder_ / "ws/report/mapper_1_thinned.log");
  fs::remove(folder_ / "ws/state/mapper.json");
  fs::create_symlink(folder_ / "precious.log", folder_ / "ws/report/mapper_1_thinned.log");
  ExpectDone(Reconstruct("ws"));
  EXPECT_EQ(ReadBytes(folder_ / "precious.log"), kPrecious);
  EXPECT_FALSE(fs::is_symlink(folder_ / "ws/report/mapper_1_thinned.log"));
}

// The user's own files, put beside ours.
TEST_F(Ownership, OthersInOurFoldersStay) {
  ExpectDone(Reconstruct("ws"));
  const std::vector<std::string> foreign = {"sparse/0/notes.txt", "sparse/mine/notes.txt",
                                            "dense/0/mesh.ply", "notes.txt"};
  for (const std::string& name : foreign) WriteBytes(folder_ / "ws" / name, kPrecious);
  WriteSparseModelBinary(folder_ / "ws/sparse/mine", StripModel(3));
  // Another picture: all is made again.
  WriteStrip(folder_ / "images", 5);
  ExpectDone(Reconstruct("ws"));
  for (const std::string& name : foreign) EXPECT_EQ(ReadBytes(folder_ / "ws" / name), kPrecious);
  EXPECT_EQ(ReadSparseModel(folder_ / "ws/sparse/mine").images.size(), 3u);
  EXPECT_EQ(ReadSparseModel(folder_ / "ws/sparse/0").images.size(), 5u);
  EXPECT_FALSE(fs::exists(folder_ / "ws/dense/mine"));  // it is none of our models
}

TEST_F(Ownership, AForeignModelWithANumberIsInTheWay) {
  ExpectDone(Reconstruct("ws"));
  WriteSparseModelBinary(folder_ / "ws/sparse/7", StripModel(3));
  WriteStrip(folder_ / "images", 5);
  const CliResult result = RunProgram(SEAPOINT_PROGRAM, Reconstruct("ws"));
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("sparse/7/"), std::string::npos) << result.Text();
  EXPECT_EQ(ReadSparseModel(folder_ / "ws/sparse/7").images.size(), 3u);
}

TEST_F(Ownership, ForeignOutputsOfEveryCommandAreRefused) {
  ExpectDone(Densify("cloud"));
  for (const char* name : {"fused.ply", "fused.ply.vis", "pairs.csv", "units.json", "run.json"}) {
    WriteBytes(folder_ / "out" / name, kPrecious);
    ExpectRefusal(Densify("out"), std::string(name) + ": was not made by", "--output_path");
    fs::remove_all(folder_ / "out");
  }
  WriteBytes(folder_ / "out/stereo/depth_maps/img2.png.geometric.bin", kPrecious);
  ExpectRefusal(Densify("out", {"--PartialDensification.write_maps", "1"}), "img2.png", "--output");
  for (const char* name : {"cameras.bin", "points3D.txt", "scale.json", "units.json"}) {
    WriteBytes(folder_ / "scaled" / name, kPrecious);
    ExpectRefusal(Scale("scaled"), std::string(name) + ": was not made by", "--output_path");
    fs::remove_all(folder_ / "scaled");
  }
  WriteBytes(folder_ / "mine", kPrecious);
  WriteBytes(folder_ / "differences/differences.png", kPrecious);
  ExpectRefusal(Scale("scaled", {"--report_path", Path("mine")}), "mine: is there already",
                "--report_path");
  ExpectRefusal(Compare("mine"), "mine: is there already", "--output_path");
  ExpectRefusal(Compare("c.json", {"--difference_path", Path("differences")}), "differences.png",
                "--difference_path");
  WriteBytes(folder_ / "d.db.feature_extractor.run.json", kPrecious);
  ExpectRefusal(
      {"feature_extractor", "--database_path", Path("d.db"), "--image_path", Path("images")},
      "run.json: is there already", "--database_path");
}

TEST_F(Ownership, OursAreReplaced) {
  const Arguments maps = {"--PartialDensification.write_maps", "1"};
  for (int i = 0; i < 2; ++i) {
    ExpectDone(Densify("cloud", maps));
    ExpectDone(Scale(
        "scaled", {"--report_path", Path("report.csv"), "--cloud_path", Path("cloud/fused.ply")}));
    ExpectDone(Compare("c.json", {"--difference_path", Path("differences")}));
    ExpectDone(
        {"feature_extractor", "--database_path", Path("d.db"), "--image_path", Path("images")});
    ExpectDone({"exhaustive_matcher", "--database_path", Path("d.db")});
  }
}

// They had no list of what is theirs, and made no maps.
const Arguments kNoMap = {"--map", "0"};

TEST_F(Ownership, OutputsOfEarlierVersionsAreOurs) {
  const Arguments maps = {"--PartialDensification.write_maps", "1"};
  const auto forget = [&](const std::string& folder) {
    EXPECT_TRUE(fs::remove(folder_ / folder / ".colmap_seapoint")) << folder;
  };
  ExpectDone(Densify("cloud", maps));
  ExpectDone(Scale("scaled"));
  ExpectDone(Compare("c.json", {"--difference_path", Path("differences")}));
  ExpectDone(Reconstruct("ws", kNoMap));
  for (const char* folder : {"cloud", "scaled", "differences", "ws", "ws/dense/0"}) forget(folder);
  ExpectDone(Densify("cloud", maps));
  ExpectDone(Scale("scaled"));
  ExpectDone(Compare("c.json", {"--difference_path", Path("differences")}));
  ExpectDone(Reconstruct("ws", kNoMap));
  forget("ws");
  WriteStrip(folder_ / "images", 5);
  ExpectDone(Reconstruct("ws"));
}

// Killed while its mapper worked, so that nothing but the records tells.
TEST_F(Ownership, AnInterruptedWorkspaceOfAnEarlierVersionGoesOn) {
  ExpectDone(Reconstruct("ws", kNoMap));
  for (const char* name : {".colmap_seapoint", "dense", "sparse", "state/mapper.json",
                           "state/dense_0.json", "report/run.json", "report/summary.txt"}) {
    EXPECT_GT(fs::remove_all(folder_ / "ws" / name), 0u) << name;
  }
  WriteSparseModelBinary(folder_ / "ws/sparse.tmp/trial_1/0", StripModel(4));
  ExpectDone(Reconstruct("ws", kNoMap));
  EXPECT_FALSE(fs::exists(folder_ / "ws/sparse.tmp"));
  // No record says that the models there are ours.
  for (const char* name :
       {".colmap_seapoint", "dense", "state/mapper.json", "state/dense_0.json"}) {
    EXPECT_GT(fs::remove_all(folder_ / "ws" / name), 0u) << name;
  }
  ExpectRefusal(Reconstruct("ws"), "sparse: was not made by", "--workspace_path");
}

TEST_F(Ownership, AnOutputIsNoInput) {
  ExpectDone(Densify("cloud"));
  constexpr int kUsage = 2;
  const auto refuse = [&](const Arguments& arguments, const std::string& what) {
    ExpectRefusal(arguments, what, "name another", kUsage);
  };
  refuse(Compare("cloud/fused.ply"), "output_path is the input_path");
  fs::create_symlink(folder_ / "cloud/fused.ply", folder_ / "link.ply");
  refuse(Compare("link.ply"), "output_path is the input_path");
  fs::create_hard_link(folder_ / "cloud/fused.ply", folder_ / "hard.ply");
  refuse(Compare("hard.ply"), "output_path is the input_path");
  refuse(Scale("scaled", {"--report_path", Path("positions.csv")}),
         "report_path is the positions_path");
  refuse(Scale("model/../model/"), "output_path is the input_path");
  refuse(Densify("model"), "output_path is the input_path");
  fs::create_directory_symlink(folder_ / "images", folder_ / "link");
  refuse(Densify("link"), "output_path is the image_path");
  refuse(Reconstruct("images"), "workspace_path is the image_path");
  ExpectDone(Compare("c.json", {"--difference_path", Path("diff")}));
  refuse(
      {"cloud_comparer", "--input_path", Path("diff/input_to_reference.ply"), "--reference_path",
       Path("cloud/fused.ply"), "--output_path", Path("d.json"), "--difference_path", Path("diff")},
      "difference_path would replace");
}

// Holds a lock as another run does.
class HeldLock {
 public:
  explicit HeldLock(const fs::path& path) {
    fs::create_directories(path.parent_path());
    descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    EXPECT_EQ(flock(descriptor_, LOCK_EX | LOCK_NB), 0);
  }
  ~HeldLock() { close(descriptor_); }
  HeldLock(const HeldLock&) = delete;
  HeldLock& operator=(const HeldLock&) = delete;

 private:
  int descriptor_ = -1;
};

TEST_F(Ownership, TheSecondRunOnOneOutputIsRefused) {
  ExpectDone(Densify("cloud"));
  const std::vector<std::pair<std::string, Arguments>> outputs = {
      {"out/.colmap_seapoint.lock", Densify("out")},
      {"scaled/.colmap_seapoint.lock", Scale("scaled")},
      {"c.json.lock", Compare("c.json")},
      {"d.db.lock",
       {"feature_extractor", "--database_path", Path("d.db"), "--image_path", Path("images")}},
      {"ws/.colmap_seapoint.lock", Reconstruct("ws")}};
  for (const auto& [lock, arguments] : outputs) {
    {
      const HeldLock other(folder_ / lock);
      ExpectRefusal(arguments, "another run is at work there", "wait for it to end, or choose");
    }
    // Nobody holds it any more: a killed run's file stops nobody, and is gone afterwards.
    EXPECT_TRUE(fs::exists(folder_ / lock));
    ExpectDone(arguments);
    EXPECT_FALSE(fs::exists(folder_ / lock));
  }
}

// Whatever the moment, the next run leaves what an undisturbed one leaves.
TEST_F(Ownership, AKilledRunLeavesNothingForEver) {
  ExpectDone(Densify("whole"));
  int num_killed = 0;
  for (double moment = 0.01; moment < 10; moment *= 1.5) {
    CliOptions options;
    options.kill_when = [&](double now) { return now > moment; };
    const CliResult killed = RunProgram(SEAPOINT_PROGRAM, Densify("out"), options);
    if (killed.signal_number == 0) break;
    ++num_killed;
  }
  EXPECT_GE(num_killed, 3);
  WriteBytes(folder_ / "out/.seapoint_probe_Ab3dE6", "probe");
  WriteBytes(folder_ / "out/.seapoint_0123456789abcdef.tmp", "half a cloud");
  ExpectDone(Densify("out"));
  const auto whole = ReadTree(folder_ / "whole"), out = ReadTree(folder_ / "out");
  ASSERT_EQ(out.size(), whole.size());
  for (const auto& [name, bytes] : whole) EXPECT_EQ(out.count(name), 1u) << name;
  EXPECT_TRUE(out.at("fused.ply") == whole.at("fused.ply"));
}

}  // namespace
}  // namespace colmap_seapoint
