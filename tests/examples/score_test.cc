#include "examples/survey/score.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

SurveyTruth MakeTruth(double relief, int num_strips = 2) {
  SurveyOptions options;
  options.width = 200;
  options.height = 150;
  options.num_strips = num_strips;
  options.images_per_strip = 3;
  options.relief = relief;
  options.num_threads = 2;
  return MakeSurveyTruth(options);
}

// One point a lattice cell, on the surface.
std::vector<Eigen::Vector3f> ExactCloud(const SurveyTruth& truth) {
  const HeightField& surface = truth.surface.Ground();
  const GridSpec& grid = surface.Grid();
  std::vector<Eigen::Vector3f> cloud;
  for (double y = grid.MinY(); y < grid.MaxY(); y += grid.step) {
    for (double x = grid.MinX(); x < grid.MaxX(); x += grid.step) {
      cloud.push_back(Eigen::Vector3d(x, y, surface.Height(x, y)).cast<float>());
    }
  }
  return cloud;
}

TEST(ScoreTest, ExactCloudIsPerfect) {
  const SurveyTruth truth = MakeTruth(1);
  const SurveyScore score = ScoreSurvey(truth, truth.model, {ExactCloud(truth), {}}, {});
  EXPECT_EQ(score.num_registered, 6);
  EXPECT_LT(score.centre_max, 1e-9);
  EXPECT_EQ(score.accuracy.share_1gsd, 1);
  EXPECT_LT(score.accuracy.median_gsd, 1e-3);
  EXPECT_GT(score.coverage_4gsd, 0.98);  // lattice points leave gaps on steep faces
  EXPECT_GT(score.twice_seen_m2, 3);
  EXPECT_NEAR(score.redundancy, 1, 0.35);
}

// Denser where the GSD is finer is no redundancy; the same cloud twice is.
TEST(ScoreTest, RedundancyIsInOwnGsd) {
  SurveyOptions options;
  options.path = SurveyPath::kDescent;
  options.width = 200;
  options.height = 150;
  options.num_strips = 1;
  options.images_per_strip = 5;
  options.relief = 0;
  options.num_threads = 2;
  const SurveyTruth truth = MakeSurveyTruth(options);
  const SurfaceVisibility visibility(truth);
  // Points a GSD of their own apart, or a little more.
  std::vector<Eigen::Vector3f> cloud;
  for (const Eigen::Vector3f& p : ExactCloud(truth)) {
    const auto gsd = BestPairGsd(
        visibility.InFrames(p.cast<double>(), visibility.PicturesAround({p.cast<double>()})));
    if (!gsd) continue;
    const int every = static_cast<int>(std::ceil(*gsd / truth.surface.CellSize()));
    const auto index = [&](float v) { return std::lround(v / truth.surface.CellSize()); };
    if (index(p.x()) % every == 0 && index(p.y()) % every == 0) cloud.push_back(p);
  }
  ScoreOptions score_options;
  score_options.truth_poses = true;
  const SurveyScore once = ScoreSurvey(truth, truth.model, {cloud, {}}, score_options);
  EXPECT_NEAR(once.own_redundancy, 1, 0.2);
  const std::vector<Eigen::Vector3f> same = cloud;
  cloud.insert(cloud.end(), same.begin(), same.end());
  const SurveyScore twice = ScoreSurvey(truth, truth.model, {cloud, {}}, score_options);
  EXPECT_NEAR(twice.own_redundancy, 2 * once.own_redundancy, 1e-12);
}

TEST(ScoreTest, PlaneIsCoveredWholly) {
  const SurveyTruth truth = MakeTruth(0);
  const SurveyScore score = ScoreSurvey(truth, truth.model, {ExactCloud(truth), {}}, {});
  EXPECT_EQ(score.coverage_4gsd, 1);
  EXPECT_EQ(score.coverage_2gsd, 1);
  const double cell = truth.surface.CellSize() / truth.gsd;
  EXPECT_NEAR(score.points_per_gsd2, 1 / (cell * cell), 0.02);
  EXPECT_NEAR(score.points_per_cm2, 1e-4 / std::pow(truth.surface.CellSize(), 2), 0.02);
}

TEST(ScoreTest, ShiftedCloudIsOffByTheShift) {
  const SurveyTruth truth = MakeTruth(0);
  std::vector<Eigen::Vector3f> cloud = ExactCloud(truth);
  for (Eigen::Vector3f& p : cloud) p.z() += static_cast<float>(3 * truth.gsd);
  const SurveyScore score = ScoreSurvey(truth, truth.model, {cloud, {}}, {});
  EXPECT_EQ(score.accuracy.share_2gsd, 0);
  EXPECT_EQ(score.accuracy.share_4gsd, 1);
  EXPECT_NEAR(score.accuracy.median_gsd, 3, 1e-3);
  EXPECT_EQ(score.coverage_2gsd, 0);
  EXPECT_EQ(score.coverage_4gsd, 1);
}

