#include "colmap_seapoint/frames/list_clips.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

using Names = std::vector<std::string>;

Names NamesOf(const std::vector<Clip>& clips) {
  Names names;
  for (const Clip& clip : clips) names.push_back(clip.name);
  return names;
}

Names PrefixesOf(const std::vector<Clip>& clips) {
  Names prefixes;
  for (const Clip& clip : clips) prefixes.push_back(clip.prefix);
  return prefixes;
}

TEST(ListClipsTest, ChaptersFollowTheirRecording) {
  const auto clips =
      OrderClips("/dive", {"GX010124.MP4", "GX020123.MP4", "GX010123.MP4", "GX030123.MP4"});
  EXPECT_EQ(NamesOf(clips),
            (Names{"GX010123.MP4", "GX020123.MP4", "GX030123.MP4", "GX010124.MP4"}));
  EXPECT_EQ(PrefixesOf(clips), (Names{"GX010123/GX010123", "GX010123/GX020123", "GX010123/GX030123",
                                      "GX010124/GX010124"}));
  EXPECT_EQ(clips[1].path, "/dive/GX020123.MP4");
}

TEST(ListClipsTest, OlderCamerasCallTheFirstChapterOtherwise) {
  EXPECT_EQ(
      NamesOf(OrderClips("", {"GP020042.MP4", "GOPR0043.MP4", "GP010042.MP4", "GOPR0042.MP4"})),
      (Names{"GOPR0042.MP4", "GP010042.MP4", "GP020042.MP4", "GOPR0043.MP4"}));
}

TEST(ListClipsTest, OthersComeAsAPersonCounts) {
  const auto clips = OrderClips("", {"b/dive10.mov", "b/dive9.mov", "a/dive.mp4", "a/dive.mov"});
  EXPECT_EQ(NamesOf(clips), (Names{"a/dive.mov", "a/dive.mp4", "b/dive9.mov", "b/dive10.mov"}));
  EXPECT_EQ(PrefixesOf(clips),
            (Names{"a/dive/dive", "a/dive/dive_2", "b/dive9/dive9", "b/dive10/dive10"}));
}

}  // namespace
}  // namespace colmap_seapoint
