// What the last line says: "internal ... please report this" is for mistakes of ours only, and one
// line it is, whatever names hold.
#include <limits>

#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

TEST_F(Faults, NamesCannotSplitOrColourTheLine) {
  for (const std::string name : {"two\nlines", "\x1b[31mred", "bell\a",
                                 "\xc2\x9b"
                                 "31mred"}) {
    const CliResult result =
        Run({"feature_extractor", "--database_path", Path("d.db"), "--image_path", Path(name)});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.LastErrorLine().find("error: " + folder_.Path().string()), 0u)
        << result.Text();
    EXPECT_NE(result.LastErrorLine().find("no such folder"), std::string::npos) << result.Text();
    EXPECT_EQ(result.err.find(name), std::string::npos);
  }
  // Letters of any language are no control characters.
  const CliResult result = Run(
      {"feature_extractor", "--database_path", Path("d.db"), "--image_path", Path("épave 沈船")});
  EXPECT_NE(result.err.find("épave 沈船"), std::string::npos) << result.Text();
}

std::string CloudWith(const std::string& coordinate) {
  std::string cloud =
      "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n";
  for (int i = 0; i < 399; ++i) {
    cloud += std::to_string(i % 20) + " " + std::to_string(i / 20) + " 0\n";
  }
  return cloud + coordinate + " 0 0\n";
}

TEST_F(Faults, HugeCoordinates) {
  WriteBytes(folder_ / "small.ply", CloudWith("19"));
  for (const char* coordinate : {"1e300", "-1e300", "1e30", "1e16"}) {
    WriteBytes(folder_ / "huge.ply", CloudWith(coordinate));
    for (const bool huge_first : {true, false}) {
      const CliResult result =
          Run({"cloud_comparer", "--input_path", Path(huge_first ? "huge.ply" : "small.ply"),
               "--reference_path", Path(huge_first ? "small.ply" : "huge.ply"), "--output_path",
               Path("c.json"), "--difference_path", Path("difference")});
      ExpectFailure(result, "vertex 399");
    }
  }
  WriteBytes(folder_ / "far.ply", CloudWith("1e7"));
  const CliResult result =
      Run({"cloud_comparer", "--input_path", Path("far.ply"), "--reference_path", Path("small.ply"),
           "--output_path", Path("c.json")});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
}

TEST_F(Faults, DistancesTooSmallForTheCoordinates) {
  WriteBytes(folder_ / "far.ply", CloudWith("1e14"));
  const CliResult result =
      Run({"cloud_comparer", "--input_path", Path("far.ply"), "--reference_path", Path("far.ply"),
           "--output_path", Path("c.json"), "--distances", "1e-9"});
  ExpectFailure(result, "1e-09");
}

TEST_F(Faults, AScaledCloudStaysFinite) {
  WriteBytes(folder_ / "positions.csv",
             "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0.1,0\n");
  WriteBytes(folder_ / "huge.ply", CloudWith("1e300"));
  ExpectFailure(Run({"model_scaler", "--input_path", Path("model"), "--output_path", Path("scaled"),
                     "--cloud_path", Path("huge.ply"), "--positions_path", Path("positions.csv")}),
                "huge.ply: a point lies farther");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "scaled/huge.ply"));
}

}  // namespace
}  // namespace colmap_seapoint
