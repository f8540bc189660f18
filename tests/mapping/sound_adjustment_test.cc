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
  return adjusted.model.cameras.begin()->second;
}

TEST(SoundAdjustmentTest, TwoFocalLengthsThatAreAlikeAreBelieved) {
  const SoundAdjustment adjusted = AdjustSoundly(SurveyOfAspect(1.004), {});
  ASSERT_EQ(adjusted.fault, "");
  EXPECT_NEAR(LensOf(adjusted).FocalY() / LensOf(adjusted).FocalX(), 1.004, 1e-3);
}

TEST(SoundAdjustmentTest, TwoFocalLengthsThatNoLensHasBecomeOne) {
  const SoundAdjustment adjusted = AdjustSoundly(SurveyOfAspect(1.03), {});
  ASSERT_EQ(adjusted.fault, "");
  EXPECT_EQ(LensOf(adjusted).FocalY(), LensOf(adjusted).FocalX());
}

TEST(SoundAdjustmentTest, WhatIsNotSoundNamesItsFault) {
  EXPECT_EQ(AdjustSoundly(SurveyOfAspect(1.004), {1 + 1e-9}).fault,
            "the focal length moved too far");
  EXPECT_EQ(AdjustSoundly(SparseModel(), {}).fault, "it takes three pictures at least to tell the lens");
}

TEST(SoundAdjustmentTest, TheSameForAnyNumberOfThreads) {
  const SparseModel survey = SurveyOfAspect(1.004);
  const SoundAdjustment one = AdjustSoundly(survey, {2, true, true, 1});
  const SoundAdjustment three = AdjustSoundly(survey, {2, true, true, 3});
  EXPECT_EQ(LensOf(one).params, LensOf(three).params);
}

}  // namespace
}  // namespace colmap_seapoint
