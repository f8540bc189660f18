#include "densify/overlap/seeds.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

SeaPoint PointAt(float x, float y) {
  SeaPoint point;
  point.x = x;
  point.y = y;
  return point;
}

TEST(SeedsFromMatchesTest, NoneFromTheOverlapArea) {
  const std::vector<SeaPoint> points1 = {PointAt(1, 2), PointAt(3, 4), PointAt(5, 6),
                                         PointAt(7, 8)};
  const std::vector<SeaPoint> points2 = {PointAt(10, 20), PointAt(30, 40)};
  const FeatureMatches matches = {{3, 0}, {0, 1}, {1, 0}, {2, 1}};
  const std::vector<SeaPointLabel> labels = {SeaPointLabel::kNA, SeaPointLabel::kOA,
                                             SeaPointLabel::kREA, SeaPointLabel::kNA};
  const std::vector<PixelPair> seeds = SeedsFromMatches(points1, points2, matches, labels);
  ASSERT_EQ(seeds.size(), 3u);
  EXPECT_EQ(seeds[0].pixel1, Eigen::Vector2d(7, 8));
  EXPECT_EQ(seeds[0].pixel2, Eigen::Vector2d(10, 20));
  EXPECT_EQ(seeds[1].pixel1, Eigen::Vector2d(1, 2));
  EXPECT_EQ(seeds[1].pixel2, Eigen::Vector2d(30, 40));
  EXPECT_EQ(seeds[2].pixel1, Eigen::Vector2d(5, 6));
  EXPECT_EQ(SeedsFromMatches(points1, points2, matches, {}).size(), 4u);
}

TEST(SeedsFromModelTest, PointsThatBothPicturesSee) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 100, 200, 100);
  View view1{0, camera, {}}, view2{1, camera, {}};
  view2.cam_from_world.translation.x() = -0.5;
  SparseModel model;
  model.points3D[1].xyz = {0, 0, 1};
  model.points3D[2].xyz = {-0.9, 0, 1};  // beyond picture 2
  model.points3D[3].xyz = {0, 0, -1};    // behind both
  model.points3D[4].xyz = {0.25, 0.25, 1};
  PosedImage image1;
  image1.point3D_ids = {kNoPoint3D, 4, 2, 3};  // 1: not seen by picture 1
  const std::vector<PixelPair> seeds = SeedsFromModel(model, image1, view1, view2);
  ASSERT_EQ(seeds.size(), 1u);
  EXPECT_EQ(seeds[0].pixel1, Eigen::Vector2d(125, 75));
  EXPECT_EQ(seeds[0].pixel2, Eigen::Vector2d(75, 75));
}

}  // namespace
}  // namespace colmap_seapoint
