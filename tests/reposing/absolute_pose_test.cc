#include "colmap_seapoint/reposing/absolute_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kMaxError = 4;

class AbsolutePoseTest : public testing::TestWithParam<CameraModel> {
 protected:
  // What the camera sees of ground two metres below, exactly.
  std::vector<SeenPlace> PlacesSeen(int count) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<SeenPlace> places;
    while (static_cast<int>(places.size()) < count) {
      const Eigen::Vector3d xyz(2 * uniform(random_), 2 * uniform(random_),
                                2 + 0.2 * uniform(random_));
      const auto pixel = view_.camera.ImgFromCam(view_.cam_from_world * xyz);
      if (pixel && view_.camera.InImage(*pixel)) places.push_back({*pixel, xyz});
    }
    return places;
  }

  std::mt19937 random_{3};
  const Viewpoint view_ =
      StandAt(MildCamera(GetParam(), 500, 800, 600), {0.2, -0.1, 0.1}, {5, -12, 130});
};

TEST_P(AbsolutePoseTest, FindsTheExactPoseAmongWrongPlaces) {
  std::vector<SeenPlace> places = PlacesSeen(100);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (size_t i = 0; i < 45; ++i) places[2 * i].xyz += Eigen::Vector3d(uniform(random_), 1, 0);
  const auto pose = FindAbsolutePose(view_.camera, places, kMaxError);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->OriginInSource() - view_.Center()).norm(), 1e-5);
  EXPECT_EQ(CountInliers(view_.camera, *pose, places, kMaxError), 55);
  const auto again = FindAbsolutePose(view_.camera, places, kMaxError);
  EXPECT_EQ(again->translation, pose->translation);
  EXPECT_EQ(again->rotation.coeffs(), pose->rotation.coeffs());
}

INSTANTIATE_TEST_SUITE_P(Models, AbsolutePoseTest,
                         testing::Values(CameraModel::kSimpleRadial, CameraModel::kOpenCV,
                                         CameraModel::kOpenCVFisheye));

TEST(FindAbsolutePoseTest, TooFewOrDamagedPlacesGiveNone) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 800, 600);
  EXPECT_FALSE(FindAbsolutePose(camera, {}, kMaxError));
  std::vector<SeenPlace> places(5, {{400, 300}, {0, 0, 2}});
  EXPECT_FALSE(FindAbsolutePose(camera, places, kMaxError));
  // All the same place, and no numbers.
  places.assign(50, {{400, 300}, {0, 0, 2}});
  const auto pose = FindAbsolutePose(camera, places, kMaxError);
  EXPECT_TRUE(!pose || pose->translation.allFinite());
  places.assign(50, {{std::nan(""), 300}, {0, 0, std::numeric_limits<double>::infinity()}});
  EXPECT_FALSE(FindAbsolutePose(camera, places, kMaxError));
}

}  // namespace
}  // namespace colmap_seapoint
