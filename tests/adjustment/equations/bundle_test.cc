#include "colmap_seapoint/adjustment/equations/bundle.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(BundleTest, ListsEveryObservationOnce) {
  const SparseModel model = ExactSurvey(ExactLens(), 4);
  const Bundle bundle = MakeBundle(model, {});
  size_t expected = 0;
  for (const auto& [id, point] : model.points3D) {
    if (point.track.size() > 1) expected += point.track.size();
  }
  ASSERT_EQ(bundle.NumObservations(), expected);
  ASSERT_EQ(bundle.of_picture.size(), expected);
  for (size_t p = 0; p < bundle.NumPoints(); ++p) {
    EXPECT_EQ(bundle.share_begin[p + 1] - bundle.share_begin[p], 1u);
    for (uint32_t k = bundle.point_begin[p]; k < bundle.point_begin[p + 1]; ++k) {
      EXPECT_EQ(bundle.point_of[k], p);
      const PosedImage& image = model.images[bundle.image_idx[bundle.picture_of[k]]];
      const Eigen::Vector3d& xyz = model.points3D.at(bundle.point_id[p]).xyz;
      EXPECT_LT((*ExactLens().ImgFromCam(image.cam_from_world * xyz) - bundle.pixels[k]).norm(),
                1e-9);
    }
  }
  for (size_t i = 0; i < bundle.NumPictures(); ++i) {
    for (uint32_t o = bundle.picture_begin[i]; o < bundle.picture_begin[i + 1]; ++o) {
      EXPECT_EQ(bundle.picture_of[bundle.of_picture[o]], i);
    }
  }
}

TEST(BundleTest, PassesOverWhatCannotTakePart) {
  SparseModel model = ExactSurvey(ExactLens(), 4);
  const size_t all = MakeBundle(model, {}).NumPictures();
  model.images[0].camera_id = 99;  // there is none
  model.images[1].cam_from_world.translation.x() = kNan;
  model.images[2].cam_from_world.translation.z() -= 100;  // all behind it
  for (Eigen::Vector2d& pixel : model.images[3].points2D) pixel.y() = kNan;
  model.images[4].point3D_ids.assign(model.images[4].point3D_ids.size(), 123456789);
  const Bundle bundle = MakeBundle(model, {});
  EXPECT_EQ(bundle.NumPictures(), all - 5);
  for (uint32_t idx : bundle.image_idx) EXPECT_GE(idx, 5u);
  EXPECT_EQ(MakeBundle(SparseModel(), {}).NumObservations(), 0u);
}

TEST(BundleTest, HeldAndTiedParametersAreNoFreeValues) {
  const SparseModel model = ExactSurvey(ExactLens(), 3);
  const Bundle bundle = MakeBundle(model, {{1, {0b11000000, true, 0}}});
  const BundleLens& lens = bundle.lenses.at(0);
  EXPECT_EQ(lens.num_free, 5);
  EXPECT_EQ(lens.slots[0], lens.slots[1]);
  EXPECT_EQ(lens.slots[6], -1);
  EXPECT_EQ(lens.slots[7], -1);
  const BundleValues values = ReadValues(bundle, {{1, {0b11000000, true, 0}}}, model);
  EXPECT_EQ(values.lenses[0][0], 900.75);
  EXPECT_EQ(values.lenses[0][1], 900.75);
}

}  // namespace
}  // namespace colmap_seapoint
