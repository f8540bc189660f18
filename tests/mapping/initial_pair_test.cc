// The pair to begin with, in databases of exact two-view geometries.
#include "colmap_seapoint/mapping/initial_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"
#include "tests/mapping/scripted_colmap.h"

namespace colmap_seapoint {
namespace {

// Cameras that look along z at points 10 away, and do not turn.
class InitialPairTest : public testing::Test {
 protected:
  InitialPairTest() { camera_id_ = AddCamera(&database_, camera_); }

  static Eigen::Vector3d PointOf(int i) { return {0.2 * (i % 20) - 1.9, 0.2 * (i / 20) - 0.9, 10}; }

  uint32_t Add(const Eigen::Vector3d& center) {
    Features features = MakeFeatures(kNumPoints, 1);
    for (int i = 0; i < kNumPoints; ++i) {
      const auto pixel = camera_.ImgFromCam(PointOf(i) - center);
      features.points[static_cast<size_t>(i)].x = static_cast<float>(pixel->x());
      features.points[static_cast<size_t>(i)].y = static_cast<float>(pixel->y());
    }
    const uint32_t id = AddImage(&database_, std::to_string(centers_.size()) + ".jpg", camera_id_);
    WriteFeatures(&database_, id, features, "picture");
    centers_[id] = center;
    return id;
  }

  void Tie(uint32_t a, uint32_t b, uint32_t num_inliers) {
    FeatureMatches matches;
    for (uint32_t k = 0; k < num_inliers; ++k) matches.push_back({k, k});
    TwoViewGeometry geometry = MakeGeometry(matches);
    geometry.cam2_from_cam1 =
        Rigid3d{Eigen::Quaterniond::Identity(), (centers_[a] - centers_[b]).normalized()};
    WriteMatches(&database_, a, b, matches, geometry);
  }

  static constexpr int kNumPoints = 200;
  TempDir dir_;
  ColmapDatabase database_{dir_ / "database.db", ColmapDatabase::Mode::kCreateIfMissing};
  const Camera camera_ = MakeCamera(CameraModel::kPinhole, 800, 640, 480);
  uint32_t camera_id_ = 0;
  std::map<uint32_t, Eigen::Vector3d> centers_;
};

TEST_F(InitialPairTest, TheLargestAngleOfThosePairsThatCanBegin) {
  const uint32_t a = Add({0, 0, 0}), b = Add({0.2, 0, 0.3}), c = Add({0.5, 0, 0.6});
  const uint32_t d = Add({1, 0, 0}), e = Add({0.3, 0, 2});
  Tie(a, b, 150);
  Tie(a, c, 120);
  Tie(b, c, 200);
  Tie(a, d, 99);   // the best angle, but too few
  Tie(a, e, 200);  // straight ahead
  const auto pair = FindInitialPair(database_);
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->image_id1, a);
  EXPECT_EQ(pair->image_id2, c);
  EXPECT_EQ(pair->num_inliers, 120u);
  // The directions to each point, which keypoints hold to a float's digits.
  std::vector<double> angles;
  for (int i = 0; i < 120; ++i) {
    const Eigen::Vector3d from_a = PointOf(i) - centers_[a], from_c = PointOf(i) - centers_[c];
    angles.push_back(180 / M_PI * std::acos(from_a.normalized().dot(from_c.normalized())));
  }
  std::sort(angles.begin(), angles.end());
  EXPECT_NEAR(pair->angle_deg, angles[60], 1e-3);
}

TEST_F(InitialPairTest, NoneWhereColmapFindsOneItself) {
  const uint32_t a = Add({0, 0, 0}), b = Add({0.5, 0, 0}), c = Add({1.5, 0, 0});
  Tie(a, b, 150);
  EXPECT_TRUE(FindInitialPair(database_));
  Tie(a, c, 100);  // 8.5 degrees
  EXPECT_FALSE(FindInitialPair(database_));
}

TEST_F(InitialPairTest, NoneWhereNothingMoved) {
  const uint32_t a = Add({0, 0, 0}), b = Add({1e-3, 0, 0});
  EXPECT_FALSE(FindInitialPair(database_));
  Tie(a, b, 200);
  EXPECT_FALSE(FindInitialPair(database_));
}

TEST_F(InitialPairTest, PixelsWithoutRaysAndPairsWithoutPosesDoNotCount) {
  const uint32_t a = Add({0, 0, 0}), b = Add({0.5, 0, 0}), c = Add({0.4, 0, 0});
  Features broken = *ReadFeatures(database_, c);
  for (SeaPoint& point : broken.points) point.x = std::numeric_limits<float>::quiet_NaN();
  WriteFeatures(&database_, c, broken, "picture");
  Tie(a, c, 200);
  EXPECT_FALSE(FindInitialPair(database_));
  FeatureMatches matches;
  for (uint32_t k = 0; k < 150; ++k) matches.push_back({k, k});
  TwoViewGeometry without_pose = MakeGeometry(matches);
  without_pose.cam2_from_cam1.reset();
  WriteMatches(&database_, a, b, matches, without_pose);
  EXPECT_FALSE(FindInitialPair(database_));
  TwoViewGeometry planar = MakeGeometry(matches);
  planar.config = TwoViewConfig::kPlanarOrPanoramic;
  WriteMatches(&database_, a, b, matches, planar);
  EXPECT_FALSE(FindInitialPair(database_));
}

TEST(OptionsOfInitialPairTest, OneModelFromThatPairUnlessTheUserChose) {
  TempDir dir;
  ScriptedColmap scripted(dir.Path());
  const InitialPair pair = {4, 19, 300, 3};
  EXPECT_FALSE(OptionsOfInitialPair(scripted.Program(), {}, pair));  // does not know the options
  scripted.SetHelp(MapperHelp(
      "COLMAP 3.8", {"Mapper.init_image_id1", "Mapper.init_image_id2", "Mapper.init_min_tri_angle",
                     "Mapper.init_min_num_inliers", "Mapper.multiple_models"}));
  const auto options = OptionsOfInitialPair(scripted.Program(), {{"random_seed", "1"}}, pair);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->at("random_seed"), "1");
  EXPECT_EQ(options->at("Mapper.init_image_id1"), "4");
  EXPECT_EQ(options->at("Mapper.init_image_id2"), "19");
  EXPECT_EQ(options->at("Mapper.multiple_models"), "0");
  EXPECT_NEAR(std::stod(options->at("Mapper.init_min_tri_angle")), 1.5, 1e-6);
  EXPECT_FALSE(OptionsOfInitialPair(scripted.Program(), {{"Mapper.init_image_id1", "2"}}, pair));
}

}  // namespace
}  // namespace colmap_seapoint
