#include "examples/benchmarks/densify/hold_out.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

// Two cameras of focal length 100 that look down z from the origin; points 10 + id units away, the
// odd ones with three views (the first picture twice), the third and sixth with a large error.
SparseModel Model() {
  SparseModel model;
  Camera camera = MakeCamera(CameraModel::kPinhole, 100, 1600, 1200);
  camera.camera_id = 1;
  model.cameras[1] = camera;
  for (uint32_t id : {7u, 9u}) {
    PosedImage image;
    image.image_id = id;
    image.camera_id = 1;
    model.images.push_back(image);
  }
  for (uint64_t id = 1; id <= 9; ++id) {
    SparsePoint point;
    point.xyz = {static_cast<double>(id), 0, 10 + static_cast<double>(id)};
    point.error = id % 3 == 0 ? 1.5 : 0.5;
    const auto see = [&](size_t image) {
      PosedImage& view = model.images[image];
      point.track.push_back({view.image_id, static_cast<uint32_t>(view.points2D.size())});
      view.points2D.push_back({100.0 * static_cast<double>(image), static_cast<double>(id)});
      view.point3D_ids.push_back(id);
    };
    see(0);
    see(1);
    if (id % 2 == 1) see(0);
    model.points3D[id] = point;
  }
  return model;
}

TEST(HoldOutTest, EveryFourthPointLeavesTheModel) {
  const SparseModel model = Model();
  PartialDensificationOptions options;
  options.step = 3;
  const HoldOut held = HoldOutPoints(model, 4, options);
  EXPECT_EQ(held.num_held, 2u);  // 4 and 8
  EXPECT_EQ(held.model.points3D.size(), 7u);
  EXPECT_EQ(held.model.points3D.count(4) + held.model.points3D.count(8), 0u);
  EXPECT_TRUE(held.eligible.empty());  // two views
  for (size_t i = 0; i < 2; ++i) {
    const PosedImage& image = held.model.images[i];
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const uint64_t before = model.images[i].point3D_ids[k];
      EXPECT_EQ(image.point3D_ids[k], before % 4 == 0 ? kNoPoint3D : before);
    }
    ASSERT_EQ(held.places.at(static_cast<int>(i)).size(), 2u);
    EXPECT_EQ(held.places.at(static_cast<int>(i))[1], Eigen::Vector2d(100.0 * double(i), 8));
  }
}

TEST(HoldOutTest, EligibleAreSeenThriceAndExact) {
  PartialDensificationOptions options;
  options.step = 3;
  const HoldOut held = HoldOutPoints(Model(), 1, options);
  EXPECT_EQ(held.num_held, 9u);
  ASSERT_EQ(held.eligible.size(), 3u);  // 1, 5, 7
  EXPECT_EQ(held.eligible[1].xyz, Eigen::Vector3f(5, 0, 15));
  EXPECT_DOUBLE_EQ(held.eligible[1].gsd, 0.15);
  EXPECT_EQ(held.eligible[1].spacing, 3);
  EXPECT_DOUBLE_EQ(MedianGsd(Model()), 0.15);
  EXPECT_EQ(MedianGsd(SparseModel()), 0);
}

TEST(HoldOutTest, OwnUncertaintyByLargestParallax) {
  SparseModel model = Model();
  model.images[1].cam_from_world.translation = {-10, 0, 0};  // stands at x = 10
  PartialDensificationOptions options;
  const HoldOut held = HoldOutPoints(model, 1, options);
  ASSERT_EQ(held.eligible.size(), 3u);
  // The point (5, 0, 15) from (0, 0, 0) and (10, 0, 0): twice atan(1 / 3), of tangent 0.75.
  EXPECT_NEAR(held.eligible[1].own_gsd, 0.5 / 0.75, 1e-9);
  EXPECT_GT(HoldOutPoints(Model(), 1, options).eligible[1].own_gsd, 1e3);  // no parallax at all
}

TEST(HoldOutTest, SharesByDistance) {
  std::vector<HeldPoint> points;
  for (float x : {0.0f, 100.0f, 200.0f, 300.0f}) {
    points.push_back({{x, 0, 0}, 0.5, 2, x < 150 ? 0.75 : 1.25});
  }
  // 1, 5, 8 and 40 GSD away.
  const std::vector<Eigen::Vector3f> cloud = {{0, 0.5, 0}, {100, 0, 2.5}, {204, 0, 0}, {320, 0, 0}};
  HoldOutRow row;
  ScoreHoldOut(points, cloud, &row);
  EXPECT_EQ(row.eligible, 4);
  EXPECT_EQ(row.near, 0.75);
  EXPECT_EQ(row.passed, 0.25);
  EXPECT_DOUBLE_EQ(row.passed_near, 1.0 / 3);
  EXPECT_EQ(row.passed_spacing, 0.5);
  EXPECT_EQ(row.median_gsd, 5);
  EXPECT_EQ(row.own_gsd, 1);
  EXPECT_EQ(row.passed_sure, 0.5);  // of the first two
  ScoreHoldOut({}, cloud, &row);
  EXPECT_EQ(row.eligible, 0);
  HoldOutRow bare;
  ScoreHoldOut(points, {}, &bare);
  EXPECT_EQ(bare.passed, 0);
  EXPECT_EQ(bare.near, 0);
  EXPECT_TRUE(std::isnan(bare.passed_near));
}

}  // namespace
}  // namespace colmap_seapoint
