#include "colmap_seapoint/page/gap_pictures.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

class GapPicturesOfASurvey : public testing::Test {
 protected:
  static bool Keep(const Eigen::Vector2d& p) {
    return (p - Eigen::Vector2d(1.6, 2.4)).norm() > 0.8;
  }
  const SparseModel model_ = MakeFlatSurvey({2, 4, 1.6, 3.2});
  const CompletenessResult result_ = AssessCompleteness(FlatInput(model_, Keep), {}, 2);

  // The seabed's disc of radius 0.8 about (1.6, 2.4) is white, all else black.
  ColorImage Photograph(const std::string& name) const {
    for (const PosedImage& image : model_.images) {
      if (image.name != name) continue;
      const Camera& camera = model_.cameras.at(image.camera_id);
      const Rigid3d world_from_cam = image.cam_from_world.Inverse();
      ColorImage picture(camera.width, camera.height, 3, 0);
      for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
          const auto ray = camera.CamFromImg({x + 0.5, y + 0.5});
          const Eigen::Vector3d place =
              world_from_cam * (kFlatAltitude * Eigen::Vector3d(ray->x(), ray->y(), 1));
          if (Keep(place.head<2>())) continue;
          for (int c = 0; c < 3; ++c) picture.At(x, y, c) = 255;
        }
      }
      return picture;
    }
    return {};
  }
};

TEST_F(GapPicturesOfASurvey, TheCropShowsTheGapWithinItsOutline) {
  size_t hole = result_.gaps.size();
  for (size_t g = 0; g < result_.gaps.size(); ++g) {
    if (result_.gaps[g].region.cause == GapCause::kViewsDisagree) hole = g;
  }
  ASSERT_LT(hole, result_.gaps.size());
  std::mutex mutex;
  std::multiset<std::string> reads;
  const auto read = [&](const std::string& name) {
    const std::lock_guard<std::mutex> lock(mutex);
    reads.insert(name);
    return Photograph(name);
  };
  const auto pictures = CutGapPictures(result_, model_, read, 2);
  ASSERT_EQ(pictures.size(), result_.gaps.size());
  for (const std::string& name : reads) EXPECT_EQ(reads.count(name), 1u) << name;
  ASSERT_EQ(pictures[hole].size(), kPicturesOfGap);
  for (const GapPicture& picture : pictures[hole]) {
    EXPECT_TRUE(picture.shows_gap);
    EXPECT_LE(std::max(picture.crop.width, picture.crop.height), kGapPictureSide);
    ASSERT_EQ(picture.outline.size(), 1u);
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : picture.outline[0]) middle += corner;
    middle /= static_cast<double>(picture.outline[0].size());
    const int x = static_cast<int>(middle.x()), y = static_cast<int>(middle.y());
    ASSERT_TRUE(picture.crop.Contains(x, y));
    EXPECT_GT(picture.crop.At(x, y), 200);  // the disc
    EXPECT_LT(picture.crop.At(2, 2), 50);   // what lies around it
  }
}

TEST_F(GapPicturesOfASurvey, PicturesThatCannotBeUsedAreLeftOut) {
  std::atomic<int> count = 0;
  const auto broken = [&](const std::string&) {
    return ++count % 2 == 0 ? ColorImage() : ColorImage(10, 10, 3);
  };
  for (const auto& pictures : CutGapPictures(result_, model_, broken, 1)) {
    EXPECT_TRUE(pictures.empty());
  }
  EXPECT_GT(count, 1);
}

}  // namespace
}  // namespace colmap_seapoint
