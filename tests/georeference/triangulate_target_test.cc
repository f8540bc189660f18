#include "colmap_seapoint/georeference/triangulate_target.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

// Cameras in a row that look down on a target 2 units below them.
class Target : public testing::Test {
 protected:
  Target() {
    camera_ = MakeCamera(CameraModel::kOpenCV, 1000, 1360, 1024);
    camera_.params[4] = -0.08;  // k1
    for (int i = 0; i < 5; ++i) {
      Rigid3d pose;
      pose.rotation = Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d(0.2, 0.3, 1).normalized());
      pose.translation = -(pose.rotation * Eigen::Vector3d(0.3 * i - 0.6, 0.1 * (i % 2), 0));
      views_.push_back({&camera_, pose, *camera_.ImgFromCam(pose * xyz_)});
    }
  }

  const Eigen::Vector3d xyz_{0.05, 0.1, 2};
  Camera camera_;
  std::vector<TargetView> views_;
};

TEST_F(Target, ExactMarksGiveTheExactPlace) {
  for (const size_t count : {2u, 3u, 5u}) {
    const std::vector<TargetView> some(views_.begin(), views_.begin() + static_cast<long>(count));
    const TriangulatedTarget target = TriangulateTarget(some, 4);
    ASSERT_EQ(target.problem, "");
    EXPECT_LT((target.xyz - xyz_).norm(), 1e-9);
    EXPECT_EQ(target.is_used, std::vector<bool>(count, true));
  }
}

TEST_F(Target, AWrongMarkIsNotUsed) {
  views_[2].pixel += Eigen::Vector2d(60, -25);
  const TriangulatedTarget target = TriangulateTarget(views_, 4);
  ASSERT_EQ(target.problem, "");
  EXPECT_LT((target.xyz - xyz_).norm(), 1e-9);
  EXPECT_EQ(target.is_used, (std::vector<bool>{true, true, false, true, true}));
  EXPECT_NEAR(target.errors[2], 65, 0.1);
}

TEST_F(Target, CovarianceSaysWhatAPixelMoves) {
  const TriangulatedTarget exact = TriangulateTarget(views_, 4);
  // Depth is the uncertain direction: 1 pixel, 1000 pixels focal length, baselines of 0.3 to 1.2.
  EXPECT_GT(exact.covariance(2, 2), 2 * exact.covariance(0, 0));
  EXPECT_NEAR(std::sqrt(exact.covariance(0, 0)), 0.002 / std::sqrt(5.0), 4e-4);
  double square = 0;
  constexpr int kNumRuns = 200;
  std::srand(3);
  for (int run = 0; run < kNumRuns; ++run) {
    std::vector<TargetView> noisy = views_;
    for (TargetView& view : noisy) {
      // Uniform in +-sqrt(3): a standard deviation of 1 pixel.
      view.pixel += std::sqrt(3.0) * Eigen::Vector2d::Random();
    }
    const TriangulatedTarget target = TriangulateTarget(noisy, 10);
    ASSERT_EQ(target.problem, "");
    square += std::pow(target.xyz.z() - xyz_.z(), 2) / kNumRuns;
  }
  EXPECT_NEAR(std::sqrt(square / exact.covariance(2, 2)), 1, 0.2);
}

TEST_F(Target, WhatHasNoPlace) {
  EXPECT_NE(TriangulateTarget({}, 4).problem.find("0 pictures"), std::string::npos);
  EXPECT_NE(TriangulateTarget({views_[0]}, 4).problem.find("1 pictures"), std::string::npos);
  // The same camera twice: no angle.
  EXPECT_NE(TriangulateTarget({views_[0], views_[0]}, 4).problem.find("half a degree"),
            std::string::npos);
  // Two marks of different things: their rays pass each other far off.
  std::vector<TargetView> two = {views_[0], views_[4]};
  two[0].pixel.y() += 80;
  EXPECT_NE(TriangulateTarget(two, 4).problem.find("agree"), std::string::npos);
  // Half of the marks against the other half.
  std::vector<TargetView> four(views_.begin(), views_.begin() + 4);
  four[0].pixel += Eigen::Vector2d(0, 200);
  four[1].pixel += Eigen::Vector2d(0, -180);
  EXPECT_NE(TriangulateTarget(four, 4).problem.find("more than half"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
