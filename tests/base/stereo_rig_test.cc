#include "colmap_seapoint/base/stereo_rig.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

using Names = std::map<std::string, std::string>;

TEST(SimultaneousNamesTest, TheSameNameInBothFolders) {
  EXPECT_EQ(SimultaneousNames({"a1.jpg", "a2.jpg", "dive/3.jpg"}, {"dive/3.jpg", "a2.jpg"}),
            (Names{{"a2.jpg", "a2.jpg"}, {"dive/3.jpg", "dive/3.jpg"}}));
  // One common name is enough: the others have no partner.
  EXPECT_EQ(SimultaneousNames({"1.jpg", "2.jpg"}, {"2.jpg", "3.jpg"}), (Names{{"2.jpg", "2.jpg"}}));
}

TEST(SimultaneousNamesTest, InOrderWhereOnlyDigitsDiffer) {
  EXPECT_EQ(SimultaneousNames({"t10.jpg", "t9.jpg"}, {"t1000.jpg", "t998.jpg"}),
            (Names{{"t9.jpg", "t998.jpg"}, {"t10.jpg", "t1000.jpg"}}));
  EXPECT_EQ(SimultaneousNames({"1_50.jpg"}, {"2_51.jpg"}), (Names{{"1_50.jpg", "2_51.jpg"}}));
}

TEST(SimultaneousNamesTest, NothingThatWouldBeGuessed) {
  EXPECT_TRUE(SimultaneousNames({"t1.jpg", "t2.jpg"}, {"t8.jpg"}).empty());  // one is missing
  EXPECT_TRUE(SimultaneousNames({"l1.jpg"}, {"r2.jpg"}).empty());            // letters differ
  EXPECT_TRUE(SimultaneousNames({"t1.jpg", "u2.jpg"}, {"t3.jpg", "t4.jpg"}).empty());
  EXPECT_TRUE(SimultaneousNames({"t.jpg"}, {"t1.jpg"}).empty());
  EXPECT_TRUE(SimultaneousNames({}, {}).empty());
}

// Frames of three cameras in a row: 1 at x = 0, 2 at x = -0.5, 3 at x = 0.5. Images are listed
// backwards. Camera 3 shares `num_shared3` points with the others, camera 2 shares 20 with 1.
struct ModelWithFrames {
  SparseModel model;
  std::vector<std::vector<uint32_t>> frames;
};

ModelWithFrames ThreeCameras(int num_shared3, int num_frames = 2) {
  ModelWithFrames result;
  SparseModel& model = result.model;
  for (uint64_t id = 1; id <= 60; ++id) model.points3D[id].xyz = {0, 0, 2};
  for (int k = 0; k < num_frames; ++k) {
    std::vector<uint32_t> frame;
    for (const uint32_t camera_id : {3u, 1u, 2u}) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(100 - model.images.size());
      image.camera_id = camera_id;
      image.name = std::to_string(camera_id) + "/" + std::to_string(k) + ".jpg";
      const double x = camera_id == 1 ? 0 : camera_id == 2 ? -0.5 : 0.5;
      image.cam_from_world.translation = {-x, -1.0 * k, 0};
      const uint64_t count = camera_id == 3   ? static_cast<uint64_t>(num_shared3)
                             : camera_id == 2 ? 20
                                              : 60;
      for (uint64_t id = 1; id <= count; ++id) {
        image.points2D.emplace_back(1, 1);
        image.point3D_ids.push_back(id);
      }
      frame.push_back(image.image_id);
      model.images.push_back(image);
    }
    result.frames.push_back(frame);
  }
  return result;
}

StereoRig RigOf(const ModelWithFrames& model) { return RigFromFrames(model.model, model.frames); }

TEST(RigFromFramesTest, TheCamerasThatShareMostLeftAndRightByWhereTheyStand) {
  // Images by index: camera 3, 1, 2, 3, 1, 2. 1 and 3 share 30, 1 and 2 share 20.
  const StereoRig rig = RigOf(ThreeCameras(30));
  EXPECT_EQ(rig.right_of, (std::vector<int>{-1, 0, -1, -1, 3, -1}));
  EXPECT_EQ(rig.is_right, (std::vector<uint8_t>{1, 0, 0, 1, 0, 0}));
  EXPECT_EQ(rig.NumPairs(), 2);
  // Camera 3 looks elsewhere: 2 is the left one of 1.
  const StereoRig other = RigOf(ThreeCameras(5));
  EXPECT_EQ(other.right_of, (std::vector<int>{-1, -1, 1, -1, -1, 4}));
  EXPECT_EQ(other.is_right, (std::vector<uint8_t>{0, 1, 0, 0, 1, 0}));
}

TEST(RigFromFramesTest, UprightRig) {
  ModelWithFrames model = ThreeCameras(0);
  for (PosedImage& image : model.model.images) {
    if (image.camera_id == 2) image.cam_from_world.translation += Eigen::Vector3d(-0.5, -0.4, 0);
  }
  // Camera 2 stands 0.4 below camera 1 (y points down).
  EXPECT_EQ(RigOf(model).right_of, (std::vector<int>{-1, 2, -1, -1, 5, -1}));
}

TEST(RigFromFramesTest, NoRig) {
  ModelWithFrames model = ThreeCameras(30);
  model.frames.clear();
  EXPECT_TRUE(RigOf(model).right_of.empty());
  EXPECT_EQ(RigOf(model).NumPairs(), 0);
  // Cameras that hardly share anything.
  model = ThreeCameras(3);
  for (PosedImage& image : model.model.images) {
    if (image.camera_id == 2) image.point3D_ids.assign(20, kNoPoint3D);
  }
  EXPECT_TRUE(RigOf(model).right_of.empty());
}

// The mapper lost the left picture of a frame: the right one has no partner, but its camera is
// still the right one.
TEST(RigFromFramesTest, LostPicture) {
  ModelWithFrames model = ThreeCameras(50, 3);
  model.frames[1] = {model.model.images[3].image_id,
                     model.model.images[5].image_id};  // cameras 3 and 2
  const StereoRig rig = RigOf(model);
  EXPECT_EQ(rig.right_of, (std::vector<int>{-1, 0, -1, -1, -1, -1, -1, 6, -1}));
  EXPECT_EQ(rig.is_right, (std::vector<uint8_t>{1, 0, 0, 1, 0, 0, 1, 0, 0}));
}

TEST(RigFromNamesTest, ByFolder) {
  SparseModel model;
  for (const std::string name :
       {"r/2.jpg", "l/1.jpg", "l/2.jpg", "r/9.jpg", "2.jpg", "rest/2.jpg", "l/r/2.jpg"}) {
    PosedImage image;
    image.name = name;
    model.images.push_back(image);
  }
  const StereoRig rig = RigFromNames(model, "l", "r", {{"1.jpg", "1.jpg"}, {"2.jpg", "2.jpg"}});
  EXPECT_EQ(rig.right_of, (std::vector<int>{-1, -1, 0, -1, -1, -1, -1}));
  EXPECT_EQ(rig.is_right, (std::vector<uint8_t>{1, 0, 0, 1, 0, 0, 0}));
}

}  // namespace
}  // namespace colmap_seapoint
