#include "densify/sequence/open_surface.h"

#include <gtest/gtest.h>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

View ViewAbove(double x, double y = 0) {
  const Viewpoint viewpoint =
      StandAt(MakeCamera(CameraModel::kPinhole, 400, 400, 300), {x, y, 0}, {0, 0, 0});
  return {0, viewpoint.camera, viewpoint.cam_from_world};
}

SparseModel ModelOfOneImage() {
  SparseModel model;
  model.images.emplace_back();
  return model;
}

// The left half of the picture is covered.
ViewCoverage LeftHalfCovered(const View& view, const CellGrid& grid) {
  ViewCoverage coverage{grid, std::vector<float>(grid.Size(), 0)};
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (grid.Center(cell).x() >= 200) continue;
    coverage.range[cell] = static_cast<float>(
        kDepth * view.camera.CamFromImg(grid.Center(cell))->homogeneous().norm());
  }
  return coverage;
}

const CellGrid kGrid(400, 300, 10);

TEST(PredictRangesTest, FromCoverageAndTheModelsPoints) {
  SparseModel model = ModelOfOneImage();
  const View view = ViewAbove(0);
  model.images[0].point3D_ids = {kNoPoint3D, 5, 6};
  model.points3D[5].xyz = {0.9, 0.0, 3.0};   // pixel (320, 150)
  model.points3D[6].xyz = {-0.5, 0.0, 7.0};  // in the covered half: no news
  ViewCoverage coverage = LeftHalfCovered(view, kGrid);
  const auto range = PredictRanges(model, model.images[0], view, coverage);
  ASSERT_EQ(range.size(), kGrid.Size());
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    EXPECT_GT(range[cell], 0);
    if (coverage.range[cell] > 0) {
      EXPECT_EQ(range[cell], coverage.range[cell]);
    }
  }
  const double at_point = Eigen::Vector3d(0.9, 0, 3).norm();
  EXPECT_NEAR(range[kGrid.IndexOf(320, 150)], at_point, 1e-9);
  EXPECT_NEAR(range[kGrid.IndexOf(345, 145)], at_point, 1e-9);
  EXPECT_EQ(range[kGrid.IndexOf(205, 25)], coverage.range[kGrid.IndexOf(195, 25)]);

  coverage.range.assign(kGrid.Size(), 0);
  model.images[0].point3D_ids.clear();
  for (const double nothing : PredictRanges(model, model.images[0], view, coverage)) {
    EXPECT_EQ(nothing, 0);
  }
}

TEST(PointAtTest, LiesOnTheRayAtItsRange) {
  const View view = ViewAbove(0.7);
  const auto point = PointAt(view, view.cam_from_world.Inverse(), kGrid, 45, 3);
  ASSERT_TRUE(point);
  EXPECT_NEAR((*point - view.cam_from_world.OriginInSource()).norm(), 3, 1e-12);
  EXPECT_NEAR((*view.camera.ImgFromCam(view.cam_from_world * *point) - kGrid.Center(45)).norm(), 0,
              1e-9);
}

TEST(SeesWellTest, NotAtTheRim) {
  const View view = ViewAbove(0);
  const auto at_pixel = [](double x, double y) {
    return Eigen::Vector3d((x - 200) * kDepth / 400, (y - 150) * kDepth / 400, kDepth);
  };
  EXPECT_TRUE(SeesWell(view, at_pixel(5, 4)));
  EXPECT_FALSE(SeesWell(view, at_pixel(3, 150)));
  EXPECT_FALSE(SeesWell(view, at_pixel(200, 298)));
  EXPECT_FALSE(SeesWell(view, {0, 0, -1}));
}

}  // namespace
}  // namespace colmap_seapoint
