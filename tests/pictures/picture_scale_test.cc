#include "colmap_seapoint/pictures/picture_scale.h"

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

class PictureScaleTest : public testing::Test {
 protected:
  PictureScaleTest() {
    Camera camera = MakeCamera(CameraModel::kPinhole, 50, 64, 48);
    camera.camera_id = 4;
    model_.cameras[4] = camera;
  }

  void AddImage(const std::string& name, int width, int height) {
    if (width > 0) WriteImage(dir_ / name, GrayImage(width, height, 1, 100));
    PosedImage image;
    image.camera_id = 4;
    image.name = name;
    image.points2D = {{32, 24}, {1, 2}};
    image.point3D_ids = {kNoPoint3D, kNoPoint3D};
    model_.images.push_back(image);
  }

  TempDir dir_;
  SparseModel model_;
};

TEST_F(PictureScaleTest, LargerAndSmallerPicturesGetCamerasOfTheirOwn) {
  AddImage("same.png", 64, 48);
  AddImage("large.png", 192, 144);
  AddImage("small.png", 32, 24);
  AddImage("large_too.png", 192, 144);
  EXPECT_EQ(ScaleCamerasToPictures(dir_.Path(), 2, &model_), 3);
  ASSERT_EQ(model_.cameras.size(), 3u);
  EXPECT_EQ(model_.images[0].camera_id, 4u);
  EXPECT_EQ(model_.images[0].points2D[0], Eigen::Vector2d(32, 24));
  EXPECT_EQ(model_.images[1].camera_id, 5u);
  EXPECT_EQ(model_.images[2].camera_id, 6u);
  EXPECT_EQ(model_.images[3].camera_id, 5u);
  const Camera& large = model_.cameras.at(5);
  EXPECT_EQ(large.camera_id, 5u);
  EXPECT_EQ(large.width, 192);
  EXPECT_EQ(large.height, 144);
  EXPECT_EQ(large.params, (std::vector<double>{150, 150, 96, 72}));
  EXPECT_EQ(model_.images[1].points2D[1], Eigen::Vector2d(3, 6));
  EXPECT_EQ(model_.images[2].points2D[1], Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(model_.cameras.at(4).width, 64);
}

TEST_F(PictureScaleTest, OtherProportionsAndUnreadablePicturesKeepTheirCamera) {
  AddImage("cut.png", 192, 100);
  AddImage("missing.png", 0, 0);
  AddImage("damaged.png", 0, 0);
  WriteBytes(dir_ / "damaged.png", "no picture");
  EXPECT_EQ(ScaleCamerasToPictures(dir_.Path(), 1, &model_), 0);
  EXPECT_EQ(model_.cameras.size(), 1u);
  for (const PosedImage& image : model_.images) EXPECT_EQ(image.camera_id, 4u);
}

}  // namespace
}  // namespace colmap_seapoint
