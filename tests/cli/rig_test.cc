// Stereo rigs: --rig of partial_densifier and automatic_reconstructor, and frames of the model.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumFrames = 5;

std::string LeftName(int frame) { return "left/img" + std::to_string(2 * frame + 1) + ".png"; }
std::string RightName(int frame) { return "right/img" + std::to_string(2 * frame + 2) + ".png"; }

using NamePairs = std::vector<std::pair<std::string, std::string>>;

// The strip's pictures in turn left and right: left ones advance by 180 of 400 pixels, right ones
// are 90 further.
class Rig : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "images" / "left");
    fs::create_directories(folder_ / "images" / "right");
    model_ = StripModel(2 * kNumFrames);
    model_.cameras[2] = model_.cameras[1];
    model_.cameras[2].camera_id = 2;
    for (int i = 0; i < 2 * kNumFrames; ++i) {
      PosedImage& image = model_.images[static_cast<size_t>(i)];
      image.name = i % 2 == 0 ? LeftName(i / 2) : RightName(i / 2);
      image.camera_id = i % 2 == 0 ? 1 : 2;
      WriteImage(folder_ / "images" / image.name, StripPicture(i + 1));
    }
    WriteSparseModelText(folder_ / "model", model_);
  }

  void WriteFrames() const {
    std::ostringstream frames;
    frames << "# Frame list with one line of data per frame:\n# Number of frames: " << kNumFrames
           << "\n";
    for (int k = 0; k < kNumFrames; ++k) {
      frames << k + 1 << " 1 1 0 0 0 0 0 0 2 CAMERA 1 " << 2 * k + 1 << " CAMERA 2 " << 2 * k + 2
             << "\n";
    }
    WriteBytes(folder_ / "model" / "frames.txt", frames.str());
  }

  CliResult Densify(const std::string& rig) const {
    std::vector<std::string> arguments = {"partial_densifier",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--input_path",
                                          (folder_ / "model").string(),
                                          "--output_path",
                                          (folder_ / "dense").string(),
                                          "--PartialDensification.completion",
                                          "0"};
    if (!rig.empty()) arguments.insert(arguments.end(), {"--rig", rig});
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }

  // Of the pairs that were densified.
  static NamePairs PairsIn(const fs::path& csv) {
    NamePairs pairs;
    std::istringstream lines(ReadBytes(csv));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      const size_t first = line.find(','), second = line.find(',', first + 1);
      if (line.back() != ',') continue;  // skipped, with a reason
      pairs.emplace_back(line.substr(0, first), line.substr(first + 1, second - first - 1));
    }
    return pairs;
  }

  std::string Cloud() const { return ReadBytes(folder_ / "dense" / "fused.ply"); }

  TemporaryFolder folder_;
  SparseModel model_;
};

TEST_F(Rig, PairsAreSimultaneous) {
  const CliResult result = Densify("left,right/");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  NamePairs expected;
  for (int k = 0; k < kNumFrames; ++k) expected.emplace_back(LeftName(k), RightName(k));
  EXPECT_EQ(PairsIn(folder_ / "dense" / "pairs.csv"), expected);
  // Without a rig left ones follow left ones.
  ASSERT_EQ(Densify("").exit_code, 0);
  const NamePairs sequence = PairsIn(folder_ / "dense" / "pairs.csv");
  ASSERT_FALSE(sequence.empty());
  EXPECT_EQ(sequence[0], std::pair(LeftName(0), LeftName(1)));
}

TEST_F(Rig, FramesOfTheModelSayTheSame) {
  ASSERT_EQ(Densify("").exit_code, 0);
  const std::string without = Cloud();
  ASSERT_EQ(Densify("left,right").exit_code, 0);
  const std::string with = Cloud();
  EXPECT_FALSE(with == without);
  WriteFrames();
  const CliResult result = Densify("");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("Stereo rig: 5 frames"), std::string::npos) << result.err;
  EXPECT_TRUE(Cloud() == with);
  ASSERT_EQ(Densify("none").exit_code, 0);
  EXPECT_TRUE(Cloud() == without);
  WriteBytes(folder_ / "model" / "frames.txt", "what a newer version may write\n");
  const CliResult damaged = Densify("");
  EXPECT_EQ(damaged.exit_code, 0) << damaged.Text();
  EXPECT_NE(damaged.err.find("no stereo rig is taken from it"), std::string::npos);
  EXPECT_TRUE(Cloud() == without);
}

TEST_F(Rig, WrongUsage) {
  for (const std::string rig : {"left", "left,", ",right", "left,left", "left,../right", "a,b,c"}) {
    const CliResult result = Densify(rig);
    EXPECT_EQ(result.exit_code, 2) << rig << "\n" << result.Text();
    EXPECT_NE(result.err.find("LEFT,RIGHT"), std::string::npos) << result.Text();
  }
  CliResult result = Densify("left,starboard");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("images/starboard: there is no such folder"),
            std::string::npos)
      << result.Text();
  fs::remove(folder_ / "images" / RightName(2));  // now the order says nothing
  result = Densify("left,right");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("no picture of left (5 pictures) has a simultaneous one in "
                                        "right (4 pictures)"),
            std::string::npos)
      << result.Text();
}

TEST_F(Rig, AModelOfOneCameraIsASequence) {
  std::vector<PosedImage> left;
  for (const PosedImage& image : model_.images) {
    if (image.camera_id == 1) left.push_back(image);
  }
  model_.images = left;
  for (auto& [id, point] : model_.points3D) {
    std::vector<SparsePoint::TrackElement> track;
    for (const auto& element : point.track) {
      if (element.image_id % 2 == 1) track.push_back(element);
    }
    point.track = track;
  }
  WriteSparseModelText(folder_ / "model", model_);
  const CliResult result = Densify("left,right");
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("no two simultaneous pictures"), std::string::npos) << result.Text();
}

TEST_F(Rig, AutomaticReconstructorHandsItOn) {
  const auto reconstruct = [&](const std::string& rig) {
    CliOptions options;
    options.environment["FAKE_COLMAP_MODE"] = "model";
    return RunProgram(SEAPOINT_PROGRAM,
                      {"automatic_reconstructor", "--image_path", (folder_ / "images").string(),
                       "--workspace_path", (folder_ / "workspace").string(), "--colmap_path",
                       FAKE_COLMAP, "--rig", rig, "--PartialDensification.completion", "0"},
                      options);
  };
  EXPECT_EQ(reconstruct("left").exit_code, 2);
  EXPECT_EQ(reconstruct("left,nowhere").exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "workspace" / "database.db"));  // seen before the work
  const CliResult result = reconstruct("left,right");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  const NamePairs pairs = PairsIn(folder_ / "workspace" / "dense" / "0" / "pairs.csv");
  ASSERT_FALSE(pairs.empty());
  for (const auto& [first, second] : pairs) {
    EXPECT_EQ(first.find("left/"), 0u) << first;
    EXPECT_EQ(second.find("right/"), 0u) << second;
  }
  // Another rig, another cloud: the finished one is not taken for it.
  ASSERT_EQ(reconstruct("none").exit_code, 0);
  EXPECT_NE(PairsIn(folder_ / "workspace" / "dense" / "0" / "pairs.csv"), pairs);
}

}  // namespace
}  // namespace colmap_seapoint
