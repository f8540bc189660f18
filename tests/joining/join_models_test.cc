#include "colmap_seapoint/joining/join_models.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/joining/two_models.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class JoinModelsTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() /
        ("joining_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  JoinedModel Join(const TestModel& a, const TestModel& b, int num_threads = 1) const {
    WriteDatabase(a, b, folder_ / "database.db");
    const ColmapDatabase database(folder_ / "database.db", ColmapDatabase::Mode::kReadOnly);
    JoinOptions options;
    options.num_threads = num_threads;
    options.refine_lens = false;
    return JoinModels(database, a.model, b.model, options);
  }

  fs::path folder_;
};

// Pictures 1 to 3 and 4 to 7 over ground that goes on from one to the other.
struct Survey {
  TestModel a, b;
};

Survey NeighbouringStrips() {
  const auto ground = StrewnGround(-1, 3, -1, 2, 600, 0, 5);
  Survey survey = {SeenBy({PictureAt(1, 0, 0), PictureAt(2, 0.3, 0), PictureAt(3, 0.6, 0)}, ground),
                   SeenBy({PictureAt(4, 0.1, 0.6), PictureAt(5, 0.4, 0.6), PictureAt(6, 0.7, 0.6),
                           PictureAt(7, 1.0, 0.6)},
                          ground)};
  TransformModel(OtherFrame(), &survey.a.model);
  return survey;
}

// Two places: a wreck's plate of 0.5 x 0.5 lies in the middle of either, the ground around differs.
Survey LookAlikes() {
  std::vector<GroundPoint> here = StrewnGround(-1.5, 2, -1.5, 2, 500, 0, 5);
  std::vector<GroundPoint> there = StrewnGround(-1.5, 2, -1.5, 2, 500, 1000, 6);
  const auto plate = StrewnGround(-0.1, 0.4, -0.1, 0.4, 120, 5000, 7);
  here.insert(here.end(), plate.begin(), plate.end());
  there.insert(there.end(), plate.begin(), plate.end());
  Survey survey = {
      SeenBy({PictureAt(1, 0, 0), PictureAt(2, 0.3, 0), PictureAt(3, 0.1, 0.3)}, here),
      SeenBy({PictureAt(4, 0.1, 0.1), PictureAt(5, 0.2, 0), PictureAt(6, 0, 0.3)}, there)};
  TransformModel(OtherFrame(), &survey.a.model);
  return survey;
}

std::set<uint32_t> IdsOf(const SparseModel& model) {
  std::set<uint32_t> ids;
  for (const PosedImage& image : model.images) ids.insert(image.image_id);
  return ids;
}

// The centres' largest distance from where they were taken, in the frame of `b`, which is the
// survey's own but for what the adjustment leaves free.
double WorstBaseline(const SparseModel& joined) {
  const std::map<uint32_t, Eigen::Vector3d> truth = {
      {1, {0, 0, 0}},     {2, {0.3, 0, 0}},   {3, {0.6, 0, 0}},  {4, {0.1, 0.6, 0}},
      {5, {0.4, 0.6, 0}}, {6, {0.7, 0.6, 0}}, {7, {1.0, 0.6, 0}}};
  const auto center = [&](size_t i) { return joined.images[i].cam_from_world.OriginInSource(); };
  const double scale = (center(6) - center(3)).norm() / 0.9;
  double worst = 0;
  for (size_t i = 0; i < 7; ++i) {
    for (size_t j = 0; j < i; ++j) {
      const auto id = [&](size_t k) { return joined.images[k].image_id; };
      const double length = (truth.at(id(i)) - truth.at(id(j))).norm();
      worst = std::max(worst, std::abs((center(i) - center(j)).norm() / scale - length));
    }
  }
  return worst;
}