TEST(ScoreTest, CoverageLacksThePlantedHole) {
  const SurveyTruth truth = MakeTruth(0);
  const double half_x = 30 * truth.gsd, half_y = 20 * truth.gsd;
  // In the middle of the survey, where every place is seen twice.
  const Eigen::Vector3d middle = 0.5 * (truth.model.images[1].cam_from_world.OriginInSource() +
                                        truth.model.images[4].cam_from_world.OriginInSource());
  std::vector<Eigen::Vector3f> cloud;
  for (const Eigen::Vector3f& p : ExactCloud(truth)) {
    if (std::abs(p.x() - middle.x()) < half_x && std::abs(p.y() - middle.y()) < half_y) continue;
    cloud.push_back(p);
  }
  const SurveyScore score = ScoreSurvey(truth, truth.model, {cloud, {}}, {});
  // Places within 4 (2) GSD of the rim still have a point; corners lose nothing on a lattice scale.
  const auto hole = [&](double rim) {
    return 4 * (half_x - rim * truth.gsd) * (half_y - rim * truth.gsd) / score.twice_seen_m2;
  };
  const double tolerance = 4 * (half_x + half_y) * 1.2 * truth.gsd / score.twice_seen_m2;
  EXPECT_NEAR(1 - score.coverage_4gsd, hole(4), tolerance);
  EXPECT_NEAR(1 - score.coverage_2gsd, hole(2), tolerance);
  EXPECT_GT(hole(4), 4 * tolerance);
}

TEST(ScoreTest, AnotherFrameScoresTheSame) {
  for (int num_strips : {1, 2}) {  // one strip: the centres lie on a line
    const SurveyTruth truth = MakeTruth(1, num_strips);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized()));
    const Eigen::Vector3d shift(5, -3, 2);
    const double scale = 0.37;
    SparseModel model = truth.model;
    for (PosedImage& image : model.images) {
      const Eigen::Vector3d centre = scale * (turn * image.cam_from_world.OriginInSource()) + shift;
      image.cam_from_world.rotation = image.cam_from_world.rotation * turn.conjugate();
      image.cam_from_world.translation = -(image.cam_from_world.rotation * centre);
    }
    std::vector<Eigen::Vector3f> cloud = ExactCloud(truth);
    for (Eigen::Vector3f& p : cloud) {
      p = (scale * (turn * p.cast<double>()) + shift).cast<float>();
    }
    const SurveyScore score = ScoreSurvey(truth, model, {cloud, {}}, {});
    EXPECT_LT(score.centre_max, 1e-6);
    EXPECT_NEAR(score.scale, 1 / scale, 1e-6);
    EXPECT_EQ(score.accuracy.share_1gsd, 1);
    EXPECT_LT(score.accuracy.median_gsd, 1e-2);
    ScoreOptions no_alignment;
    no_alignment.truth_poses = true;
    EXPECT_LT(ScoreSurvey(truth, model, {cloud, {}}, no_alignment).accuracy.share_4gsd, 0.5);
  }
}

TEST(ScoreTest, RefinementTakesOutATilt) {
  const SurveyTruth truth = MakeTruth(1);
  std::vector<Eigen::Vector3f> cloud = ExactCloud(truth);
  for (Eigen::Vector3f& p : cloud) p.z() += 0.02f + 0.01f * p.x();
  ScoreOptions options;
  const double before = ScoreSurvey(truth, truth.model, {cloud, {}}, options).accuracy.median_gsd;
  options.refine = true;
  const SurveyScore after = ScoreSurvey(truth, truth.model, {cloud, {}}, options);
  EXPECT_TRUE(after.refined);
  EXPECT_LT(after.accuracy.median_gsd, 0.1 * before);
}

TEST(ScoreTest, ErrorsOfCentresAreReported) {
  const SurveyTruth truth = MakeTruth(0);
  SparseModel model = truth.model;
  model.images[2].cam_from_world.translation.x() += 0.1;
  model.images.pop_back();
  ScoreOptions options;
  options.truth_poses = true;
  const SurveyScore score = ScoreSurvey(truth, model, {ExactCloud(truth), {}}, options);
  EXPECT_EQ(score.num_registered, 5);
  EXPECT_NEAR(score.centre_max, 0.1, 1e-9);
  EXPECT_NEAR(score.centre_rms, 0.1 / std::sqrt(5), 1e-9);
  model.images.resize(2);
  EXPECT_THROW(ScoreSurvey(truth, model, {ExactCloud(truth), {}}, {}), Error);
  EXPECT_THROW(ScoreSurvey(truth, truth.model, {}, {}), Error);
}

TEST(ScoreTest, ThreadsDoNotShow) {
  const SurveyTruth truth = MakeTruth(1);
  ScoreOptions options;
  options.num_threads = 1;
  const std::string one =
      ScoreJson(ScoreSurvey(truth, truth.model, {ExactCloud(truth), {}}, options));
  options.num_threads = 2;
  EXPECT_EQ(one, ScoreJson(ScoreSurvey(truth, truth.model, {ExactCloud(truth), {}}, options)));
  EXPECT_TRUE(nlohmann::json::accept(one));
}

}  // namespace
}  // namespace colmap_seapoint
