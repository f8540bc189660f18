#include "colmap_seapoint/lens/compact_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

TEST(CompactPartTest, TakesPicturesThatSeeTheSameGroundAndWhatTwoOfThemSee) {
  const SparseModel model = ExactSurvey(ExactLens(), 20);
  const SparseModel part = CompactPart(model, 8);
  ASSERT_EQ(part.images.size(), 8u);
  EXPECT_EQ(part.cameras.size(), model.cameras.size());
  double first = 1e9, last = -1e9;
  std::map<uint32_t, const PosedImage*> images;
  for (const PosedImage& image : part.images) {
    images[image.image_id] = &image;
    const double x = image.cam_from_world.OriginInSource().x();
    first = std::min(first, x);
    last = std::max(last, x);
  }
  EXPECT_LT(last - first, 8 * 0.4);  // 20 pictures of two strips are 8 m long
  EXPECT_GT(part.points3D.size(), 100u);
  size_t num_observations = 0;
  for (const auto& [id, point] : part.points3D) {
    EXPECT_GE(point.track.size(), 2u);
    for (const auto& element : point.track) {
      ASSERT_EQ(images.count(element.image_id), 1u);
      EXPECT_EQ(images[element.image_id]->point3D_ids[element.point2D_idx], id);
      ++num_observations;
    }
  }
  size_t num_seen = 0;
  for (const PosedImage& image : part.images) {
    for (const uint64_t id : image.point3D_ids) num_seen += id != kNoPoint3D;
  }
  EXPECT_EQ(num_seen, num_observations);
}

TEST(CompactPartTest, ASmallModelIsItsOwnPart) {
  const SparseModel model = ExactSurvey(ExactLens(), 3);
  const SparseModel part = CompactPart(model, 6);
  EXPECT_EQ(part.images.size(), 6u);
  EXPECT_EQ(part.points3D.size(), model.points3D.size());
  EXPECT_TRUE(CompactPart({}, 6).images.empty());
}

}  // namespace
}  // namespace colmap_seapoint
