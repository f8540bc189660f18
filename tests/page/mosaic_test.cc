#include "colmap_seapoint/page/mosaic.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class MosaicOfAMap : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // 400 x 200 pixels of 0.1, the preview of half the size.
  void WriteMap(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
    nlohmann::json rows = nlohmann::json::array();
    for (int i = 0; i < 3; ++i) {
      rows.push_back({rotation(i, 0), rotation(i, 1), rotation(i, 2), translation[i]});
    }
    const nlohmann::json map = {{"width", 400},          {"height", 200},
                                {"pixel_size", 0.1},     {"min_x", 1000 - 5.0},
                                {"max_y", 2000 + 15.0},  {"offset", {1000, 2000, 0}},
                                {"map_from_model", rows}};
    WriteTextFile(folder_ / "map.json", map.dump());
    WriteImage(folder_ / "orthomosaic.jpg", ColorImage(200, 100, 3, 90));
  }
  Eigen::Vector2d PlanOf(const Mosaic& mosaic, double column, double row) const {
    return mosaic.plan_from_pixel * Eigen::Vector3d(column, row, 1);
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / "mosaic_of_a_map";
};

TEST_F(MosaicOfAMap, LiesWhereTheMapLies) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d shift(1, 2, 3);
  WriteMap(turn, shift);
  const auto mosaic = ReadMosaic(folder_, PlanFrame(), {0, 0, 7}, 50);
  ASSERT_TRUE(mosaic.has_value());
  EXPECT_EQ(mosaic->picture.width, 50);
  EXPECT_EQ(mosaic->picture.height, 25);
  // The upper left corner is at -5, 15 of the map, the lower right one 40 and 20 units further.
  const auto world = [&](double x, double y) -> Eigen::Vector2d {
    return (turn.transpose() * (Eigen::Vector3d(x, y, 10) - shift)).head<2>();
  };
  EXPECT_LT((PlanOf(*mosaic, 0, 0) - world(-5, 15)).norm(), 1e-9);
  EXPECT_LT((PlanOf(*mosaic, 50, 25) - world(35, -5)).norm(), 1e-9);
  EXPECT_LT((PlanOf(*mosaic, 50, 0) - world(35, 15)).norm(), 1e-9);
}

TEST_F(MosaicOfAMap, OfATiltedMapPlacesOfTheMiddlesHeightFit) {
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  WriteMap(tilt, Eigen::Vector3d::Zero());
  const Eigen::Vector3d middle(4, 3, 2);
  const auto mosaic = ReadMosaic(folder_, PlanFrame(), middle, 4000);
  const Eigen::Vector3d on_map = tilt * middle;
  const Eigen::Vector2d pixel((on_map.x() + 5) / 0.2, (15 - on_map.y()) / 0.2);
  EXPECT_LT((PlanOf(*mosaic, pixel.x(), pixel.y()) - middle.head<2>()).norm(), 1e-9);
}

TEST_F(MosaicOfAMap, NoneAndAnotherPrograms) {
  EXPECT_FALSE(ReadMosaic(folder_, PlanFrame(), {0, 0, 0}, 50).has_value());
  WriteMap(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  for (const char* bad : {"", "[]", "{\"map_from_model\":[1]}"}) {
    WriteTextFile(folder_ / "map.json", bad);
    EXPECT_THROW(ReadMosaic(folder_, PlanFrame(), {0, 0, 0}, 50), Error) << bad;
  }
}

}  // namespace
}  // namespace colmap_seapoint
