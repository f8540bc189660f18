// Real underwater pictures with positions known to a few centimetres.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

fs::path Data() {
  const char* folder = std::getenv("SEAPOINT_DATA");
  return folder != nullptr ? folder : SEAPOINT_DEFAULT_DATA;
}

// image,centre_easting_m,centre_northing_m,...
std::map<std::string, Eigen::Vector3d> ReadPositions(const fs::path& path) {
  std::map<std::string, Eigen::Vector3d> positions;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string name, easting, northing;
    std::getline(fields, name, ',');
    std::getline(fields, easting, ',');
    std::getline(fields, northing, ',');
    positions[name] = {std::stod(easting), std::stod(northing), 0};
  }
  return positions;
}

// After the best similarity between camera centres and positions, metres.
double LargestCentreError(const SparseModel& model,
                          const std::map<std::string, Eigen::Vector3d>& positions) {
  Eigen::Matrix3Xd centres(3, static_cast<Eigen::Index>(model.images.size()));
  Eigen::Matrix3Xd truth = centres;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    centres.col(column) = model.images[i].cam_from_world.OriginInSource();
    truth.col(column) = positions.at(model.images[i].name);
  }
  const Eigen::Vector3d origin = truth.rowwise().mean();  // keeps the numbers small
  truth.colwise() -= origin;
  const Eigen::Matrix4d fit = Eigen::umeyama(centres, truth, true);
  return ((fit.topLeftCorner<3, 3>() * centres).colwise() + fit.topRightCorner<3, 1>() - truth)
      .colwise()
      .norm()
      .maxCoeff();
}

class AuvStrip : public testing::TestWithParam<const char*> {};

TEST_P(AuvStrip, EveryPictureInOneModelAtItsPlace) {
  const fs::path strip = Data() / "auv_strips" / GetParam();
  if (!fs::exists(strip)) GTEST_SKIP() << "no evaluation data at " << strip;
  const TemporaryFolder folder;
  const fs::path workspace = folder / "ws";
  CliOptions options;
  options.timeout_seconds = 200;
  const CliResult run =
      RunProgram(SEAPOINT_PROGRAM,
                 {"automatic_reconstructor", "--image_path", (strip / "images").string(),
                  "--workspace_path", workspace.string()},
                 options);
  ASSERT_EQ(run.exit_code, 0) << run.Text();
  const auto positions = ReadPositions(strip / "geo.csv");
  const SparseModel model = ReadSparseModel(workspace / "sparse/0");
  EXPECT_EQ(model.images.size(), positions.size());
  EXPECT_LE(LargestCentreError(model, positions), 0.12);
}

INSTANTIATE_TEST_SUITE_P(Strips, AuvStrip, testing::Values("t1", "t3", "t4", "t6"),
                         [](const auto& strip) { return std::string(strip.param); });

}  // namespace
}  // namespace colmap_seapoint
