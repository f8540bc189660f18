// cloud_exporter, as a user runs it.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

class CloudExporter : public testing::Test {
 protected:
  void SetUp() override {
    CloudWriter writer(folder_ / "fused.ply");
    for (int i = 0; i < 50; ++i) {
      CloudPoint point;
      point.xyz = Eigen::Vector3f(0.1f * static_cast<float>(i), 2, -3);
      writer.Add(point, nullptr, 0);
    }
    writer.Finish();
  }

  CliResult Export(const std::string& output, const std::vector<std::string>& more = {},
                   const CliOptions& options = {}) const {
    std::vector<std::string> arguments = {"cloud_exporter", "--input_path",
                                          (folder_ / "fused.ply").string(), "--output_path",
                                          (folder_ / output).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }
  void WriteUnits(const std::string& crs) const {
    ModelUnits units;
    units.is_metric = true;
    units.frame = "projected";
    units.crs = crs;
    units.offset = {500000, 7000000, -30};
    WriteModelUnits(folder_.Path(), units);
  }
  double MinX(const std::string& output) const {
    const std::string bytes = ReadBytes(folder_ / output);
    double value = 0;
    if (bytes.size() > 195) std::memcpy(&value, bytes.data() + 187, sizeof(value));
    return value;
  }

  TemporaryFolder folder_;
};

TEST_F(CloudExporter, UnitsBesideTheCloudPlaceIt) {
  EXPECT_EQ(Export("plain.las").exit_code, 0);
  EXPECT_NEAR(MinX("plain.las"), 0, 1e-6);
  WriteUnits("EPSG:32755");
  const CliResult result = Export("cloud.LAS");
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NEAR(MinX("cloud.LAS"), 500000, 1e-6);
  EXPECT_NE(ReadBytes(folder_ / "cloud.LAS").find("UTM zone 55S"), std::string::npos);
  // Its own file is replaced, the same again.
  const std::string before = ReadBytes(folder_ / "cloud.LAS");
  EXPECT_EQ(Export("cloud.LAS").exit_code, 0);
  EXPECT_EQ(ReadBytes(folder_ / "cloud.LAS"), before);
}

TEST_F(CloudExporter, UnitsMayHaveAnotherName) {
  WriteUnits("EPSG:32755");
  std::filesystem::rename(folder_ / kUnitsFile, folder_ / "dive.json");
  EXPECT_EQ(Export("cloud.las", {"--units_path", (folder_ / "dive.json").string()}).exit_code, 0);
  EXPECT_NEAR(MinX("cloud.las"), 500000, 1e-6);
  const CliResult none = Export("none.las", {"--units_path", (folder_ / "none.json").string()});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.LastErrorLine().find("none.json"), std::string::npos);
}

TEST_F(CloudExporter, OthersFilesStay) {
  for (const std::string& text : {std::string("LASF a laser scan"), std::string("notes")}) {
    WriteBytes(folder_ / "cloud.las", text);
    const CliResult result = Export("cloud.las");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.LastErrorLine().find("choose another --output_path"), std::string::npos);
    EXPECT_EQ(ReadBytes(folder_ / "cloud.las"), text);
  }
  // A cloud of ours under that name is no export either.
  std::filesystem::copy_file(folder_ / "fused.ply", folder_ / "copy.las");
  EXPECT_EQ(Export("copy.las").exit_code, 1);
}

TEST_F(CloudExporter, FaultsAreOneLine) {
  EXPECT_EQ(Export("cloud.xyz").exit_code, 2);
  WriteUnits("EPSG:99999999");
  const CliResult unknown = Export("cloud.las");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.LastErrorLine().find("none that PROJ knows"), std::string::npos);
  WriteUnits("EPSG:32755");
  CliOptions full;
  full.max_file_bytes = 1000;
  const CliResult disk = Export("cloud.las", {}, full);
  EXPECT_EQ(disk.exit_code, 1) << disk.Text();
  EXPECT_NE(disk.LastErrorLine().find("cloud.las: cannot be written"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "cloud.las"));
}

}  // namespace
}  // namespace colmap_seapoint