TEST_F(JoinModelsTest, NeighbouringStripsBecomeOneModel) {
  const Survey survey = NeighbouringStrips();
  const JoinedModel joined = Join(survey.a, survey.b);
  ASSERT_TRUE(joined.model) << joined.outcome;
  EXPECT_EQ(IdsOf(*joined.model), (std::set<uint32_t>{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_LT(WorstBaseline(*joined.model), 1e-4);
  // Each place once: no more points than the ground has, and all tracks say what features say.
  EXPECT_LE(joined.model->points3D.size(), 600u);
  for (const auto& [id, point] : joined.model->points3D) {
    for (const auto& element : point.track) {
      const auto& image = joined.model->images[element.image_id - 1];
      ASSERT_EQ(image.image_id, element.image_id);
      EXPECT_EQ(image.point3D_ids.at(element.point2D_idx), id);
    }
  }
}

TEST_F(JoinModelsTest, TheSameForAnyNumberOfThreads) {
  const Survey survey = NeighbouringStrips();
  const JoinedModel one = Join(survey.a, survey.b, 1), three = Join(survey.a, survey.b, 3);
  ASSERT_TRUE(one.model && three.model);
  EXPECT_EQ(one.outcome, three.outcome);
  for (size_t i = 0; i < one.model->images.size(); ++i) {
    EXPECT_EQ(one.model->images[i].cam_from_world.translation,
              three.model->images[i].cam_from_world.translation);
  }
}

TEST_F(JoinModelsTest, SharedPicturesTieModelsWithoutAnyMatch) {
  const auto ground = StrewnGround(-1, 3, -1, 2, 600, 0, 5);
  const std::vector<PosedImage> strip = {PictureAt(1, 0, 0), PictureAt(2, 0.3, 0),
                                         PictureAt(3, 0.6, 0), PictureAt(4, 0.9, 0)};
  Survey survey = {SeenBy({strip[0], strip[1], strip[2]}, ground),
                   SeenBy({strip[1], strip[2], strip[3]}, ground)};
  TransformModel(OtherFrame(), &survey.a.model);
  const JoinedModel joined = Join(survey.a, survey.b);
  ASSERT_TRUE(joined.model) << joined.outcome;
  EXPECT_EQ(IdsOf(*joined.model), (std::set<uint32_t>{1, 2, 3, 4}));
}

TEST_F(JoinModelsTest, PlacesThatLookAlikeStayApart) {
  const Survey survey = LookAlikes();
  const JoinedModel joined = Join(survey.a, survey.b);
  EXPECT_FALSE(joined.model);
  EXPECT_NE(joined.outcome.find("places look alike"), std::string::npos) << joined.outcome;
}

// The same pictures over ground that is the same all around must be joined: it is the ground that
// tells.
TEST_F(JoinModelsTest, TheSamePlaceAsTheLookAlikesIsJoined) {
  const auto ground = StrewnGround(-1.5, 2, -1.5, 2, 500, 0, 5);
  Survey survey = {
      SeenBy({PictureAt(1, 0, 0), PictureAt(2, 0.3, 0), PictureAt(3, 0.1, 0.3)}, ground),
      SeenBy({PictureAt(4, 0.1, 0.1), PictureAt(5, 0.2, 0), PictureAt(6, 0, 0.3)}, ground)};
  TransformModel(OtherFrame(), &survey.a.model);
  const JoinedModel joined = Join(survey.a, survey.b);
  EXPECT_TRUE(joined.model) << joined.outcome;
}

TEST_F(JoinModelsTest, AModelThatIsBentStaysApart) {
  Survey survey = NeighbouringStrips();
  // Features that are off by several pixels where the other model sees the place too: no lens and
  // no pose explains them.
  std::mt19937 random(4);
  for (PosedImage& image : survey.a.model.images) {
    for (Eigen::Vector2d& pixel : image.points2D) {
      pixel += Eigen::Vector2d(static_cast<double>(random() % 21) - 10,
                               static_cast<double>(random() % 21) - 10);
    }
  }
  EXPECT_FALSE(Join(survey.a, survey.b).model);
}

TEST_F(JoinModelsTest, NothingToJoin) {
  const auto ground = StrewnGround(-1, 3, -1, 2, 200, 0, 5);
  const auto elsewhere = StrewnGround(-1, 3, -1, 2, 200, 1000, 6);
  const TestModel a = SeenBy({PictureAt(1, 0, 0), PictureAt(2, 0.3, 0)}, ground);
  EXPECT_EQ(Join(a, SeenBy({PictureAt(3, 0, 0), PictureAt(4, 0.3, 0)}, elsewhere)).outcome,
            "no match between them");
  EXPECT_FALSE(Join(a, SeenBy({PictureAt(3, 0.1, 0)}, ground)).model);  // no point of its own
  TestModel damaged = SeenBy({PictureAt(3, 0.1, 0), PictureAt(4, 0.2, 0)}, ground);
  for (auto& [id, point] : damaged.model.points3D) point.xyz.setConstant(std::nan(""));
  EXPECT_FALSE(Join(a, damaged).model);
}

}  // namespace
}  // namespace colmap_seapoint
