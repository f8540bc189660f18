#include "colmap_seapoint/reposing/repose_pictures.h"

#include <gtest/gtest.h>

#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

class ReposePicturesTest : public testing::Test {
 protected:
  void SetUp() override { WriteSurveyDatabase(exact_, dir_ / "database.db"); }

  std::vector<std::string> Repose(SparseModel* model) const {
    return ReposePictures(ColmapDatabase(dir_ / "database.db", ColmapDatabase::Mode::kReadOnly),
                          model);
  }

  double CenterError(const SparseModel& model, size_t idx) const {
    return (model.images[idx].cam_from_world.OriginInSource() -
            exact_.images[idx].cam_from_world.OriginInSource())
        .norm();
  }

  TempDir dir_;
  const SparseModel exact_ = ExactSurvey(ExactLens(), 5);
};

TEST_F(ReposePicturesTest, BringsWhatStandsWrongBackAndLeavesTheOthers) {
  SparseModel model = exact_;
  for (const size_t idx : {3, 8}) {
    model.images[idx].cam_from_world.translation += Eigen::Vector3d(0.2, 0.4, 0);
  }
  EXPECT_EQ(Repose(&model), (std::vector<std::string>{"img9.jpg", "img4.jpg"}));
  for (size_t i = 0; i < model.images.size(); ++i) EXPECT_LT(CenterError(model, i), 1e-4) << i;
  for (const size_t idx : {3, 8}) {
    for (const uint64_t id : model.images[idx].point3D_ids) EXPECT_EQ(id, kNoPoint3D);
  }
  for (const auto& [id, point] : model.points3D) {
    for (const auto& element : point.track) {
      EXPECT_NE(element.image_id, 4u);
      EXPECT_NE(element.image_id, 9u);
    }
  }
  EXPECT_EQ(model.images[0].cam_from_world.translation,
            exact_.images[0].cam_from_world.translation);
}

TEST_F(ReposePicturesTest, ASoundModelStaysAsItIs) {
  SparseModel model = exact_;
  EXPECT_TRUE(Repose(&model).empty());
  EXPECT_EQ(model.images[3].point3D_ids, exact_.images[3].point3D_ids);
}

TEST_F(ReposePicturesTest, WithoutPointsOfOthersAPictureStaysWhereItIs) {
  SparseModel model = exact_;
  model.images[3].cam_from_world.translation += Eigen::Vector3d(0.2, 0.4, 0);
  for (PosedImage& image : model.images) {
    image.point3D_ids.assign(image.points2D.size(), kNoPoint3D);
  }
  EXPECT_TRUE(Repose(&model).empty());
}

}  // namespace
}  // namespace colmap_seapoint
