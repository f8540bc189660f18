#include "colmap_seapoint/mapping/add_pictures.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/mapping/continued_part.h"
#include "tests/io/test_files.h"
#include "tests/mapping/exact_survey.h"
#include "tests/mapping/survey_database.h"

namespace colmap_seapoint {
namespace {

constexpr uint32_t kNumBefore = 8;

class AddPicturesTest : public testing::Test {
 protected:
  void SetUp() override { WriteTinyPictures(exact_, dir_ / "images"); }

  // The survey's first pictures, and what they see.
  SparseModel Before() const {
    SparseModel model = exact_;
    model.images.resize(kNumBefore);
    for (auto& [id, point] : model.points3D) {
      std::vector<SparsePoint::TrackElement> track;
      for (const auto& element : point.track) {
        if (element.image_id <= kNumBefore) track.push_back(element);
      }
      point.track = track;
    }
    return model;
  }

  // The whole survey as a mapper left it: the last two beside their places.
  SparseModel Grown() const {
    SparseModel model = exact_;
    for (size_t i = kNumBefore; i < model.images.size(); ++i) {
      model.images[i].cam_from_world.translation += Eigen::Vector3d(0.02, 0.01, -0.01);
    }
    return model;
  }

  AddedPictures Add(const SparseModel& grown) const {
    WriteSparseModelBinary(dir_ / "before", Before());
    WriteSparseModelBinary(dir_ / "grown", grown);
    AdjustmentJob job;
    job.image_path = dir_ / "images";
    const SparseModel before = Before();
    return AdjustAddedPictures(job, dir_ / "before", PartOf(before, IdsOf(before)), dir_ / "grown");
  }

  TempDir dir_;
  const SparseModel exact_ = ExactSurvey(ExactLens(), 5);
};

TEST_F(AddPicturesTest, NewOnesAreAdjustedToWhatStaysAsItIs) {
  SparseModel grown = Grown();
  // What COLMAP does to the poses that it was to hold.
  for (size_t i = 0; i < kNumBefore; ++i) {
    grown.images[i].cam_from_world.rotation.coeffs() *= 1 + 1e-15;
    grown.images[i].cam_from_world.translation *= 1 + 1e-15;
  }
  const AddedPictures added = Add(grown);
  ASSERT_TRUE(added.model);
  EXPECT_EQ(added.outcome.find("2 pictures added to the 8 that were there"), 0u) << added.outcome;
  const SparseModel before = ReadSparseModel(dir_ / "before");
  ASSERT_EQ(added.model->images.size(), 10u);
  for (size_t i = 0; i < 10; ++i) {
    const PosedImage& image = added.model->images[i];
    if (i < kNumBefore) {
      EXPECT_EQ(image.cam_from_world.translation, before.images[i].cam_from_world.translation);
      EXPECT_EQ(image.cam_from_world.rotation.coeffs(),
                before.images[i].cam_from_world.rotation.coeffs());
    }
    const Eigen::Vector3d error =
        image.cam_from_world.translation - exact_.images[i].cam_from_world.translation;
    EXPECT_LT(error.norm(), 1e-6) << image.name;
    EXPECT_EQ(image.points2D.size(), exact_.images[i].points2D.size());
  }
  EXPECT_EQ(added.model->cameras.at(1).params, before.cameras.at(1).params);
  // Those that one picture alone saw are gone.
  EXPECT_GT(added.model->points3D.size(), exact_.points3D.size() * 97 / 100);
  EXPECT_LT(ReprojectionError(*added.model), 1e-5);
}

TEST_F(AddPicturesTest, NothingNewIsNoHarm) {
  const AddedPictures added = Add(Before());
  ASSERT_TRUE(added.model);
  EXPECT_EQ(added.outcome.find("0 pictures added"), 0u) << added.outcome;
  EXPECT_TRUE(ReadBytes(dir_ / "grown" / "points3D.bin") ==
              ReadBytes(dir_ / "before" / "points3D.bin"));
}

TEST_F(AddPicturesTest, AModelThatLostAPictureOrHasAnotherLensIsOfNoUse) {
  SparseModel lost = Grown();
  lost.images.erase(lost.images.begin());
  for (auto& [id, point] : lost.points3D) point.track.clear();
  for (PosedImage& image : lost.images) image.point3D_ids.assign(image.points2D.size(), kNoPoint3D);
  lost.points3D.clear();
  EXPECT_FALSE(Add(lost).model);
  SparseModel other = Grown();
  other.cameras[2] = other.cameras.at(1);
  other.cameras[2].camera_id = 2;
  other.images.back().camera_id = 2;
  EXPECT_FALSE(Add(other).model);
}

}  // namespace
}  // namespace colmap_seapoint
