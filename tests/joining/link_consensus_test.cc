#include "colmap_seapoint/joining/link_consensus.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/joining/link_evidence.h"
#include "tests/joining/two_models.h"

namespace colmap_seapoint {
namespace {

// Pictures 1, 2 and 3, 4 of the same ground; the second model in another frame.
struct Overlap {
  TestModel a, b;
  std::vector<ModelLink> links;
};

Overlap ExactOverlap() {
  const auto ground = StrewnGround(-1, 1.5, -1, 1, 200, 0, 3);
  Overlap overlap{SeenBy({PictureAt(1, 0, 0), PictureAt(2, 0.3, 0.1)}, ground),
                  SeenBy({PictureAt(3, 0.2, 0), PictureAt(4, 0.5, 0.1)}, ground),
                  {}};
  TransformModel(OtherFrame(), &overlap.b.model);
  for (const auto& [id, point] : overlap.a.model.points3D) {
    const auto there = overlap.b.model.points3D.find(id);
    if (there == overlap.b.model.points3D.end()) continue;
    const auto& track_b = there->second.track;
    overlap.links.push_back({id, id, 0, 0,
                             overlap.a.model.images[0].points2D[point.track[0].point2D_idx],
                             overlap.b.model.images[0].points2D[track_b[0].point2D_idx]});
  }
  return overlap;
}

TEST(LinkConsensusTest, FindsTheFrameAmongWrongLinks) {
  Overlap overlap = ExactOverlap();
  const size_t num_right = overlap.links.size();
  ASSERT_GT(num_right, 60u);
  // Half as many again, each to the next one's place.
  for (size_t i = 0; i < num_right / 2; ++i) {
    ModelLink wrong = overlap.links[i];
    wrong.point_b = overlap.links[i + 7].point_b;
    wrong.pixel_b = overlap.links[i + 7].pixel_b;
    overlap.links.push_back(wrong);
  }
  const auto found = FindLinkConsensus(overlap.a.model, overlap.b.model, overlap.links);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers.size(), num_right);
  EXPECT_LT(found->num_rival_links, 10u);
  const Similarity3d truth = OtherFrame();
  EXPECT_NEAR(found->b_from_a.scale, truth.scale, 1e-9);
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3)}) {
    EXPECT_LT((found->b_from_a * x - truth * x).norm(), 1e-8);
  }
}

// Half of the links lead to the place itself, and half to one 0.2 units beside it that looks the
// same.
TEST(LinkConsensusTest, TwoWaysToJoinAreRivals) {
  Overlap overlap = ExactOverlap();
  const size_t num_links = overlap.links.size();
  const PosedImage& image = overlap.b.model.images[0];
  for (size_t i = num_links / 2; i < num_links; ++i) {
    ModelLink& link = overlap.links[i];
    SparsePoint& point = overlap.b.model.points3D.at(link.point_b);
    const Eigen::Vector3d& place = overlap.a.model.points3D.at(link.point_a).xyz;
    point.xyz = OtherFrame() * (place + Eigen::Vector3d(0.2, 0, 0));
    const auto pixel = overlap.b.model.cameras.at(1).ImgFromCam(image.cam_from_world * point.xyz);
    ASSERT_TRUE(pixel);
    link.pixel_b = *pixel;
  }
  const auto found = FindLinkConsensus(overlap.a.model, overlap.b.model, overlap.links);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers.size() + found->num_rival_links, num_links);
  EXPECT_GT(found->num_rival_links, num_links / 3);
  // As many points and pictures as one likes do not help then.
  LinkEvidence evidence = {100, 5, 5, 20, 20};
  EXPECT_NE(Doubt(evidence, *found), "");
  EXPECT_EQ(Doubt(evidence, {found->b_from_a, found->inliers, 0}), "");
  evidence.num_linked = 7;  // of 20 places that should be linked
  EXPECT_NE(Doubt(evidence, {found->b_from_a, found->inliers, 0}), "");
}

TEST(LinkConsensusTest, LinksAlongALineDoNotTellTheTurn) {
  Overlap overlap = ExactOverlap();
  int k = 0;
  for (auto& [id, point] : overlap.a.model.points3D) point.xyz = {0.01 * ++k - 1, 0, 2};
  k = 0;
  for (auto& [id, point] : overlap.b.model.points3D) point.xyz = {0.01 * ++k - 1, 0, 2};
  EXPECT_FALSE(FindLinkConsensus(overlap.a.model, overlap.b.model, overlap.links));
}

TEST(LinkConsensusTest, TooFewLinksAgreeOnNothing) {
  Overlap overlap = ExactOverlap();
  overlap.links.resize(2);
  EXPECT_FALSE(FindLinkConsensus(overlap.a.model, overlap.b.model, overlap.links));
  overlap.links.clear();
  EXPECT_FALSE(FindLinkConsensus(overlap.a.model, overlap.b.model, overlap.links));
}

TEST(LinkConsensusTest, AnInverseTakesBack) {
  const Similarity3d frame = OtherFrame(), back = frame.Inverse();
  const Eigen::Vector3d x(0.4, -2, 5);
  EXPECT_LT((back * (frame * x) - x).norm(), 1e-12);
}

}  // namespace
}  // namespace colmap_seapoint
