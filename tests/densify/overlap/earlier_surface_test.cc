#include "densify/overlap/earlier_surface.h"

#include <gtest/gtest.h>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kRange = 2;
constexpr int kStep = 2;

class FootprintOfTest : public testing::Test {
 protected:
  // A point for every sample whose pixel lies left of `end`, of a plane across the axis.
  std::vector<Eigen::Vector3f> Points(double end) const {
    std::vector<Eigen::Vector3f> points;
    for (double y = 0.5; y < view_.camera.height; y += kStep) {
      for (double x = 0.5; x < end; x += kStep) {
        const auto ray = view_.camera.CamFromImg({x, y});
        points.push_back((kRange * ray->homogeneous()).cast<float>());
      }
    }
    return points;
  }

  View view_ = {0, MakeCamera(CameraModel::kPinhole, 200, 160, 120), Rigid3d()};
  const CellGrid cells_ = CellsOf(view_.camera, kStep);
};

TEST_F(FootprintOfTest, HoldsACellForEachThatIsFull) {
  const CloudFootprint all = FootprintOf(Points(view_.camera.width), view_, cells_, kStep);
  ASSERT_EQ(all.patches.size(), cells_.Size());
  for (size_t cell = 0; cell < all.patches.size(); ++cell) {
    const SurfacePatch& patch = all.patches[cell];
    EXPECT_NEAR(patch.center.z(), kRange, 1e-5);
    const auto pixel = view_.camera.ImgFromCam(patch.center.cast<double>());
    EXPECT_LT((*pixel - cells_.Center(cell)).norm(), kStep);
    EXPECT_NEAR(patch.size, cells_.cell * kRange / 200, 0.2 * patch.size);
  }
  EXPECT_GT(all.radius, 0.5);
}

TEST_F(FootprintOfTest, LeavesOutWhatIsHalfEmptyOrBehind) {
  // Ten columns of cells, and less than half of the next one.
  std::vector<Eigen::Vector3f> points = Points(10.4 * cells_.cell);
  points.emplace_back(0, 0, -1);
  EXPECT_EQ(FootprintOf(points, view_, cells_, kStep).patches.size(),
            static_cast<size_t>(10 * cells_.height));
  EXPECT_TRUE(FootprintOf({}, view_, cells_, kStep).patches.empty());
}

}  // namespace
}  // namespace colmap_seapoint
