#include "colmap_seapoint/orthomosaic/relief/cloud_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "colmap_seapoint/io/cloud/ply.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// A grid in rows, as other programs write it: equal steps through the file all hit the same
// columns.
TEST(SampleCloud, IsFromAllOverACloudInRows) {
  const TempDir dir;
  constexpr int kRows = 1000, kColumns = 200;
  CloudWriter cloud(dir.Path() / "fused.ply");
  CloudPoint point;
  point.normal = Eigen::Vector3f::UnitZ();
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      point.xyz = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0);
      cloud.Add(point, nullptr, 0);
    }
  }
  cloud.Finish();
  const std::vector<Eigen::Vector3d> sample = SampleCloud(dir.Path() / "fused.ply");
  ASSERT_EQ(sample.size(), 100000u);
  for (int column = 0; column < kColumns; column += 20) {
    const auto near =
        std::count_if(sample.begin(), sample.end(), [&](const Eigen::Vector3d& place) {
          return place.x() >= column && place.x() < column + 20;
        });
    EXPECT_GT(near, 1500) << column;  // of 10,000 each; the outer ones are in fewer ranges
  }
}

}  // namespace
}  // namespace colmap_seapoint
