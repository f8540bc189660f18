#include "densify/overlap/coverage.h"

#include <gtest/gtest.h>

#include "tests/densify/pair_scene.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

Viewpoint Above(double x, double y, const Eigen::Vector3d& turn_deg = {0, 0, 0}) {
  return StandAt(MildCamera(CameraModel::kOpenCV, 420, 480, 360), {x, y, 0}, turn_deg);
}

// The patches that a picture's cells would leave, all of them reconstructed.
CloudFootprint FullFootprint(const World& world, const Viewpoint& view, const CellGrid& grid) {
  CloudFootprint footprint;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    const auto point = SurfaceAt(world, view, grid.Center(cell));
    const double range = (*point - view.Center()).norm();
    footprint.patches.push_back(
        {point->cast<float>(), static_cast<float>(grid.cell * range / view.camera.MeanFocal())});
  }
  footprint.UpdateSphere();
  return footprint;
}

const CellGrid kGrid(480, 360, 8);

TEST(ProjectCoverageTest, SeenAgainItCoversWhatItCovered) {
  const World world = FlatWorld(kDepth);
  const Viewpoint view = Above(0, 0, {3, -4, 25});
  CloudFootprint footprint = FullFootprint(world, view, kGrid);
  const ViewCoverage full = ProjectCoverage({footprint}, view.camera, view.cam_from_world, kGrid);
  EXPECT_EQ(full.CoveredShare(), 1);
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    const double range = (*SurfaceAt(world, view, kGrid.Center(cell)) - view.Center()).norm();
    ASSERT_NEAR(full.range[cell], range, 0.02 * range);
  }
  // Without the patches of a block of cells, that block is open, up to its rim.
  std::vector<SurfacePatch> rest;
  auto in_hole = [](size_t cell) {
    const size_t a = cell % 60, b = cell / 60;
    return a >= 20 && a < 35 && b >= 10 && b < 25;
  };
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    if (!in_hole(cell)) rest.push_back(footprint.patches[cell]);
  }
  footprint.patches = rest;
  footprint.UpdateSphere();
  const ViewCoverage holed = ProjectCoverage({footprint}, view.camera, view.cam_from_world, kGrid);
  int num_wrong = 0;
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    num_wrong += (holed.range[cell] > 0) == in_hole(cell);
  }
  EXPECT_LE(num_wrong, 30);
}

TEST(ProjectCoverageTest, FromAnotherPlaceItCoversTheOverlap) {
  const World world = FlatWorld(kDepth);
  const Viewpoint view1 = Above(0, 0), view2 = Above(0.6, 0.2, {0, 0, 90});
  const ViewCoverage coverage = ProjectCoverage({FullFootprint(world, view1, kGrid)}, view2.camera,
                                                view2.cam_from_world, kGrid);
  int num_wrong = 0;
  for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
    const auto point = SurfaceAt(world, view2, kGrid.Center(cell));
    const bool seen_by_first = PixelOf(world, view1, *point).has_value();
    num_wrong += seen_by_first != (coverage.range[cell] > 0);
    if (seen_by_first && coverage.range[cell] > 0) {
      ASSERT_NEAR(coverage.range[cell], (*point - view2.Center()).norm(), 0.04);
    }
  }
  EXPECT_LT(num_wrong, 0.03 * static_cast<double>(kGrid.Size()));
  EXPECT_GT(coverage.CoveredShare(), 0.3);
  EXPECT_LT(coverage.CoveredShare(), 0.9);
}

TEST(ProjectCoverageTest, BehindTheCameraOrAsideThereIsNothing) {
  const World world = FlatWorld(kDepth);
  const CloudFootprint footprint = FullFootprint(world, Above(0, 0), kGrid);
  for (const Viewpoint& view : {Above(0, 0, {0, 180, 0}), Above(30, 0), Above(0, -30),
                                Above(0, 0, {0, 90, 0}), Above(0, 0, {90, 0, 0})}) {
    EXPECT_EQ(ProjectCoverage({footprint}, view.camera, view.cam_from_world, kGrid).CoveredShare(),
              0);
  }
  const Viewpoint view = Above(0, 0);
  EXPECT_EQ(ProjectCoverage({}, view.camera, view.cam_from_world, kGrid).CoveredShare(), 0);
  EXPECT_EQ(
      ProjectCoverage({CloudFootprint()}, view.camera, view.cam_from_world, kGrid).CoveredShare(),
      0);
}

TEST(ProjectCoverageTest, TheNearestSurfaceWins) {
  const Viewpoint view = Above(0, 0);
  const CloudFootprint near = FullFootprint(FlatWorld(1.5), view, kGrid);
  const CloudFootprint far = FullFootprint(FlatWorld(2.5), view, kGrid);
  for (const auto& footprints : {std::vector<PackedFootprint>{near, far}, {far, near}}) {
    const ViewCoverage coverage =
        ProjectCoverage(footprints, view.camera, view.cam_from_world, kGrid);
    for (size_t cell = 0; cell < kGrid.Size(); ++cell) {
      const auto ray = view.camera.CamFromImg(kGrid.Center(cell));
      ASSERT_NEAR(coverage.range[cell], 1.5 * ray->homogeneous().norm(), 0.03);
    }
  }
}

// What a pair really reconstructs covers its own first picture as `filled` says.
TEST(ProjectCoverageTest, OfARealPair) {
  const PairScene scene(FlatWorld(kDepth), Above(-0.15, 0, {1, 2, 3}), Above(0.15, 0, {-2, 1, -4}));
  const PartialDensificationOptions options;
  const PairInput input = scene.Input(options);
  const PairResult result = DensifyPair(input, options, 2);
  const ViewCoverage coverage = ProjectCoverage({result.footprint}, scene.view1.camera,
                                                scene.view1.cam_from_world, input.known.grid);
  int num_missing = 0, num_filled = 0, num_false = 0;
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    num_filled += result.filled[cell] >= 0.9f;
    num_missing += result.filled[cell] >= 0.9f && coverage.range[cell] == 0;
    num_false += result.filled[cell] == 0 && coverage.range[cell] > 0;
  }
  EXPECT_LT(num_missing, 0.02 * num_filled);
  EXPECT_LT(num_false, 0.02 * num_filled);
}

}  // namespace
}  // namespace colmap_seapoint
