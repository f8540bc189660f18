#include "colmap_seapoint/page/track.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

// Nine pictures along y, 1.2 units apart, that show 6.4 x 4.8 units each of a grid of points.
SparseModel MakeTrack() {
  FlatSurveyOptions options;
  options.num_strips = 1;
  options.per_strip = 9;
  options.forward = 1.2;
  return MakeFlatSurvey(options);
}

// Points of the plane z = 0, a quarter unit apart, and which picture sees which.
void AddPoints(SparseModel* model) {
  model->points3D.clear();
  uint64_t id = 0;
  for (PosedImage& image : model->images) {
    image.points2D.clear();
    image.point3D_ids.clear();
  }
  for (double y = -10; y < 30; y += 0.25) {
    for (double x = -5; x < 8; x += 0.25) {
      SparsePoint point;
      point.xyz = {x, y, 0};
      ++id;
      for (PosedImage& image : model->images) {
        const Camera& camera = model->cameras.at(image.camera_id);
        const auto pixel = camera.ImgFromCam(image.cam_from_world * point.xyz);
        if (!pixel || !camera.InImage(*pixel)) continue;
        image.points2D.push_back(*pixel);
        image.point3D_ids.push_back(id);
      }
      model->points3D[id] = point;
    }
  }
}

void Shift(const Eigen::Vector3d& by, PosedImage* image) {
  image->cam_from_world.translation -= image->cam_from_world.rotation * by;
}

class Track : public testing::Test {
 protected:
  SparseModel model_ = MakeTrack();
  std::vector<PictureRecord> records_ = std::vector<PictureRecord>(9);
  std::vector<double> brightness_ = std::vector<double>(9, 100);

  std::vector<TrackPicture> Follow() {
    AddPoints(&model_);
    return FollowTrack({&model_, &records_, &brightness_});
  }
  std::vector<TrackHint> Hints() {
    const auto track = Follow();
    return HintsOf({&model_, &records_, &brightness_}, track);
  }
};

TEST_F(Track, OverlapAndDistanceOfAnEvenTrack) {
  const std::vector<TrackPicture> track = Follow();
  ASSERT_EQ(track.size(), 9u);
  for (size_t i = 0; i < track.size(); ++i) {
    EXPECT_NEAR(track[i].distance, kFlatAltitude, 1e-6);
    EXPECT_NEAR(track[i].axis.z(), -1, 1e-9);
    if (i + 1 < track.size()) {
      EXPECT_NEAR(track[i].overlap, 1 - 1.2 / 4.8, 0.06);
    } else {
      EXPECT_EQ(track[i].overlap, -1);
    }
  }
  EXPECT_TRUE(Hints().empty());
}

TEST_F(Track, EachFaultHasItsLine) {
  for (size_t i = 6; i < 9; ++i) Shift({0, 2.4, 0}, &model_.images[i]);  // 3.6 of 4.8 units further
  Shift({0, 0, 0.75 * kFlatAltitude}, &model_.images[2]);
  brightness_[7] = brightness_[8] = 30;
  const std::vector<TrackHint> hints = Hints();
  std::set<std::string> said;
  for (const TrackHint& hint : hints) {
    said.insert(hint.text.substr(0, 8) + std::to_string(hint.first) + "-" +
                std::to_string(hint.last));
  }
  EXPECT_TRUE(said.count("too fast5-5")) << testing::PrintToString(said);
  EXPECT_TRUE(said.count("too high2-2")) << testing::PrintToString(said);
  EXPECT_TRUE(said.count("too dark7-8")) << testing::PrintToString(said);
}

TEST_F(Track, TooCloseIsSaid) {
  Shift({0, 0, -0.5 * kFlatAltitude}, &model_.images[4]);
  bool is_said = false;
  for (const TrackHint& hint : Hints()) {
    is_said = is_said || (hint.first == 4 && hint.text.rfind("too close", 0) == 0);
  }
  EXPECT_TRUE(is_said);
}

TEST_F(Track, FoldersAreTracksOfTheirOwnInNaturalOrder) {
  const std::vector<std::string> names = {"b/10.jpg", "b/9.jpg", "a/2.jpg", "a/1.jpg", "b/8.jpg",
                                          "a/3.jpg",  "a/4.jpg", "a/5.jpg", "a/11.jpg"};
  for (size_t i = 0; i < names.size(); ++i) model_.images[i].name = names[i];
  const std::vector<TrackPicture> track = Follow();
  std::vector<std::string> order;
  for (const TrackPicture& picture : track) {
    order.push_back(model_.images[static_cast<size_t>(picture.image_idx)].name);
  }
  EXPECT_EQ(order, (std::vector<std::string>{"a/1.jpg", "a/2.jpg", "a/3.jpg", "a/4.jpg", "a/5.jpg",
                                             "a/11.jpg", "b/8.jpg", "b/9.jpg", "b/10.jpg"}));
  EXPECT_EQ(track[5].overlap, -1);  // the end of its folder
}

}  // namespace
}  // namespace colmap_seapoint
