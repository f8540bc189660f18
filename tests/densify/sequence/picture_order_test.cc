#include "densify/sequence/picture_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>

#include "tests/densify/sequence/survey_model.h"

namespace colmap_seapoint {
namespace {

std::vector<int> OrderOf(const SparseModel& model) {
  return OrderPictures(model, MeasureCovisibility(model));
}

// A strip with 80 % overlap whose picture k stands at place `place_of[k]` and has name number k.
SparseModel StripNamed(const std::vector<int>& place_of) {
  SurveyModel survey;
  for (size_t k = 0; k < place_of.size(); ++k) {
    survey.AddAbove("img" + std::to_string(k) + ".jpg", 0.2 * SurveyModel::kWidth * place_of[k]);
  }
  return survey.WithGround();
}

std::vector<int> Places(int count) {
  std::vector<int> places(static_cast<size_t>(count));
  std::iota(places.begin(), places.end(), 0);
  return places;
}

TEST(OrderPicturesTest, NaturalOrderOfNames) {
  SurveyModel survey;
  survey.AddAbove("a10.jpg", 0.8);
  survey.AddAbove("a9.jpg", 0.4);
  survey.AddAbove("a1.jpg", 0);
  EXPECT_EQ(OrderOf(survey.WithGround()), (std::vector<int>{2, 1, 0}));
  EXPECT_EQ(OrderOf(survey.WithPoints({})), (std::vector<int>{2, 1, 0}));
  EXPECT_TRUE(OrderOf(SparseModel()).empty());
}

// What a person numbers stays as it is: a strip, one with a jump in its numbers, two neighbouring
// strips there and back, a video.
TEST(OrderPicturesTest, ATrackIsLeftAlone) {
  const std::vector<int> strip = Places(24);
  std::vector<int> jump = strip;
  std::rotate(jump.begin(), jump.begin() + 9, jump.end());
  for (const auto& places : {strip, jump}) EXPECT_EQ(OrderOf(StripNamed(places)), Places(24));
  SurveyModel mower, video;
  for (int k = 0; k < 24; ++k) {
    const int place = k < 12 ? k : 23 - k;
    mower.AddAbove("img" + std::to_string(k), 0.25 * SurveyModel::kWidth * place, k < 12 ? 0 : 0.9);
  }
  EXPECT_EQ(OrderOf(mower.WithGround()), Places(24));
  for (int k = 0; k < 150; ++k) {
    video.AddAbove("img" + std::to_string(k), 0.01 * SurveyModel::kWidth * k);
  }
  EXPECT_EQ(OrderOf(video.WithGround(0.2)), Places(150));
}

TEST(OrderPicturesTest, RandomNamesAreOrderedByTheModel) {
  std::vector<int> places = Places(40);
  std::shuffle(places.begin(), places.end(), std::mt19937(3));
  const SparseModel model = StripNamed(places);
  const std::vector<int> order = OrderOf(model);
  EXPECT_EQ(order.front(), 0);
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, Places(40));
  int num_neighbors = 0;
  for (size_t k = 1; k < order.size(); ++k) {
    const int step =
        places[static_cast<size_t>(order[k])] - places[static_cast<size_t>(order[k - 1])];
    num_neighbors += std::abs(step) == 1;
  }
  EXPECT_GE(num_neighbors, 36);
  EXPECT_GT(Continuity(model, order), 2 * Continuity(model, Places(40)));
}

// The file's order of pictures has no say.
TEST(OrderPicturesTest, TiesGoByName) {
  std::vector<int> places = Places(30);
  std::shuffle(places.begin(), places.end(), std::mt19937(5));
  const SparseModel model = StripNamed(places);
  SparseModel backward = model;
  std::reverse(backward.images.begin(), backward.images.end());
  const std::vector<int> one = OrderOf(model), other = OrderOf(backward);
  for (size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(model.images[static_cast<size_t>(one[k])].name,
              backward.images[static_cast<size_t>(other[k])].name);
  }
}

// Two cameras whose sub-folders are each a track: one after the other, as their names say.
TEST(OrderPicturesTest, SubFoldersThatAreTracks) {
  SurveyModel survey;
  for (const std::string folder : {"port/", "starboard/"}) {
    for (int k = 0; k < 12; ++k) {
      survey.AddAbove(folder + std::to_string(k), 0.2 * SurveyModel::kWidth * k,
                      folder == "port/" ? 0 : 0.4);
    }
  }
  EXPECT_EQ(OrderOf(survey.WithGround()), Places(24));
}

// Two cameras that looked at different things, with one counter: the names go to and fro.
TEST(OrderPicturesTest, TwoCamerasShuffledAreTakenApart) {
  SurveyModel survey;
  for (int k = 0; k < 24; ++k) {
    survey.AddAbove(std::to_string(k), 0.2 * SurveyModel::kWidth * (k / 2), k % 2 == 0 ? 0 : 1.75);
  }
  std::vector<int> expected;
  for (int k = 0; k < 24; k += 2) expected.push_back(k);
  const std::vector<int> order = OrderOf(survey.WithGround());
  EXPECT_EQ(std::vector<int>(order.begin(), order.begin() + 12), expected);
}

}  // namespace
}  // namespace colmap_seapoint
