#include "densify/sequence/covisibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

View ViewAbove(double x, double y = 0) {
  const Viewpoint viewpoint =
      StandAt(MakeCamera(CameraModel::kPinhole, 400, 400, 300), {x, y, 0}, {0, 0, 0});
  return {0, viewpoint.camera, viewpoint.cam_from_world};
}

SparseModel ModelWithTracks(size_t num_images, const std::vector<std::vector<uint32_t>>& tracks) {
  SparseModel model;
  for (size_t i = 0; i < num_images; ++i) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(100 + i);
    model.images.push_back(image);
  }
  for (const auto& track : tracks) {
    SparsePoint point;
    for (const uint32_t image : track) point.track.push_back({100 + image, 0});
    model.points3D[model.points3D.size() + 1] = point;
  }
  return model;
}

TEST(CovisiblePicturesTest, MostSharedFirstTiesByPosition) {
  const SparseModel model =
      ModelWithTracks(5, {{0, 1, 2}, {0, 1}, {1, 3}, {0, 1, 3}, {0, 3}, {0, 77}});
  const auto covisible = CovisiblePictures(model, {0, 1, 2, 3, 4});
  ASSERT_EQ(covisible.size(), 5u);
  EXPECT_EQ(covisible[0], (std::vector<int>{1, 3, 2}));  // 3, 2, 1 shared points
  EXPECT_EQ(covisible[1], (std::vector<int>{0, 3, 2}));
  EXPECT_EQ(covisible[2], (std::vector<int>{0, 1}));  // 1 and 1
  EXPECT_EQ(covisible[3], (std::vector<int>{0, 1}));  // 2 and 2
  EXPECT_TRUE(covisible[4].empty());
}

TEST(CovisiblePicturesTest, PositionsAreThoseOfTheOrder) {
  const SparseModel model = ModelWithTracks(3, {{0, 2}, {0, 2}, {0, 1}});
  const auto covisible = CovisiblePictures(model, {2, 0, 1});
  EXPECT_EQ(covisible[0], (std::vector<int>{1}));
  EXPECT_EQ(covisible[1], (std::vector<int>{0, 2}));
  EXPECT_EQ(covisible[2], (std::vector<int>{1}));
}

TEST(CovisiblePicturesTest, AtMostTwelve) {
  std::vector<std::vector<uint32_t>> tracks;
  for (uint32_t i = 1; i < 20; ++i) {
    for (uint32_t n = 0; n < i; ++n) tracks.push_back({0, i});
  }
  std::vector<int> order(20);
  for (int i = 0; i < 20; ++i) order[static_cast<size_t>(i)] = i;
  const auto covisible = CovisiblePictures(ModelWithTracks(20, tracks), order);
  ASSERT_EQ(covisible[0].size(), 12u);
  EXPECT_EQ(covisible[0].front(), 19);
  EXPECT_EQ(covisible[0].back(), 8);
}

TEST(MedianParallaxTest, OfTheSharedPoints) {
  SparseModel model = ModelWithTracks(2, {});
  const double ranges[] = {1, 2, 4};
  for (int i = 0; i < 2; ++i) {
    PosedImage& image = model.images[static_cast<size_t>(i)];
    image.cam_from_world = ViewAbove(i == 0 ? -0.1 : 0.1).cam_from_world;
    image.point3D_ids = {kNoPoint3D, 1, 2, 3};
    image.point3D_ids.push_back(i == 0 ? 8 : 9);  // not shared
  }
  for (uint64_t id = 1; id <= 3; ++id) model.points3D[id].xyz = {0, 0, ranges[id - 1]};
  model.points3D[8].xyz = model.points3D[9].xyz = {0, 0, 0.01};
  EXPECT_NEAR(MedianParallaxDeg(model, model.images[0], model.images[1]),
              2 * std::atan(0.1 / 2) * 180 / M_PI, 1e-9);
  model.images[1].point3D_ids = {kNoPoint3D};
  EXPECT_EQ(MedianParallaxDeg(model, model.images[0], model.images[1]), 0);
}

TEST(SharedShareTest, CountsThePointsThatProjectIntoTheOther) {
  SparseModel model;
  PosedImage image;
  const View view = ViewAbove(0);
  for (uint64_t id = 1; id <= 10; ++id) {  // x of the pixel: 5, 45, 85 ...
    SparsePoint point;
    point.xyz = {(40.0 * static_cast<double>(id) - 35 - 200) * kDepth / 400, 0, kDepth};
    model.points3D[id] = point;
    image.point3D_ids.push_back(id);
  }
  image.point3D_ids.push_back(kNoPoint3D);
  EXPECT_EQ(SharedShare(model, image, view), 1);
  EXPECT_EQ(SharedShare(model, image, ViewAbove(0.5)), 0.7);  // moved by 100 pixels
  EXPECT_EQ(SharedShare(model, image, ViewAbove(5)), 0);
  EXPECT_EQ(SharedShare(model, PosedImage(), view), 0);
}

}  // namespace
}  // namespace colmap_seapoint
