#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "densify/completeness/sight/lost_pictures.h"
#include "densify/completeness/sight/picture_facts.h"
#include "densify/completeness/sight/sightings.h"

namespace colmap_seapoint {
namespace {

GrayImage Noise(int width, int height, int blur) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int sum = 0, count = 0;
      for (int dy = -blur; dy <= blur; ++dy) {
        for (int dx = -blur; dx <= blur; ++dx) {
          uint32_t h = static_cast<uint32_t>((x + dx + 50) * 7919 + (y + dy + 50) * 104729);
          h = (h ^ (h >> 15)) * 0x2c1b3c6du;
          h = (h ^ (h >> 12)) * 0x297a2d39u;
          sum += static_cast<int>((h >> 16) & 255);
          ++count;
        }
      }
      // The same contrast, whatever the blur.
      image.At(x, y) =
          static_cast<uint8_t>(std::clamp(128 + (sum / count - 128) * (2 * blur + 1) / 2, 0, 255));
    }
  }
  return image;
}

TEST(MeasurePicture, FlatHasNoTexture) {
  const PictureFacts facts = MeasurePicture(GrayImage(40, 33, 1, 100), {});
  EXPECT_EQ(facts.width, 3);
  EXPECT_EQ(facts.height, 3);
  for (const uint8_t texture : facts.texture) EXPECT_EQ(texture, 0);
  EXPECT_EQ(facts.sharpness, 0);
}

TEST(MeasurePicture, LightThatRisesEvenlyIsNoTexture) {
  GrayImage luma(48, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x) luma.At(x, y) = static_cast<uint8_t>(20 + 3 * x + 2 * y);
  }
  for (const uint8_t texture : MeasurePicture(luma, {}).texture) EXPECT_EQ(texture, 0);
}

TEST(MeasurePicture, ExposureAndMask) {
  GrayImage luma = Noise(64, 32, 1), mask(64, 32, 1, 255);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      luma.At(x, y) = 1;
      luma.At(16 + x, y) = 254;
      mask.At(32 + x, y) = 0;
    }
  }
  const PictureFacts facts = MeasurePicture(luma, mask);
  EXPECT_EQ(facts.flags[0], kBadlyExposedCell);
  EXPECT_EQ(facts.flags[1], kBadlyExposedCell);
  EXPECT_EQ(facts.flags[2], kMaskedCell);
  EXPECT_EQ(facts.flags[3], 0);
  EXPECT_GT(facts.texture[3], 20);
}

TEST(JudgePictures, BlurredAmongSharpOnes) {
  std::vector<PictureFacts> facts;
  for (int i = 0; i < 9; ++i) facts.push_back(MeasurePicture(Noise(96, 96, i == 4 ? 8 : 2), {}));
  JudgePictures(&facts);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(facts[static_cast<size_t>(i)].is_bad, i == 4) << i;
  // A dive in which all are as soft has none that is bad.
  for (PictureFacts& f : facts) f = MeasurePicture(Noise(96, 96, 8), {});
  JudgePictures(&facts);
  for (const PictureFacts& f : facts) EXPECT_FALSE(f.is_bad);
}

TEST(FindLostRuns, ByNaturalOrderAndFolder) {
  const auto runs = FindLostRuns({"a/img1.jpg", "a/img4.jpg", "b/img1.jpg"},
                                 {"a/img10.jpg", "a/img2.jpg", "a/img3.jpg", "c/x.jpg"}, {});
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].names, (std::vector<std::string>{"a/img2.jpg", "a/img3.jpg"}));
  EXPECT_EQ(runs[0].before, 0);
  EXPECT_EQ(runs[0].after, 1);
  EXPECT_EQ(runs[1].names, std::vector<std::string>{"a/img10.jpg"});
  EXPECT_EQ(runs[1].before, 1);
  EXPECT_EQ(runs[1].after, -1);
  EXPECT_EQ(runs[2].before, -1);
  EXPECT_EQ(runs[2].after, -1);
}

TEST(FindLostRuns, ATrackThatGoesOnInAnotherModelIsNoPlace) {
  // 1 is here, 2 and 5 are lost, 3 is in another model, 4 and 6 are here.
  const auto runs = FindLostRuns({"1.jpg", "4.jpg", "6.jpg"}, {"2.jpg", "5.jpg"}, {"3.jpg"});
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].before, 0);
  EXPECT_EQ(runs[0].after, -1);
  EXPECT_EQ(runs[1].before, 1);
  EXPECT_EQ(runs[1].after, 2);
}

