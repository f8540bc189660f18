#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

// A lattice of `side` x `side` points one apart, raised by `height`.
std::string Lattice(int side, float height) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(side * side) +
                      "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int i = 0; i < side * side; ++i) {
    const float xyz[] = {static_cast<float>(i % side), static_cast<float>(i / side), height};
    bytes.append(reinterpret_cast<const char*>(xyz), sizeof(xyz));
  }
  return bytes;
}

class CloudComparer : public testing::Test {
 protected:
  CliResult Compare(std::vector<std::string> more = {}, const CliOptions& options = {}) {
    std::vector<std::string> arguments = {"cloud_comparer",
                                          "--input_path",
                                          (folder_ / "a.ply").string(),
                                          "--reference_path",
                                          (folder_ / "b.ply").string(),
                                          "--output_path",
                                          (folder_ / "out.json").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  nlohmann::json Json() { return nlohmann::json::parse(ReadBytes(folder_ / "out.json")); }

  TemporaryFolder folder_;
};

TEST_F(CloudComparer, NamesEveryMeasureAndItsDefinition) {
  WriteBytes(folder_ / "a.ply", Lattice(20, 0.25f));
  WriteBytes(folder_ / "b.ply", Lattice(40, 0));
  const CliResult result = Compare({"--distances", "0.2,0.5", "--unit_in_metres", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  for (const char* word : {"ETH3D", "Tanks and Temples", "hole area", "per cm^2"}) {
    EXPECT_NE(result.out.find(word), std::string::npos) << word;
  }
  const nlohmann::json json = Json();
  for (const char* part : {"points", "eth3d", "tanks_and_temples"}) {
    EXPECT_NE(json[part]["definition"].get<std::string>().find(" of the "), std::string::npos);
    EXPECT_EQ(json[part]["at"].size(), 2u);
  }
  EXPECT_EQ(json["input"]["points"], 400);
  EXPECT_EQ(json["reference"]["spacing"], 1);
  EXPECT_EQ(json["points"]["at"][0]["accuracy"], 0);
  EXPECT_EQ(json["points"]["at"][1]["accuracy"], 1);
  EXPECT_EQ(json["points"]["at"][1]["completeness"], 0.25);
  EXPECT_EQ(json["eth3d"]["at"][1]["completeness"], 0.25);
  EXPECT_EQ(json["tanks_and_temples"]["at"][1]["recall"], 0.25);
  EXPECT_EQ(json["tanks_and_temples"]["at"][1]["f_score"], 0.4);
  EXPECT_EQ(json["distance"]["input_to_reference"]["median"], 0.25);
  // Cells at the rim hold a larger or smaller share of covered points.
  EXPECT_NEAR(json["holes"][1]["hole_share"].get<double>(), 0.75, 0.005);
  EXPECT_EQ(json["reference"]["points_per_cm2"].get<double>() * 1e4,
            json["reference"]["points_per_unit2"]);
}

TEST_F(CloudComparer, LeavesDifferencesAndNothingElse) {
  WriteBytes(folder_ / "a.ply", Lattice(20, 0.25f));
  WriteBytes(folder_ / "b.ply", Lattice(40, 0));
  const CliResult result =
      Compare({"--distances", "0.5", "--difference_path", (folder_ / "d").string()});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  CloudReader reader(folder_ / "d" / "input_to_reference.ply");
  EXPECT_EQ(reader.NumPoints(), 400u);
  EXPECT_EQ(CloudReader(folder_ / "d" / "reference_to_input.ply").NumPoints(), 1600u);
  const ColorImage picture = ReadColorImage(folder_ / "d" / "differences.png");
  EXPECT_EQ(picture.width, 1000);
  std::vector<std::string> names;
  for (const auto& item : ReadTree(folder_.Path())) names.push_back(item.first);
  EXPECT_EQ(names, (std::vector<std::string>{"a.ply", "b.ply", "d/.colmap_seapoint",
                                             "d/differences.png", "d/input_to_reference.ply",
                                             "d/reference_to_input.ply", "out.json"}));
}

TEST_F(CloudComparer, BadInputIsNamed) {
  const std::string good = Lattice(5, 0);
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  std::string no_xyz = good;
  no_xyz.replace(no_xyz.find("float z"), 7, "float q");
  const std::string faces =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int v\nend_header\n1 2\n";
  const std::pair<std::string, const char*> cases[] = {
      {good.substr(0, good.size() - 1), "is truncated"},
      {no_xyz, "no property z"},
      {faces, "no element 'vertex'"},
      {ascii + "0 0 0\n0 nan 0\n", "vertex 1 is not finite"},
      {ascii + "0 0 0\n0 1", "is truncated"},
      {Lattice(0, 0), "holds no points"},
      {"", "is not a PLY file"}};
  for (const auto& [bytes, part] : cases) {
    for (const bool is_input : {true, false}) {
      WriteBytes(folder_ / (is_input ? "a.ply" : "b.ply"), bytes);
      WriteBytes(folder_ / (is_input ? "b.ply" : "a.ply"), good);
      const CliResult result = Compare();
      EXPECT_EQ(result.exit_code, 1) << result.Text();
      const std::string line = result.LastErrorLine();
      EXPECT_NE(line.find(is_input ? "a.ply: " : "b.ply: "), std::string::npos) << line;
      EXPECT_NE(line.find(part), std::string::npos) << line;
      EXPECT_NE(line.find("; "), std::string::npos) << line;
      EXPECT_EQ(ReadTree(folder_.Path()).size(), 2u);
    }
  }
}

TEST_F(CloudComparer, BadOptionsAreUsage) {
  WriteBytes(folder_ / "a.ply", Lattice(5, 0));
  WriteBytes(folder_ / "b.ply", Lattice(5, 0));
  for (const char* distances :
       {"0", "-1", "1,1", "2,1", "1,", ",", "one", "nan", "1e999", "1,2,3,4,5,6,7,8,9"}) {
    const CliResult result = Compare({"--distances", distances});
    EXPECT_EQ(result.exit_code, 2) << distances << result.Text();
    EXPECT_NE(result.LastErrorLine().find("--distances"), std::string::npos);
  }
  EXPECT_EQ(Compare({"--distances", "2", "--max_distance", "1"}).exit_code, 2);
}

// More points, more tiles, no more memory: 12 bytes a point would be 26 MB more.
TEST_F(CloudComparer, MemoryDoesNotGrowWithTheClouds) {
  const std::vector<std::string> options = {"--distances", "0.5", "--num_threads", "1"};
  uint64_t peaks[2];
  int i = 0;
  for (const int side : {700, 1250}) {
    WriteBytes(folder_ / "a.ply", Lattice(side, 0.25f));
    WriteBytes(folder_ / "b.ply", Lattice(side, 0));
    const CliResult result = Compare(options);
    ASSERT_EQ(result.exit_code, 0) << result.Text();
    peaks[i++] = result.peak_rss_bytes;
  }
  EXPECT_LT(peaks[1], peaks[0] + 13000000) << peaks[0];
}

TEST_F(CloudComparer, AFullDiskIsOneLine) {
  WriteBytes(folder_ / "a.ply", Lattice(300, 0));
  WriteBytes(folder_ / "b.ply", Lattice(300, 0));
  CliOptions options;
  options.max_file_bytes = 100000;
  const CliResult result = Compare({}, options);
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("temporary file cannot be written"), std::string::npos);
  EXPECT_EQ(ReadTree(folder_.Path()).size(), 2u);
}

}  // namespace
}  // namespace colmap_seapoint
