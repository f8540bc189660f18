#include "examples/benchmarks/poses/observation_errors.h"

#include <gtest/gtest.h>

#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

constexpr int kPicturesAStrip = 6;

SparseModel Truth() { return ExactSurvey(ExactLens(), kPicturesAStrip); }

TEST(MeasureObservations, FindsNoneInAnExactModel) {
  const SparseModel truth = Truth();
  const ObservationErrors errors = MeasureObservations(truth, truth, kPicturesAStrip);
  EXPECT_EQ(errors.num_points, truth.points3D.size());
  EXPECT_EQ(errors.num_unplaced, 0u);
  ASSERT_EQ(errors.rows.size(), 6u);
  EXPECT_EQ(errors.rows[1].num, 0u);  // nothing is twice in a picture
  for (const size_t row : {0, 2, 3, 4, 5}) {
    EXPECT_GT(errors.rows[row].num, 100u) << errors.rows[row].name;
    EXPECT_LT(errors.rows[row].median, 1e-3) << errors.rows[row].name;
    EXPECT_EQ(errors.rows[row].beyond[0], 0) << errors.rows[row].name;
  }
}

// The model's own cameras do not matter: only its observations and the truth's cameras do.
TEST(MeasureObservations, FindsThoseThatAreOff) {
  const SparseModel truth = Truth();
  SparseModel model = truth;
  for (PosedImage& image : model.images) image.cam_from_world.translation.x() += 5;
  size_t num = 0, num_off = 0;
  for (auto& [id, point] : model.points3D) {
    if (point.track.size() >= 2) num += point.track.size();
    if (point.track.size() < 6 || id % 5 != 0) continue;
    const SparsePoint::TrackElement& element = point.track[1];
    for (PosedImage& image : model.images) {
      if (image.image_id != element.image_id) continue;
      image.points2D[element.point2D_idx] += Eigen::Vector2d(8, 8);
      ++num_off;
    }
  }
  ASSERT_GT(num_off, 10u);
  const ObservationErrors errors = MeasureObservations(truth, model, kPicturesAStrip);
  EXPECT_NEAR(errors.rows[0].beyond[3], static_cast<double>(num_off) / static_cast<double>(num),
              1e-9);
}

}  // namespace
}  // namespace colmap_seapoint
