// Rigid motions, similarities and the median: the small mathematics that many rooms share.
#include <gtest/gtest.h>

#include <random>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/base/similarity3.h"

namespace colmap_seapoint {
namespace {

constexpr double kTolerance = 1e-12;

class Transforms : public testing::Test {
 protected:
  double Uniform() { return std::uniform_real_distribution<double>(-3, 3)(random_); }
  Eigen::Vector3d Vector() { return {Uniform(), Uniform(), Uniform()}; }
  Eigen::Quaterniond Rotation() {
    return Eigen::Quaterniond(Uniform(), Uniform(), Uniform(), Uniform()).normalized();
  }
  Rigid3d Motion() { return {Rotation(), Vector()}; }

  std::mt19937 random_{5};
};

void ExpectSame(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  EXPECT_LT((a - b).norm(), kTolerance) << a.transpose() << " and " << b.transpose();
}

TEST_F(Transforms, AMotionTurnsFirstAndMovesThen) {
  Rigid3d quarter_turn;
  quarter_turn.rotation = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  quarter_turn.translation = {10, 20, 30};
  ExpectSame(quarter_turn * Eigen::Vector3d(1, 2, 3), {10 - 2, 20 + 1, 30 + 3});
  ExpectSame(Rigid3d() * Eigen::Vector3d(1, 2, 3), {1, 2, 3});
}

TEST_F(Transforms, MotionsChainAndComeBack) {
  for (int i = 0; i < 50; ++i) {
    const Rigid3d c_from_b = Motion(), b_from_a = Motion();
    const Eigen::Vector3d x = Vector();
    ExpectSame((c_from_b * b_from_a) * x, c_from_b * (b_from_a * x));
    ExpectSame(b_from_a.Inverse() * (b_from_a * x), x);
    ExpectSame(b_from_a * (b_from_a.Inverse() * x), x);
    ExpectSame(b_from_a * b_from_a.OriginInSource(), Eigen::Vector3d::Zero());
  }
}

TEST_F(Transforms, ASimilarityScalesAboutTheOrigin) {
  Similarity3d metric_from_model;
  metric_from_model.scale = 2;
  metric_from_model.translation = {0, 0, -5};
  ExpectSame(metric_from_model * Eigen::Vector3d(1, 2, 3), {2, 4, 1});
}

// A camera that moves with its world sees every point in the same direction, `scale` times as far.
TEST_F(Transforms, ATransformedModelLooksTheSame) {
  for (int i = 0; i < 50; ++i) {
    SparseModel model;
    model.images.resize(1);
    model.images[0].cam_from_world = Motion();
    model.images[0].points2D = {{3, 4}};
    model.points3D[7].xyz = Vector();
    model.points3D[7].error = 0.5;
    const Eigen::Vector3d before = model.images[0].cam_from_world * model.points3D[7].xyz;
    const Eigen::Vector3d centre = model.images[0].cam_from_world.OriginInSource();
    const Similarity3d new_from_old = {2.5, Rotation(), Vector()};
    TransformModel(new_from_old, &model);
    const Rigid3d& pose = model.images[0].cam_from_world;
    ExpectSame(pose * model.points3D[7].xyz, 2.5 * before);
    ExpectSame(pose.OriginInSource(), new_from_old * centre);
    EXPECT_EQ(model.images[0].points2D[0], Eigen::Vector2d(3, 4));
    EXPECT_EQ(model.points3D[7].error, 0.5);
  }
}

TEST(UpperMedian, MiddleOrTheUpperOfTheTwo) {
  EXPECT_EQ(UpperMedian({4}), 4);
  EXPECT_EQ(UpperMedian({9, 1}), 9);
  EXPECT_EQ(UpperMedian({3, 1, 2}), 2);
  EXPECT_EQ(UpperMedian({8, 2, 6, 4}), 6);
  EXPECT_EQ(UpperMedian({5, 5, 5, -1}), 5);
}

TEST(UpperMedian, HalfOfTheValuesLieBelow) {
  std::mt19937 random(2);
  for (size_t count = 1; count < 60; ++count) {
    std::vector<double> values(count);
    for (double& value : values) value = static_cast<double>(random() % 1000000);
    const double median = UpperMedian(values);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(median, values[count / 2]);
  }
}

}  // namespace
}  // namespace colmap_seapoint
