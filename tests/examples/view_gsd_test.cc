#include "examples/survey/view_gsd.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply.h"

namespace colmap_seapoint {
namespace {

TEST(ViewGsdTest, IsTheMeanOverThePicturesThatMadeThePoint) {
  SparseModel model;
  model.cameras[1] = MakeCamera(CameraModel::kPinhole, 100, 200, 200);
  model.cameras[1].camera_id = 1;
  for (uint32_t id : {2u, 1u}) {  // .vis counts by image_id
    PosedImage image;
    image.image_id = id;
    image.camera_id = 1;
    image.cam_from_world.translation = {0, 0, id == 1 ? 0.0 : 2.0};  // picture 2 is 2 m farther off
    model.images.push_back(image);
  }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("view_gsd_" + std::to_string(getpid()) + ".ply");
  std::vector<Eigen::Vector3f> points = {{0, 0, 4}, {0.5f, 0, 6}};
  {
    CloudWriter writer(path);
    const uint32_t first = 0, both[] = {0, 1};
    CloudPoint point;
    point.xyz = points[0];
    writer.Add(point, &first, 1);
    point.xyz = points[1];
    writer.Add(point, both, 2);
    writer.Finish();
  }
  const std::vector<float> gsd = ViewGsd(model, points, path);
  ASSERT_EQ(gsd.size(), 2u);
  EXPECT_NEAR(gsd[0], 0.04, 1e-7);
  EXPECT_NEAR(gsd[1], 0.5 * (0.06 + 0.08), 1e-7);
  model.images.pop_back();
  EXPECT_THROW(ViewGsd(model, points, path), Error);
  points.pop_back();
  EXPECT_THROW(ViewGsd(model, points, path), Error);
  std::filesystem::remove(path.string() + ".vis");
  EXPECT_TRUE(ViewGsd(model, points, path).empty());
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace colmap_seapoint
