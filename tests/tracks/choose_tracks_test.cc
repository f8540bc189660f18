#include "colmap_seapoint/tracks/choose_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 800, kHeight = 600;

// A strip of pictures over points on the ground, each a fifth of a picture on; one in three points
// is not found where it is seen.
struct Strip {
  std::vector<TrackedPicture> pictures;
  Tracks tracks;
};

Strip MakeStrip(uint32_t num_pictures, int num_points) {
  Strip strip;
  strip.pictures.resize(num_pictures);
  for (TrackedPicture& picture : strip.pictures) picture = {kWidth, kHeight, {}};
  std::mt19937 random(5);
  const float advance = kWidth / 5.F;
  std::uniform_real_distribution<float> along(0, advance * static_cast<float>(num_pictures + 4));
  std::uniform_real_distribution<float> across(0, kHeight);
  std::bernoulli_distribution is_found(2. / 3);
  for (int i = 0; i < num_points; ++i) {
    const float x = along(random), y = across(random);
    std::vector<TrackObservation> track;
    for (uint32_t p = 0; p < num_pictures; ++p) {
      const float in_picture = x - advance * static_cast<float>(p);
      if (in_picture < 0 || in_picture >= kWidth || !is_found(random)) continue;
      track.push_back({p, static_cast<uint32_t>(strip.pictures[p].keypoints.size())});
      strip.pictures[p].keypoints.emplace_back(in_picture, y);
    }
    if (track.size() < 2) continue;
    strip.tracks.observations.insert(strip.tracks.observations.end(), track.begin(), track.end());
    strip.tracks.begins.push_back(strip.tracks.observations.size());
  }
  return strip;
}

std::vector<int> ObservationsOf(const Strip& strip, const std::vector<uint32_t>& chosen) {
  std::vector<int> counts(strip.pictures.size(), 0);
  for (const uint32_t t : chosen) {
    for (uint64_t i = strip.tracks.begins[t]; i < strip.tracks.begins[t + 1]; ++i) {
      ++counts[strip.tracks.observations[i].picture_idx];
    }
  }
  return counts;
}

TEST(ChooseTracksTest, EveryPictureGetsAboutItsShare) {
  const Strip strip = MakeStrip(12, 12000);
  const auto chosen = ChooseTracks(strip.tracks, strip.pictures, 256);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  for (const int count : ObservationsOf(strip, chosen)) {
    EXPECT_GE(count, 128);
    EXPECT_LE(count, 384);
  }
}

TEST(ChooseTracksTest, EveryPartOfAPictureHasSome) {
  const Strip strip = MakeStrip(12, 12000);
  std::vector<bool> is_seen(16, false);  // 4 x 4 parts of a picture in the middle
  for (const uint32_t t : ChooseTracks(strip.tracks, strip.pictures, 256)) {
    for (uint64_t i = strip.tracks.begins[t]; i < strip.tracks.begins[t + 1]; ++i) {
      const TrackObservation& observation = strip.tracks.observations[i];
      if (observation.picture_idx != 6) continue;
      const Eigen::Vector2f& place = strip.pictures[6].keypoints[observation.keypoint_idx];
      is_seen[static_cast<size_t>(place.y() * 4 / kHeight) * 4 +
              static_cast<size_t>(place.x() * 4 / kWidth)] = true;
    }
  }
  EXPECT_EQ(std::count(is_seen.begin(), is_seen.end(), true), 16);
}

TEST(ChooseTracksTest, LongTracksComeFirst) {
  const Strip strip = MakeStrip(12, 12000);
  const auto mean_length = [&](const std::vector<uint32_t>& tracks) {
    double sum = 0;
    for (const uint32_t t : tracks)
      sum += static_cast<double>(strip.tracks.begins[t + 1] - strip.tracks.begins[t]);
    return sum / static_cast<double>(tracks.size());
  };
  std::vector<uint32_t> all(strip.tracks.Count());
  for (uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  EXPECT_GT(mean_length(ChooseTracks(strip.tracks, strip.pictures, 256)), mean_length(all) + .5);
}

TEST(ChooseTracksTest, WhatIsTiedByLittleKeepsAllOfIt) {
  const Strip strip = MakeStrip(12, 150);
  EXPECT_EQ(ChooseTracks(strip.tracks, strip.pictures, 256).size(), strip.tracks.Count());
}

TEST(ChooseTracksTest, PlacesOutsideThePictureAreOfTheNearestCell) {
  Tracks tracks;
  tracks.begins = {0, 2};
  tracks.observations = {{0, 0}, {1, 0}};
  const TrackedPicture picture = {kWidth, kHeight, {{-5, 1e9F}}};
  EXPECT_EQ(ChooseTracks(tracks, {picture, picture}, 256), std::vector<uint32_t>{0});
}

}  // namespace
}  // namespace colmap_seapoint
