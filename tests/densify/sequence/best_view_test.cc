#include "densify/sequence/best_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

View Ahead(const Eigen::Vector3d& center) {
  const Viewpoint view =
      StandAt(MakeCamera(CameraModel::kPinhole, 500, 640, 480), center, {0, 0, 0});
  return {0, view.camera, view.cam_from_world};
}

TEST(RangeUncertaintyTest, IsTheCoarserGsdOverTheParallax) {
  const Eigen::Vector3d place(0, 0, 4);
  // 5 degrees: a ground sampling distance of 4 / 500, and a chord of 2 sin(2.5 degrees).
  const double baseline = 8 * std::tan(2.5 * M_PI / 180);
  const View left = Ahead({-baseline / 2, 0, 0}), right = Ahead({baseline / 2, 0, 0});
  const double range = 4 / std::cos(2.5 * M_PI / 180);
  EXPECT_NEAR(RangeUncertainty(left, right, place), range / 500 / (2 * std::sin(2.5 * M_PI / 180)),
              1e-9);
  // Twice as far away: the sampling distance doubles, the parallax halves.
  EXPECT_NEAR(RangeUncertainty(left, right, {0, 0, 8}) / RangeUncertainty(left, right, place), 4,
              0.02);
  // A nearer second view does not make the farther one sharper.
  EXPECT_GT(RangeUncertainty(Ahead({0, 0, 0}), Ahead({0.3, 0, 2}), place), 4.0 / 500 / 0.2);
}

TEST(RangeUncertaintyTest, InfiniteWhereNothingIsMeasured) {
  const Eigen::Vector3d place(0, 0, 4);
  EXPECT_EQ(RangeUncertainty(Ahead({0, 0, 0}), Ahead({0.1, 0, 0}), place), kInfinite);  // 1.4 deg
  EXPECT_LT(RangeUncertainty(Ahead({0, 0, 0}), Ahead({0.2, 0, 0}), place), kInfinite);
  EXPECT_EQ(RangeUncertainty(Ahead({0, 0, 0}), Ahead({9, 0, 0}), place), kInfinite);  // not in view
  EXPECT_EQ(RangeUncertainty(Ahead({0, 0, 0}), Ahead({0.4, 0, 5}), place), kInfinite);  // behind
}

// Towards a wall: what the first pair sees at 4, later ones see at 2.
TEST(BestViewTest, ThePairThatIsNearerMeasuresThePlace) {
  const View far1 = Ahead({-0.3, 0, 0}), far2 = Ahead({0.3, 0, 0});
  const View near1 = Ahead({-0.2, 0, 2}), near2 = Ahead({0.2, 0, 2});
  const CellGrid grid(640, 480, 8);
  std::vector<double> ranges(grid.Size());
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    ranges[cell] = 4 * far1.camera.CamFromImg(grid.Center(cell))->homogeneous().norm();
  }
  const auto closed_by = [&](const std::vector<View>& others) {
    KnownCells known{grid, {}, {}};
    LeaveToBetterPairs(far1, far2, ranges, AdmissibleUncertainty(far1, others, grid, ranges),
                       &known);
    return known.closed;
  };
  const std::vector<uint8_t> alone = closed_by({far2});
  const std::vector<uint8_t> with_nearer = closed_by({far2, near1, near2});
  int num_left = 0;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    const double x = grid.Center(cell).x();
    if (x > 100 && x < 540) {
      EXPECT_EQ(alone[cell], 0) << x;
    }
    const Eigen::Vector3d place =
        far1.cam_from_world.Inverse() *
        (ranges[cell] * far1.camera.CamFromImg(grid.Center(cell))->homogeneous().normalized());
    // Away from the rims of blocks of cells that are looked up at once.
    const auto well_inside = [&](const View& view, double margin) {
      const auto pixel = view.camera.ImgFromCam(view.cam_from_world * place);
      return pixel && pixel->x() > margin && pixel->y() > margin && pixel->x() < 640 - margin &&
             pixel->y() < 480 - margin;
    };
    if (well_inside(near1, 80) && well_inside(near2, 80)) {
      EXPECT_EQ(with_nearer[cell], 1);
      ++num_left;
    }
    if (!well_inside(near1, -80) && !well_inside(near2, -80)) {
      EXPECT_EQ(with_nearer[cell], alone[cell]);
    }
  }
  EXPECT_GT(num_left, 100);
}

}  // namespace
}  // namespace colmap_seapoint
