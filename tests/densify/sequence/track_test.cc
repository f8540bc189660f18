#include "densify/sequence/track.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace colmap_seapoint {
namespace {

SparseModel ModelOf(const std::vector<std::string>& names) {
  SparseModel model;
  model.cameras[1] = MakeCamera(CameraModel::kPinhole, 100, 40, 30);
  for (const std::string& name : names) {
    PosedImage image;
    image.name = name;
    image.camera_id = 1;
    image.cam_from_world.translation.x() = static_cast<double>(model.images.size());
    model.images.push_back(image);
  }
  return model;
}

TEST(TrackTest, PositionsAreThoseOfTheOrder) {
  const SparseModel model = ModelOf({"c", "b", "a"});
  const Track track(model, {2, 0, 1}, {});
  EXPECT_EQ(track.Order(), (std::vector<int>{2, 0, 1}));
  EXPECT_EQ(track.Length(), 3);
  EXPECT_EQ(track.Image(2).name, "b");
  EXPECT_EQ(track.PositionOf(2), 0);
  EXPECT_EQ(track.PositionOf(1), 2);
  EXPECT_EQ(track.ViewOf(1).image_idx, 0);
  EXPECT_EQ(track.ViewOf(2).cam_from_world.translation.x(), 1);
  EXPECT_EQ(track.LongerSide(0), 40);
  EXPECT_EQ(track.RightOf(0), -1);
  EXPECT_TRUE(track.CanStartPair(1));
  EXPECT_FALSE(track.CanStartPair(2));
}

TEST(TrackTest, RightPicturesStandBehindTheTrack) {
  const SparseModel model = ModelOf({"right/1", "left/2", "left/1", "right/3", "right/2"});
  StereoRig rig;
  rig.is_right = {1, 0, 0, 1, 1};
  rig.right_of = {-1, 4, 0, -1, -1};
  const Track track(model, {2, 1, 0, 4, 3}, rig);
  EXPECT_EQ(track.Order(), (std::vector<int>{2, 1, 0, 4, 3}));
  const Track mixed(model, {0, 2, 4, 1, 3}, rig);
  EXPECT_EQ(mixed.Order(), track.Order());
  EXPECT_EQ(mixed.PositionOf(4), 3);
  EXPECT_EQ(track.NumPictures(), 5);
  EXPECT_EQ(track.Length(), 2);
  EXPECT_EQ(track.RightOf(0), 2);
  EXPECT_EQ(track.RightOf(1), 3);
  EXPECT_EQ(track.RightOf(2), -1);
  // The last picture of the track has a simultaneous one; a right picture starts nothing.
  EXPECT_TRUE(track.CanStartPair(1));
  EXPECT_FALSE(track.CanStartPair(2));
}

TEST(TrackTest, NoPictures) {
  const SparseModel model;
  const Track track(model, {}, {});
  EXPECT_EQ(track.NumPictures(), 0);
  EXPECT_FALSE(track.CanStartPair(0));
}

}  // namespace
}  // namespace colmap_seapoint
