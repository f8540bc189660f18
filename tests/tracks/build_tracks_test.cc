#include "colmap_seapoint/tracks/build_tracks.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace colmap_seapoint {
namespace {

std::vector<TrackObservation> TrackOf(const Tracks& tracks, size_t t) {
  return {tracks.observations.begin() + static_cast<std::ptrdiff_t>(tracks.begins[t]),
          tracks.observations.begin() + static_cast<std::ptrdiff_t>(tracks.begins[t + 1])};
}

TEST(BuildTracksTest, MatchesOfPairsBecomeOneTrack) {
  TrackBuilder builder({5, 5, 5, 5});
  builder.Add(0, 1, {{0, 1}, {2, 3}});
  builder.Add(1, 3, {{1, 4}});
  builder.Add(0, 3, {{0, 4}});
  const Tracks tracks = builder.Build();
  ASSERT_EQ(tracks.Count(), 2u);
  EXPECT_EQ(TrackOf(tracks, 0), (std::vector<TrackObservation>{{0, 0}, {1, 1}, {3, 4}}));
  EXPECT_EQ(TrackOf(tracks, 1), (std::vector<TrackObservation>{{0, 2}, {1, 3}}));
}

TEST(BuildTracksTest, TheOrderOfThePairsDoesNotMatter) {
  TrackBuilder forward({3, 3, 3}), backward({3, 3, 3});
  forward.Add(0, 1, {{0, 0}, {1, 2}});
  forward.Add(1, 2, {{0, 1}, {2, 2}});
  backward.Add(2, 1, {{2, 2}, {1, 0}});
  backward.Add(1, 0, {{2, 1}, {0, 0}});
  EXPECT_EQ(forward.Build().observations, backward.Build().observations);
}

TEST(BuildTracksTest, ATrackThatShowsAPictureTwiceIsLeftOut) {
  TrackBuilder builder({3, 3, 3});
  builder.Add(0, 1, {{0, 0}, {2, 2}});
  builder.Add(1, 2, {{0, 1}});
  builder.Add(0, 2, {{1, 1}});  // joins the first picture's 0 and 1
  const Tracks tracks = builder.Build();
  ASSERT_EQ(tracks.Count(), 1u);
  EXPECT_EQ(TrackOf(tracks, 0), (std::vector<TrackObservation>{{0, 2}, {1, 2}}));
}

TEST(BuildTracksTest, NothingMatchedAndPicturesWithoutKeypoints) {
  EXPECT_EQ(TrackBuilder({}).Build().Count(), 0u);
  EXPECT_EQ(TrackBuilder({0, 4, 0}).Build().Count(), 0u);
}

TEST(BuildTracksTest, AnIndexThatNoKeypointHasIsOurOwnFault) {
  TrackBuilder builder({2, 2});
  EXPECT_THROW(builder.Add(0, 1, {{2, 0}}), std::logic_error);
}

}  // namespace
}  // namespace colmap_seapoint
