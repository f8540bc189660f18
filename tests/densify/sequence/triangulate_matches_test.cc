#include "densify/sequence/triangulate_matches.h"

#include <gtest/gtest.h>

#include "tests/densify/test_survey.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

Camera TestCamera() { return MildCamera(CameraModel::kOpenCV, 210, 240, 180); }

class Strip : public TestSurvey {
 public:
  explicit Strip(int num_pictures = 6, double advance = 0.45)
      : TestSurvey(FlatWorld(kDepth), TestCamera()) {
    for (int i = 0; i < num_pictures; ++i) {
      AddPicture(std::to_string(i), StandAt(TestCamera(), {advance * i, 0, 0}, {1, 2, 3.0 * i}));
    }
    AddLandmarks(600, {-1, 4}, {-1, 1});
  }

  SparseModel Bare() const {
    SparseModel model = Model();
    model.points3D.clear();
    for (PosedImage& image : model.images) {
      image.points2D.clear();
      image.point3D_ids.clear();
    }
    return model;
  }
};

TEST(TriangulateMatchesTest, PointsOfTheWorldWithTheirTracks) {
  Strip strip;
  PictureCache pictures(&strip);
  EXPECT_TRUE(HasSharedPoints(strip.Model()));
  ASSERT_FALSE(HasSharedPoints(strip.Bare()));
  const SparseModel model = WithTriangulatedMatches(strip.Bare(), &pictures);
  EXPECT_TRUE(HasSharedPoints(model));
  ASSERT_GT(model.points3D.size(), 500u);
  for (const auto& [id, point] : model.points3D) {
    EXPECT_LT(strip.GetWorld().Distance(point.xyz), 1e-4);
    ASSERT_EQ(point.track.size(), 2u);
    for (const auto& element : point.track) {
      const PosedImage& image = model.images[element.image_id - 11];
      ASSERT_EQ(image.point3D_ids.size(), image.points2D.size());
      EXPECT_EQ(image.point3D_ids[element.point2D_idx], id);
      EXPECT_LT((*TestCamera().ImgFromCam(image.cam_from_world * point.xyz) -
                 image.points2D[element.point2D_idx])
                    .norm(),
                0.01);
    }
  }
}

// Points of one view stay, under their ids.
TEST(TriangulateMatchesTest, WhatIsThereStays) {
  Strip strip(3);
  PictureCache pictures(&strip);
  SparseModel model = strip.Bare();
  model.points3D[70].xyz = {1, 2, 3};
  model.points3D[70].track = {{11, 0}, {11, 1}};
  model.images[0].point3D_ids = {70, 70};
  ASSERT_FALSE(HasSharedPoints(model));
  const SparseModel more = WithTriangulatedMatches(model, &pictures);
  EXPECT_GT(more.points3D.size(), 100u);
  EXPECT_EQ(more.points3D.begin()->first, 70u);
  EXPECT_EQ(more.images[0].point3D_ids[1], 70u);
  EXPECT_EQ(more.images[0].points2D.size(), more.images[0].point3D_ids.size());
}

TEST(TriangulateMatchesTest, WrongMatchesGiveNoPoint) {
  class Wrong : public Strip {
   public:
    std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) override {
      FeatureMatches matches = *Strip::ReadMatches(image_idx1, image_idx2);
      for (FeatureMatch& match : matches) match.idx2 = matches[0].idx2;
      return matches;
    }
  };
  Wrong strip;
  PictureCache pictures(&strip);
  const SparseModel model = WithTriangulatedMatches(strip.Bare(), &pictures);
  size_t num_wrong = 0;
  for (const auto& [id, point] : model.points3D) {
    num_wrong += strip.GetWorld().Distance(point.xyz) > 0.05;
  }
  // Those on the one SeaPoint's epipolar line, in each of some 9 pairs.
  EXPECT_LT(num_wrong, 90u);
}

TEST(TriangulateMatchesTest, ADegreeOfParallaxAtLeast) {
  Strip still(5, 0.005);  // 0.6 degrees from end to end
  PictureCache pictures(&still);
  EXPECT_TRUE(WithTriangulatedMatches(still.Bare(), &pictures).points3D.empty());
}

// A video: the nearest pictures come to no baseline, farther ones do.
TEST(TriangulateMatchesTest, Video) {
  Strip video(40, 0.012);
  PictureCache pictures(&video);
  EXPECT_GT(WithTriangulatedMatches(video.Bare(), &pictures).points3D.size(), 1000u);
}

// The cloud is as good as with the mapper's points.
TEST(DensifySequenceTest, ModelWithoutPoints) {
  Strip strip;
  const Outcome with_points = Densify(&strip, PartialDensificationOptions());
  EXPECT_EQ(with_points.report.num_triangulated, 0);
  *strip.MutableModel() = strip.Bare();
  const Outcome without = Densify(&strip, PartialDensificationOptions());
  EXPECT_GT(without.report.num_triangulated, 500);
  const double gsd = kDepth / 210;
  const auto covered = [&](const Outcome& outcome) {
    return CoveredSquares(strip.GetWorld(), outcome.clouds, 4 * gsd, 2 * gsd).size();
  };
  EXPECT_GT(static_cast<double>(covered(without)),
            0.98 * static_cast<double>(covered(with_points)));
  EXPECT_GE(ShareOnSurface(strip.GetWorld(), without, 4 * gsd), 0.98);
}

}  // namespace
}  // namespace colmap_seapoint
