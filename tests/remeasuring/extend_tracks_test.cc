#include "colmap_seapoint/remeasuring/extend_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "colmap_seapoint/remeasuring/remeasure_observations.h"
#include "tests/remeasuring/measured_world.h"

namespace colmap_seapoint {
namespace {

const MeasuredWorld& TheWorld() {
  static const MeasuredWorld world(0.3);
  return world;
}

// The world's model without the last observation of every track of three and more.
SparseModel Shortened() {
  SparseModel model = TheWorld().Model();
  for (auto& [id, point] : model.points3D) {
    if (point.track.size() < 3) continue;
    const SparsePoint::TrackElement last = point.track.back();
    point.track.pop_back();
    model.images[last.image_id - 1].point3D_ids[last.point2D_idx] = kNoPoint3D;
  }
  return model;
}

Remeasurement ExtendAndMeasure(size_t max_observations, int num_threads) {
  SparseModel model = Shortened();
  RemeasuringOptions options;
  options.num_threads = num_threads;
  options.first_predicted = NumPoints2D(model);
  ExtendTracks({max_observations, num_threads}, &model);
  return RemeasureObservations(options, model,
                               [](const PosedImage& image) { return TheWorld().PictureOf(image); });
}

size_t NumObservations(const SparseModel& model) {
  size_t num = 0;
  for (const auto& [id, point] : model.points3D) num += point.track.size();
  return num;
}

void ExpectEqual(const SparseModel& a, const SparseModel& b) {
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].points2D, b.images[i].points2D);
    EXPECT_EQ(a.images[i].point3D_ids, b.images[i].point3D_ids);
  }
  EXPECT_EQ(NumObservations(a), NumObservations(b));
}

TEST(ExtendTracks, FindsWhatMatchingMissed) {
  const SparseModel shortened = Shortened();
  const size_t num_missing = NumObservations(TheWorld().Model()) - NumObservations(shortened);
  ASSERT_GT(num_missing, 300u);
  const SparseModel found = ExtendAndMeasure(10000, 2).model;
  EXPECT_GT(NumObservations(found), NumObservations(shortened) + 8 * num_missing / 10);
  SparseModel predicted = shortened;
  ExtendTracks({10000, 2}, &predicted);
  EXPECT_LT(ErrorsOfMoved(TheWorld(), predicted, found).after, 0.05);
}

TEST(ExtendTracks, IsTheSameForAnyNumberOfThreads) {
  const SparseModel one = ExtendAndMeasure(400, 1).model;
  for (const int num_threads : {2, 5}) ExpectEqual(one, ExtendAndMeasure(400, num_threads).model);
}

TEST(ExtendTracks, KeepsTheLimit) {
  SparseModel model = Shortened();
  std::vector<size_t> before;
  for (const PosedImage& image : model.images) {
    before.push_back(
        static_cast<size_t>(std::count_if(image.point3D_ids.begin(), image.point3D_ids.end(),
                                          [](uint64_t id) { return id != kNoPoint3D; })));
  }
  const size_t limit = *std::min_element(before.begin(), before.end()) + 20;
  const std::map<uint32_t, size_t> num_points2D = NumPoints2D(model);
  ExtendTracks({limit, 2}, &model);
  size_t num_added = 0;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const size_t added =
        model.images[i].points2D.size() - num_points2D.at(model.images[i].image_id);
    EXPECT_LE(added, before[i] < limit ? limit - before[i] : 0);
    num_added += added;
  }
  EXPECT_GE(num_added, 20u);
}

TEST(ExtendTracks, LeavesNothingBehind) {
  SparseModel model = Shortened();
  const std::map<uint32_t, size_t> num_points2D = NumPoints2D(model);
  ExtendTracks({10000, 2}, &model);
  ASSERT_GT(NumObservations(model), NumObservations(Shortened()));
  std::reverse(model.images.begin(), model.images.end());  // as adjustments may
  DropExtensions(num_points2D, &model);
  std::reverse(model.images.begin(), model.images.end());
  ExpectEqual(model, Shortened());
}

TEST(ExtendTracks, APointThatOnlyPredictionsHoldGoes) {
  SparseModel model = Shortened();
  const std::map<uint32_t, size_t> num_points2D = NumPoints2D(model);
  ExtendTracks({10000, 2}, &model);
  auto& [id, point] =
      *std::find_if(model.points3D.begin(), model.points3D.end(),
                    [](const auto& entry) { return entry.second.track.size() == 3; });
  const SparsePoint::TrackElement first = point.track.front();
  point.track.erase(point.track.begin());  // one of a matched track of two is left
  model.images[first.image_id - 1].point3D_ids[first.point2D_idx] = kNoPoint3D;
  const uint64_t gone = id;
  DropExtensions(num_points2D, &model);
  EXPECT_EQ(model.points3D.count(gone), 0u);
  for (const PosedImage& image : model.images) {
    EXPECT_EQ(std::count(image.point3D_ids.begin(), image.point3D_ids.end(), gone), 0);
  }
}

}  // namespace
}  // namespace colmap_seapoint
