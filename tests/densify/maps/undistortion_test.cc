#include "densify/maps/undistortion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 240, kHeight = 180;

class Undistortion : public testing::TestWithParam<CameraModel> {
 protected:
  const Camera camera_ = MildCamera(GetParam(), 200, kWidth, kHeight);
  const Camera pinhole_ = UndistortedCamera(camera_);

  // How far beyond the source's border the place lies that a pixel of the target comes from.
  double Beyond(double x, double y) const {
    const auto ray = pinhole_.CamFromImg({x, y});
    const auto pixel = camera_.ImgFromCam(ray->homogeneous());
    if (!pixel) return 1e9;
    return std::max({-pixel->x(), -pixel->y(), pixel->x() - kWidth, pixel->y() - kHeight});
  }
};

// No blank pixel, and on every side as far as it goes.
TEST_P(Undistortion, IsTheLargestPictureWithoutBlanks) {
  ASSERT_EQ(pinhole_.model, CameraModel::kPinhole);
  const double width = pinhole_.width, height = pinhole_.height;
  double left = -1e9, right = -1e9, top = -1e9, bottom = -1e9;
  for (int i = 0; i <= 100; ++i) {
    const double x = width * i / 100, y = height * i / 100;
    for (const double beyond : {Beyond(0, y), Beyond(width, y), Beyond(x, 0), Beyond(x, height)}) {
      ASSERT_LT(beyond, 1e-2);
    }
    left = std::max(left, Beyond(-3, y));
    right = std::max(right, Beyond(width + 3, y));
    top = std::max(top, Beyond(x, -3));
    bottom = std::max(bottom, Beyond(x, height + 3));
  }
  // The span of a border is taken over all of it, the corners that are cut off included.
  const bool has_distortion = camera_.params.size() > 4;
  if (has_distortion) {
    EXPECT_GT(std::max({left, right, top, bottom}), 0);
    EXPECT_GT(width * height, 0.6 * kWidth * kHeight);
  }
}

TEST_P(Undistortion, PictureIsWhatThePinholeWouldTake) {
  // A texture of some 20 pixels, which interpolation hardly blurs.
  const World world({{{0, 0, 3}, {20, 0, -4}, {0, 20, 0}}}, NoiseTexture(42, 0.3, 1));
  const Viewpoint through = StandAt(camera_, {0.1, 0, 0}, {3, 2, 5});
  Viewpoint ideal = through;
  ideal.camera = pinhole_;
  const ColorImage expected = TakePicture(world, ideal);
  const Image<uint8_t> found = UndistortPicture(TakePicture(world, through), camera_, pinhole_);
  ASSERT_EQ(found.width, expected.width);
  ASSERT_EQ(found.height, expected.height);
  double sum = 0, aside = 0;
  for (int y = 0; y + 1 < found.height; ++y) {
    for (int x = 0; x + 1 < found.width; ++x) {
      sum += std::abs(found.At(x, y) - expected.At(x, y));
      aside += std::abs(found.At(x, y) - expected.At(x + 1, y + 1));
    }
  }
  EXPECT_LT(sum, 0.1 * aside);  // less than a tenth of a pixel off
}

INSTANTIATE_TEST_SUITE_P(AllModels, Undistortion, testing::ValuesIn(RectifiableCameraModels()));

TEST(UndistortedCamera, PinholesStay) {
  const Camera simple = MakeCamera(CameraModel::kSimplePinhole, 300, 640, 480);
  const Camera camera = UndistortedCamera(simple);
  EXPECT_EQ(camera.model, CameraModel::kPinhole);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.params, (std::vector<double>{300, 300, 320, 240}));
}

// A lens that no picture comes from still gives a picture that fits into memory.
TEST(UndistortedCamera, AbsurdLenses) {
  for (const double k : {-50.0, -1.0, 50.0, 1e9}) {
    Camera camera = MakeCamera(CameraModel::kSimpleRadial, 100, 640, 480);
    camera.params[3] = k;
    const Camera pinhole = UndistortedCamera(camera);
    EXPECT_GE(pinhole.width, 100) << k;
    EXPECT_LE(pinhole.width, 1280) << k;
    EXPECT_GE(pinhole.height, 80) << k;
    EXPECT_LE(pinhole.height, 960) << k;
    const ColorImage picture(640, 480, 3, 100);
    EXPECT_EQ(UndistortPicture(picture, camera, pinhole).width, pinhole.width);
  }
}

TEST(UndistortedModel, TracksAndOrder) {
  SparseModel model;
  Camera camera = MildCamera(CameraModel::kOpenCV, 200, kWidth, kHeight);
  camera.camera_id = 4;
  model.cameras[4] = camera;
  const Eigen::Vector3d place(0.2, -0.1, 3);
  for (const uint32_t id : {9u, 2u, 5u}) {
    PosedImage image;
    image.image_id = id;
    image.camera_id = 4;
    image.name = std::to_string(id) + ".jpg";
    image.cam_from_world.translation = {0.1 * id, 0, 0};
    const Eigen::Vector2d pixel = *camera.ImgFromCam(image.cam_from_world * place);
    image.points2D = {{1, 1}, pixel, {50, 60}};
    image.point3D_ids = {kNoPoint3D, 77, kNoPoint3D};
    model.points3D[77].track.push_back({id, 1});
    model.images.push_back(image);
  }
  model.points3D[77].xyz = place;
  const SparseModel found = UndistortedModel(model);
  ASSERT_EQ(found.images.size(), 3u);
  const SparsePoint& point = found.points3D.at(77);
  ASSERT_EQ(point.track.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const PosedImage& image = found.images[i];
    EXPECT_EQ(image.image_id, (std::vector<uint32_t>{2, 5, 9})[i]);
    EXPECT_EQ(point.track[i].image_id, image.image_id);
    EXPECT_EQ(point.track[i].point2D_idx, 0u);
    ASSERT_EQ(image.points2D.size(), 1u);
    EXPECT_EQ(image.point3D_ids[0], 77u);
    const auto pixel = found.cameras.at(4).ImgFromCam(image.cam_from_world * place);
    EXPECT_LT((image.points2D[0] - *pixel).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace colmap_seapoint