TEST(ShowsAnother, BeforeOrBehindThePlace) {
  DepthCells depths(4, 3, 20);
  depths.Draw(1, 1, depths.CodeOf(9));
  depths.Draw(1, 1, depths.CodeOf(5));  // the nearer one stays
  depths.Draw(1, 1, depths.CodeOf(7));
  EXPECT_NEAR(depths.DepthAt(1, 1), 5, 20.0 / 65535);
  const Eigen::Vector2d there(1.5 * kDepthCell, 1.5 * kDepthCell);
  EXPECT_FALSE(ShowsAnother(depths, {1, 1}, 5, 0.1));  // nothing is drawn there
  EXPECT_FALSE(ShowsAnother(depths, there, 5.05, 0.1));
  EXPECT_TRUE(ShowsAnother(depths, there, 6, 0.1));
  EXPECT_TRUE(ShowsAnother(depths, there, 4, 0.1));
}

class Causes : public testing::Test {
 protected:
  Sight See(SightKind kind, double angle_deg, uint8_t texture = 80) {
    const double a = angle_deg * 3.14159265358979 / 180;
    Sight sight;
    sight.kind = kind;
    sight.texture = texture;
    sight.gsd = 1 + angle_deg;
    sight.across = 1;
    sight.toward = {std::sin(a), 0, std::cos(a)};
    return sight;
  }
  GapCause Of(const std::vector<Sight>& sights) { return CauseOf(context_, sights, {0, 0, 0}); }

  LostSight lost_{{}, {}, 1};
  SightContext context_{nullptr, nullptr, nullptr, &lost_, 1, 2};
};

TEST_F(Causes, InOrder) {
  using K = SightKind;
  EXPECT_EQ(Of({}), GapCause::kNone);
  EXPECT_EQ(Of({See(K::kGood, 0)}), GapCause::kImagedOnce);
  EXPECT_EQ(Of({See(K::kGood, 0), See(K::kGood, 1)}), GapCause::kSmallParallax);
  EXPECT_EQ(Of({See(K::kGood, 0), See(K::kGood, 9)}), GapCause::kViewsDisagree);
  EXPECT_EQ(MedianTexture({See(K::kGood, 0, 3), See(K::kBad, 1, 9), See(K::kGood, 9, 4)}), 4);
  EXPECT_EQ(MedianTexture({See(K::kGood, 0, 3)}), kUnknownTexture);
  EXPECT_EQ(Of({See(K::kGood, 0), See(K::kBad, 9)}), GapCause::kBadPicture);
  EXPECT_EQ(Of({See(K::kGood, 0), See(K::kHidden, 9)}), GapCause::kOccluded);
  // What is seen at the edge of a picture is in no window of correlation.
  EXPECT_EQ(Of({See(K::kGood, 0), See(K::kEdge, 9)}), GapCause::kImagedOnce);
  EXPECT_EQ(Of({See(K::kEdge, 9)}), GapCause::kImagedOnce);
  EXPECT_EQ(Of({See(K::kHidden, 9)}), GapCause::kOccluded);
  EXPECT_EQ(Of({See(K::kMasked, 9), See(K::kMasked, 0)}), GapCause::kOutOfArea);
  // GSD 1 + angle. Of 0, 9 and 4 degrees: 10 over 9, 5 over 4, 10 over 5 degrees.
  EXPECT_EQ(PairGsd({See(K::kGood, 0), See(K::kGood, 9), See(K::kGood, 4)}, 2), 10);
  // Beyond 11.5 degrees parallax counts no more: 31 over 11.5, 14 over 11.5.
  EXPECT_EQ(PairGsd({See(K::kGood, 0), See(K::kGood, 30), See(K::kGood, 13)}, 2), 14);
  EXPECT_EQ(PairGsd({See(K::kGood, 0), See(K::kBad, 9), See(K::kGood, 1)}, 2), std::nullopt);
  EXPECT_EQ(NearestGsd({See(K::kMasked, 0), See(K::kHidden, 3), See(K::kGood, 9)}), 4);
  // The nearest one by the line of sight, whatever the GSD on the surface's own slope.
  EXPECT_NEAR(LevelGsd({See(K::kMasked, 0), See(K::kHidden, 60), See(K::kGood, 75)}, {0, 0, 1}),
              std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(IsSeenFromTwoSides({See(K::kGood, 0), See(K::kHidden, 9), See(K::kBad, 1)}, 2));
  EXPECT_TRUE(IsSeenFromTwoSides({See(K::kGood, 0), See(K::kBad, 9)}, 2));
  EXPECT_NEAR(ParallaxDeg({See(K::kGood, 0), See(K::kGood, 9), See(K::kBad, 20)}), 9, 1e-6);
}

}  // namespace
}  // namespace colmap_seapoint
