#include "colmap_seapoint/lens/lens_form.h"

#include <gtest/gtest.h>

#include "tests/lens/noisy_survey.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

LensForm Form(CameraModel model) {
  LensForm form;
  form.model = model;
  return form;
}

TEST(LensFormTest, AMoreGeneralFormIsTheSameLens) {
  LensForm form = Form(CameraModel::kFullOpenCV);
  form.has_two_focals = true;
  EXPECT_LT(LargestDifference(InForm(form, ExactLens()), ExactLens()), 1e-4);
  const Camera radial = LensOf(CameraModel::kSimpleRadial, {900, 504, 372, -0.1});
  EXPECT_LT(LargestDifference(InForm(Form(CameraModel::kRadial), radial), radial), 1e-6);
  EXPECT_LT(LargestDifference(InForm(Form(CameraModel::kOpenCV), radial), radial), 1e-6);
}

TEST(LensFormTest, AFisheyeIsNearlyAnyLens) {
  const Camera fisheye = InForm(Form(CameraModel::kOpenCVFisheye), ExactLens());
  EXPECT_EQ(fisheye.model, CameraModel::kOpenCVFisheye);
  EXPECT_EQ(fisheye.camera_id, 1u);
  // But for two focal lengths, a millionth apart of what they are, and decentring.
  EXPECT_LT(LargestDifference(fisheye, ExactLens()), 1.5);
}

TEST(LensFormTest, ASimplerFormIsTheNearest) {
  const Camera lens = ExactLens();
  const double of_one = LargestDifference(InForm(Form(CameraModel::kSimpleRadial), lens), lens);
  const double of_two = LargestDifference(InForm(Form(CameraModel::kRadial), lens), lens);
  EXPECT_LT(of_two, of_one);
  EXPECT_LT(of_two, 1.5);
  LensForm form = Form(CameraModel::kFullOpenCV);
  form.zero_params = 1u << 9 | 1u << 10 | 1u << 11;
  const Camera full = InForm(form, lens);
  for (size_t k = 9; k < 12; ++k) EXPECT_EQ(full.params[k], 0);
  EXPECT_EQ(full.params[0], full.params[1]);
}

TEST(LensFormTest, PrincipalPoints) {
  LensForm form = Form(CameraModel::kOpenCV);
  form.principal_point = PrincipalPoint::kCentred;
  EXPECT_EQ(InForm(form, ExactLens()).PrincipalX(), 500);
  EXPECT_EQ(InForm(form, ExactLens()).PrincipalY(), 375);
  form.principal_point = PrincipalPoint::kAsItWas;
  EXPECT_EQ(InForm(form, ExactLens()).PrincipalX(), ExactLens().PrincipalX());
  EXPECT_TRUE(FreedomOf(form).Holds(2) && FreedomOf(form).Holds(3));
  form.principal_point = PrincipalPoint::kFree;
  EXPECT_EQ(FreedomOf(form).held_params, 0u);
  EXPECT_TRUE(FreedomOf(form).ties_focals);
}

TEST(LensFormTest, CountsWhatIsFree) {
  EXPECT_EQ(NumFreeParams(Form(CameraModel::kSimpleRadial)), 4);
  EXPECT_EQ(NumFreeParams(Form(CameraModel::kOpenCV)), 7);
  const LensForm two = WithTwoFocals(Form(CameraModel::kSimpleRadial));
  EXPECT_EQ(NumFreeParams(two), 5);
  EXPECT_EQ(Describe(two), "OPENCV without k2 p1 p2, two focal lengths");
  EXPECT_EQ(FreedomOf(two).held_params, 1u << 5 | 1u << 6 | 1u << 7);
  for (const auto& forms : LensFormSteps(PrincipalPoint::kCentred)) {
    for (const LensForm& form : forms) {
      EXPECT_EQ(NumFreeParams(WithTwoFocals(form)), NumFreeParams(form) + 1) << Describe(form);
    }
  }
}

TEST(LensFormTest, PriorsAreOfTheirCameras) {
  SparseModel model;
  model.cameras[1] = ExactLens();
  model.cameras[2] = ExactLens();
  const auto lenses = FreedomOfLenses(Form(CameraModel::kOpenCV), model, {{2, 1200}});
  EXPECT_EQ(lenses.at(1).focal_sigma, 0);
  EXPECT_EQ(lenses.at(2).focal_prior, 1200);
  EXPECT_EQ(lenses.at(2).focal_sigma, 600);
}

}  // namespace
}  // namespace colmap_seapoint
