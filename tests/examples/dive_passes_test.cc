#include "examples/survey/paths/dive_passes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

class DivePassesTest : public testing::Test {
 protected:
  ~DivePassesTest() override { std::filesystem::remove(path_); }

  // A pass of two lines along y and back, in a map that is the world turned: its x is the world's
  // y.
  static Json Pass(double tilt_deg) {
    return {{"type", "Feature"},
            {"geometry",
             {{"type", "LineString"},
              {"coordinates", {{0, 0, 2}, {0, 6, 2}, {1.5, 6, 2}, {1.5, 0, 2}}}}},
            {"properties",
             {{"kind", "pass"},
              {"gap", 7},
              {"num_lines", 2},
              {"num_pictures", 8},
              {"tilt_deg", tilt_deg}}}};
  }
  DivePasses Plan(const Json& features) const {
    const Json json = {{"map_from_model", {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}},
                       {"features", features}};
    WriteTextFile(path_, json.dump());
    return PlanPasses(path_, "jpg", 1, 0);
  }

  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / "dive_passes.geojson";
};

TEST_F(DivePassesTest, LinesAreSwumFromEndToEndLookingDown) {
  const DivePasses dive = Plan({Pass(0), Pass(90)});
  EXPECT_EQ(dive.num_tilted, 1);
  ASSERT_EQ(dive.images.size(), 8u);
  EXPECT_EQ(dive.images[0].name, "pass_007_001.jpg");
  for (size_t k = 0; k < 8; ++k) {
    const Rigid3d& pose = dive.images[k].cam_from_world;
    const Eigen::Vector3d center = pose.OriginInSource();
    const double along = k < 4 ? 2.0 * static_cast<double>(k) : 2.0 * static_cast<double>(7 - k);
    // The map's (x, y) is the world's (-y, x).
    EXPECT_LT((center - Eigen::Vector3d(-along, k < 4 ? 0 : 1.5, 2)).norm(), 1e-9) << k;
    const Eigen::Vector3d view = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT((view - Eigen::Vector3d(0, 0, -1)).norm(), 1e-9);
    // What lies ahead is up in the picture.
    const Eigen::Vector3d up = pose.rotation.conjugate() * -Eigen::Vector3d::UnitY();
    EXPECT_LT((up - Eigen::Vector3d(k < 4 ? -1 : 1, 0, 0)).norm(), 1e-9) << k;
  }
}

TEST_F(DivePassesTest, WhatCannotBePhotographedIsRefused) {
  EXPECT_THROW(Plan(Json::array()), Error);
  EXPECT_THROW(Plan({Pass(90)}), Error);
  Json pass = Pass(0);
  pass["properties"]["num_pictures"] = 2;
  EXPECT_THROW(Plan({pass}), Error);
  pass = Pass(0);
  pass["geometry"]["coordinates"] = {{0, 0, 2}};
  EXPECT_THROW(Plan({pass}), Error);
  // Of a georeferenced report: no map_from_model.
  WriteTextFile(path_, R"({"features":[]})");
  EXPECT_THROW(PlanPasses(path_, "jpg", 1, 0), Error);
  WriteTextFile(path_, "no JSON");
  EXPECT_THROW(PlanPasses(path_, "jpg", 1, 0), Error);
}

}  // namespace
}  // namespace colmap_seapoint
