#include "densify/match/rectification.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

std::optional<PairGeometry> GeometryOf(const Viewpoint& view1, const Viewpoint& view2) {
  return MakePairGeometry(view1.camera, view1.cam_from_world, view2.camera, view2.cam_from_world);
}

class AllCamerasTest : public testing::TestWithParam<CameraModel> {
 protected:
  Viewpoint view1_ = StandAt(MildCamera(GetParam(), 520, 640, 480), {0.1, -0.2, 0.05}, {4, -5, 20});
  Viewpoint view2_ = StandAt(MildCamera(GetParam(), 560, 600, 500), {0.5, 0.1, -0.02}, {-6, 3, 11});
};

TEST_P(AllCamerasTest, PointsLandOnEqualRowsWithTheRightDisparity) {
  const auto geometry = GeometryOf(view1_, view2_);
  ASSERT_TRUE(geometry);
  EXPECT_NEAR(geometry->baseline, (view1_.Center() - view2_.Center()).norm(), 1e-12);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  int num_checked = 0;
  while (num_checked < 300) {
    const Eigen::Vector3d point(unit(generator) * 2, unit(generator) * 2, 2.5 + unit(generator));
    const auto pixel1 = view1_.camera.ImgFromCam(view1_.cam_from_world * point);
    const auto pixel2 = view2_.camera.ImgFromCam(view2_.cam_from_world * point);
    if (!pixel1 || !pixel2 || !view1_.camera.InImage(*pixel1) || !view2_.camera.InImage(*pixel2)) {
      continue;
    }
    ++num_checked;
    const auto rect1 = geometry->RectFromPixel1(*pixel1);
    const auto rect2 = geometry->RectFromPixel2(*pixel2);
    ASSERT_TRUE(rect1 && rect2);
    ASSERT_NEAR(rect1->y(), rect2->y(), 1e-4);
    const double disparity = rect1->x() - rect2->x();
    ASSERT_NEAR(
        disparity,
        geometry->DisparityAtRange(rect1->x(), rect1->y(), (point - view1_.Center()).norm()), 1e-4);
    ASSERT_LT((geometry->PointInWorld(rect1->x(), rect1->y(), disparity) - point).norm(), 1e-5);
  }
}

TEST_P(AllCamerasTest, MapAgreesWithTheProjection) {
  const auto geometry = GeometryOf(view1_, view2_);
  ASSERT_TRUE(geometry);
  for (const bool second : {false, true}) {
    const Viewpoint& view = second ? view2_ : view1_;
    const Eigen::Matrix3d& cam_from_rect =
        second ? geometry->cam2_from_rect : geometry->cam1_from_rect;
    const RectWindow window = WindowOfPicture(*geometry, second);
    const RectMap map(*geometry, second, window, 2);
    double worst = 0;
    int64_t num_inside = 0;
    for (int j = 0; j < window.height; j += 3) {
      for (int i = 0; i < window.width; i += 3) {
        const auto source = map.Source(i, j);
        if (!source) continue;
        ++num_inside;
        const Eigen::Vector3d ray = geometry->RayAt(window.x0 + i + 0.5, window.y0 + j + 0.5);
        const auto exact = view.camera.ImgFromCam(cam_from_rect * ray);
        ASSERT_TRUE(exact);
        worst = std::max(worst, (source->cast<double>() - *exact).norm());
      }
    }
    EXPECT_LT(worst, 0.02);
    EXPECT_GT(num_inside * 9, view.camera.width * view.camera.height / 2);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, AllCamerasTest, testing::ValuesIn(RectifiableCameraModels()));

Viewpoint Ahead(const Eigen::Vector3d& center, const Eigen::Vector3d& turn_deg = {0, 0, 0}) {
  return StandAt(MakeCamera(CameraModel::kPinhole, 500, 640, 480), center, turn_deg);
}

TEST(RectificationTest, AnyDirectionOfTravel) {
  for (double angle = 0; angle < 2 * M_PI; angle += 0.5) {
    const Viewpoint view1 = Ahead({0, 0, 0});
    const Viewpoint view2 = Ahead({0.4 * std::cos(angle), 0.4 * std::sin(angle), 0});
    const auto geometry = GeometryOf(view1, view2);
    ASSERT_TRUE(geometry);
    EXPECT_NEAR(geometry->world_from_rect.determinant(), 1, 1e-12);
    EXPECT_LT((geometry->world_from_rect.col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    const Eigen::Vector3d point(0.1, -0.05, 2);
    const auto rect1 =
        geometry->RectFromPixel1(*view1.camera.ImgFromCam(view1.cam_from_world * point));
    const auto rect2 =
        geometry->RectFromPixel2(*view2.camera.ImgFromCam(view2.cam_from_world * point));
    EXPECT_NEAR(rect1->x() - rect2->x(), 500 * 0.4 / 2, 1e-6);
  }
}

// Cameras that are not turned, side by side: the rectified picture is the picture.
TEST(RectificationTest, NothingToTurnLeavesThePictureAsItIs) {
  const Viewpoint view1 = Ahead({0, 0, 0}), view2 = Ahead({0.3, 0, 0});
  const auto geometry = GeometryOf(view1, view2);
  ASSERT_TRUE(geometry);
  const RectWindow window = WindowOfPicture(*geometry, false);
  EXPECT_LE(std::abs(window.x0 + 320), 1);
  EXPECT_LE(std::abs(window.y0 + 240), 1);
  GrayImage picture(640, 480);
  std::mt19937 generator(2);
  for (uint8_t& value : picture.data) value = static_cast<uint8_t>(generator());
  for (const int num_threads : {1, 3}) {
    BlockMask all(window);
    all.Want(0, 0, window.width, window.height);
    const RectPicture rect =
        RectMap(*geometry, false, window, num_threads).Rectify(picture, all, num_threads);
    ASSERT_EQ(rect.gray.width, window.width);
    ASSERT_EQ(rect.gray.height, window.height);
    for (int j = 0; j < rect.gray.height; ++j) {
      for (int i = 0; i < rect.gray.width; ++i) {
        const int x = i + 320 + window.x0, y = j + 240 + window.y0;
        const int value = rect.gray.At(i, j);
        if (x < 0 || y < 0 || x >= 640 || y >= 480) {
          ASSERT_EQ(value, 0) << x << " " << y;
        } else if (x > 0 && y > 0 && x < 639 && y < 479) {
          // The float position may fall a hair short of the pixel: 1 / 256 of the next one.
          ASSERT_NEAR(value, std::max<int>(1, picture.At(x, y)), 1) << x << " " << y;
        }
      }
    }
  }
}

TEST(RectificationTest, WindowHoldsThePicture) {
  const Viewpoint view1 = Ahead({0, 0, 0}, {3, -6, 40}), view2 = Ahead({0.3, 0.1, 0}, {-4, 5, 30});
  const auto geometry = GeometryOf(view1, view2);
  ASSERT_TRUE(geometry);
  for (const bool second : {false, true}) {
    const RectWindow window = WindowOfPicture(*geometry, second);
    for (double x = 0; x <= 640; x += 16) {
      for (double y = 0; y <= 480; y += 16) {
        const auto rect =
            second ? geometry->RectFromPixel2({x, y}) : geometry->RectFromPixel1({x, y});
        ASSERT_TRUE(rect);
        EXPECT_GE(rect->x(), window.x0 - 1e-6);
        EXPECT_GE(rect->y(), window.y0 - 1e-6);
        EXPECT_LE(rect->x(), window.x0 + window.width + 1e-6);
        EXPECT_LE(rect->y(), window.y0 + window.height + 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
