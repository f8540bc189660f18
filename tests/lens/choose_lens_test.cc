#include "colmap_seapoint/lens/choose_lens.h"

#include <gtest/gtest.h>

#include "tests/lens/noisy_survey.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kNoise = 0.15;

// As it is adjusted first: OPENCV, whatever the lens is.
SparseModel AsOpenCV(SparseModel model) {
  LensForm form;
  form.has_two_focals = true;
  return InForm(form, std::move(model));
}

LensChoice Choose(const Camera& lens) {
  return ChooseLens({}, AsOpenCV(NoisySurvey(lens, 6, kNoise)));
}

TEST(ChooseLensTest, TheSimplestThatIsAsGoodAsAny) {
  const LensChoice choice = Choose(LensOf(CameraModel::kSimpleRadial, {900, 510, 368, -0.1}));
  EXPECT_EQ(Describe(choice.form), "SIMPLE_RADIAL") << choice.said;
  EXPECT_EQ(choice.said.find("SIMPLE_RADIAL: 0.1"), 0u) << choice.said;
}

TEST(ChooseLensTest, APrincipalPointInTheMiddleIsFoundThere) {
  const LensChoice choice = Choose(LensOf(CameraModel::kRadial, {900, 500, 375, -0.3, 0.2}));
  EXPECT_EQ(Describe(choice.form), "RADIAL, principal point in the middle") << choice.said;
}

TEST(ChooseLensTest, TwoFocalLengthsOnceTheyAreProven) {
  Camera lens = ExactLens();
  lens.params[1] = 1.02 * lens.params[0];
  EXPECT_TRUE(Choose(lens).form.has_two_focals) << Choose(lens).said;
  lens.params[1] = lens.params[0];
  EXPECT_FALSE(Choose(lens).form.has_two_focals) << Choose(lens).said;
}

TEST(ChooseLensTest, WhatOnlyAFisheyeFits) {
  const Camera lens = LensOf(CameraModel::kOpenCVFisheye, {420, 420, 505, 370, 0.03, -0.02, 0, 0});
  EXPECT_EQ(Choose(lens).form.model, CameraModel::kOpenCVFisheye) << Choose(lens).said;
}

TEST(ChooseLensTest, AnotherModelIsItsOwnersChoice) {
  const Camera lens = LensOf(CameraModel::kSimpleRadial, {900, 510, 368, -0.1});
  const LensChoice choice = ChooseLens({}, NoisySurvey(ExactLens(), 5, kNoise));
  EXPECT_NE(choice.form.model, CameraModel::kSimpleRadial) << choice.said;
  const LensChoice own = ChooseLens({}, NoisySurvey(lens, 5, kNoise));
  EXPECT_EQ(own.form.model, CameraModel::kSimpleRadial) << own.said;
}

TEST(ChooseLensTest, NothingToJudgeBy) {
  EXPECT_NE(ChooseLens({}, SparseModel()).said.find("too few tracks"), std::string::npos);
  SparseModel lost = NoisySurvey(ExactLens(), 5, kNoise);
  lost.images.resize(2);  // the tracks still name the others
  EXPECT_FALSE(ChooseLens({}, lost).said.empty());
}

TEST(ChooseLensTest, TheSameForAnyNumberOfThreads) {
  const SparseModel model = NoisySurvey(ExactLens(), 5, kNoise);
  LensChoiceOptions options;
  const LensChoice one = ChooseLens(options, model);
  options.num_threads = 3;
  const LensChoice three = ChooseLens(options, model);
  EXPECT_EQ(one.said, three.said);
  EXPECT_EQ(one.bend, three.bend);
}

}  // namespace
}  // namespace colmap_seapoint
