// When an adjusted lens is believed.
#include "colmap_seapoint/mapping/sound_adjustment.h"

#include <gtest/gtest.h>

#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

// A survey through a lens with fy = aspect fx, as somebody begins with who thinks them equal.
SparseModel SurveyOfAspect(double aspect) {
  Camera lens = ExactLens();
  lens.params[1] = lens.params[0] * aspect;
  SparseModel survey = ExactSurvey(lens, 5);
  Camera& camera = survey.cameras.begin()->second;
  camera.params[1] = camera.params[0];
  return survey;
}

const Camera& LensOf(const SoundAdjustment& adjusted) {
  return adjusted.adjustment.model.cameras.begin()->second;
}

LensLimits TwoFocals() {
  LensLimits limits;
  limits.form.has_two_focals = true;
  return limits;
}

TEST(SoundAdjustmentTest, TwoFocalLengthsAreFoundWhereTheFormHasThem) {
  for (const double aspect : {1.004, 1.03}) {
    const SoundAdjustment adjusted = AdjustSoundly(SurveyOfAspect(aspect), TwoFocals());
    ASSERT_EQ(adjusted.fault, "");
    EXPECT_NEAR(LensOf(adjusted).FocalY() / LensOf(adjusted).FocalX(), aspect, 1e-3);
  }
}

TEST(SoundAdjustmentTest, TheFirstFormHasOne) {
  LensLimits limits;
  limits.form = FirstForm(true);
  const SoundAdjustment adjusted = AdjustSoundly(SurveyOfAspect(1.03), limits);
  ASSERT_EQ(adjusted.fault, "");
  EXPECT_EQ(LensOf(adjusted).FocalY(), LensOf(adjusted).FocalX());
  EXPECT_NE(LensOf(adjusted).PrincipalX(), SurveyOfAspect(1.03).cameras.at(1).PrincipalX());
}

TEST(SoundAdjustmentTest, PrincipalPointsThatAreHeldStay) {
  LensLimits limits;
  limits.form = FirstForm(false);
  const SparseModel survey = SurveyOfAspect(1.004);
  const SoundAdjustment adjusted = AdjustSoundly(survey, limits);
  ASSERT_EQ(adjusted.fault, "");
  EXPECT_EQ(LensOf(adjusted).PrincipalX(), survey.cameras.at(1).PrincipalX());
}

TEST(SoundAdjustmentTest, SaysHowWellTheBendIsKnown) {
  const SoundAdjustment adjusted = AdjustSoundly(Disturbed(ExactSurvey(ExactLens(), 5)), {});
  EXPECT_GT(adjusted.adjustment.centre_sigma, 0);
  EXPECT_EQ(adjusted.adjustment.centre_correlations.at(1).size(), 8u);
}

TEST(SoundAdjustmentTest, WhatIsNotSoundNamesItsFault) {
  LensLimits limits;
  limits.max_focal_ratio = 1 + 1e-9;
  EXPECT_EQ(AdjustSoundly(SurveyOfAspect(1.004), limits).fault, "the focal length moved too far");
  EXPECT_EQ(AdjustSoundly(SparseModel(), {}).fault,
            "it takes three pictures at least to tell the lens");
}

TEST(SoundAdjustmentTest, TheSameForAnyNumberOfThreads) {
  const SparseModel survey = SurveyOfAspect(1.004);
  LensLimits limits = TwoFocals();
  const SoundAdjustment one = AdjustSoundly(survey, limits);
  limits.num_threads = 3;
  const SoundAdjustment three = AdjustSoundly(survey, limits);
  EXPECT_EQ(LensOf(one).params, LensOf(three).params);
  EXPECT_EQ(one.adjustment.centre_sigma, three.adjustment.centre_sigma);
}

}  // namespace
}  // namespace colmap_seapoint
