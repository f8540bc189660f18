// Videos of known frames, turned, of odd times, damaged, and files that are none.
#include "colmap_seapoint/io/video/video_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <vector>

#include "tests/io/test_files.h"
#include "tests/synthetic/video_writer.h"

namespace colmap_seapoint {
namespace {

// A white square on grey, whose place says which way is up: in the upper left quarter.
GrayImage Marked(int width, int height) {
  GrayImage image(width, height, 1, 100);
  for (int y = 8; y < 24; ++y) {
    for (int x = 8; x < 24; ++x) image.At(x, y) = 230;
  }
  return image;
}

std::vector<VideoFrame> AllFrames(VideoFile* video) {
  std::vector<VideoFrame> frames;
  while (const auto frame = video->Next()) frames.push_back(*frame);
  return frames;
}

class VideoFileTest : public testing::Test {
 protected:
  std::filesystem::path Write(const VideoSpec& spec, int num_frames, const std::string& name) {
    WriteVideo(dir_ / name, spec, num_frames, [](int) { return Marked(96, 64); });
    return dir_ / name;
  }
  TempDir dir_;
};

TEST_F(VideoFileTest, FramesComeInOrderWithTheirTimes) {
  VideoSpec spec;
  spec.creation_time = "2023-05-01T10:00:00.000000Z";
  VideoFile video(Write(spec, 45, "a.mp4"), 2);
  EXPECT_EQ(video.Info().width, 96);
  EXPECT_EQ(video.Info().height, 64);
  EXPECT_NEAR(video.Info().duration_seconds, 1.5, 0.05);
  EXPECT_EQ(video.Info().start_time_us.value_or(0), 1682935200000000);
  const auto frames = AllFrames(&video);
  ASSERT_EQ(frames.size(), 45u);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].index, static_cast<int64_t>(i));
    EXPECT_NEAR(frames[i].seconds, static_cast<double>(i) / 30, 1e-3);
  }
  EXPECT_EQ(video.Shortfall(), "");
  // Limited range is widened: what was 100 and 230 is so again.
  const GrayImage gray = frames[3].Gray();
  EXPECT_NEAR(gray.At(16, 16), 230, 4);
  EXPECT_NEAR(gray.At(80, 50), 100, 4);
  const ColorImage color = frames[3].Color();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color.At(16, 16, c), 230, 4);
}

TEST_F(VideoFileTest, VariableFrameRateKeepsItsTimes) {
  VideoSpec spec;
  for (int i = 0; i < 20; ++i) spec.times.push_back(0.01 * i * i);
  VideoFile video(Write(spec, 20, "a.mkv"), 1);
  const auto frames = AllFrames(&video);
  ASSERT_EQ(frames.size(), 20u);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_NEAR(frames[i].seconds, spec.times[i], 2e-3);
  }
}

TEST_F(VideoFileTest, IsTurnedUpright) {
  for (const int turn : {90, 180, 270}) {
    VideoSpec spec;
    spec.rotation_deg = turn;
    VideoFile video(Write(spec, 2, std::to_string(turn) + ".mp4"), 1);
    const bool is_sideways = turn != 180;
    EXPECT_EQ(video.Info().width, is_sideways ? 64 : 96);
    const auto frame = video.Next();
    ASSERT_TRUE(frame);
    const ColorImage color = frame->Color();
    ASSERT_EQ(color.width, video.Info().width);
    ASSERT_EQ(color.height, video.Info().height);
    // The square's corner of the stored frame goes clockwise with each quarter turn.
    const int x = turn == 270 ? 16 : color.width - 16;
    const int y = turn == 90 ? 16 : color.height - 16;
    EXPECT_NEAR(color.At(x, y), 230, 6) << turn;
    EXPECT_NEAR(frame->Gray().At(x, y), 230, 6) << turn;
  }
}

TEST_F(VideoFileTest, TenBitsBecomeEight) {
  VideoSpec spec;
  spec.is_10_bit = true;
  VideoFile video(Write(spec, 3, "a.mkv"), 1);
  const auto frames = AllFrames(&video);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_NEAR(frames[0].Gray().At(16, 16), 230, 3);
  EXPECT_NEAR(frames[0].Color().At(80, 50), 100, 3);
}

TEST_F(VideoFileTest, OfAnInterlacedFrameOneFieldIsSeen) {
  VideoSpec spec;
  spec.is_interlaced = true;
  // The fields are of two moments: the second one is dark.
  WriteVideo(dir_ / "a.mp4", spec, 3, [](int) {
    GrayImage image(96, 64, 1, 200);
    for (int y = 1; y < 64; y += 2) std::fill(image.Row(y), image.Row(y) + 96, uint8_t{40});
    return image;
  });
  VideoFile video(dir_ / "a.mp4", 1);
  const auto frame = video.Next();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->IsInterlaced());
  for (const int y : {20, 21, 22, 23}) EXPECT_NEAR(frame->Color().At(50, y), 200, 12) << y;
}

TEST_F(VideoFileTest, CutFileGivesWhatIsThere) {
  const auto path = Write({}, 90, "a.mp4");
  const auto size = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, size * 6 / 10);
  std::vector<size_t> counts;
  for (const int num_threads : {1, 4}) {
    VideoFile video(path, num_threads);
    counts.push_back(AllFrames(&video).size());
    EXPECT_NE(video.Shortfall().find("of 3.0 s only"), std::string::npos) << video.Shortfall();
  }
  EXPECT_GT(counts[0], 20u);
  EXPECT_LT(counts[0], 80u);
  EXPECT_EQ(counts[0], counts[1]);
}

TEST_F(VideoFileTest, DamageIsPassedOver) {
  const GrayImage seabed = MakeSeabed(400, 200, 5);
  const auto path = dir_ / "a.mkv";
  WriteVideo(path, {}, 90, [&](int i) { return Crop(seabed, i, 0, 320, 180); });
  std::string bytes = ReadBytes(path);
  for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 3000; ++i) bytes[i] = 0x55;
  std::ofstream(path, std::ios::binary) << bytes;
  std::vector<std::vector<int64_t>> times;
  for (const int num_threads : {1, 4}) {
    VideoFile video(path, num_threads);
    times.emplace_back();
    for (const VideoFrame& frame : AllFrames(&video)) {
      times.back().push_back(std::llround(frame.seconds * 1000));
    }
  }
  EXPECT_GT(times[0].size(), 30u);
  EXPECT_LE(times[0].size(), 90u);
  EXPECT_EQ(times[0], times[1]);
}

TEST_F(VideoFileTest, WhatIsNoVideoIsRefused) {
  std::ofstream(dir_ / "empty.mp4");
  EXPECT_ERROR(VideoFile(dir_ / "empty.mp4", 1), "is empty");
  std::ofstream(dir_ / "text.mp4") << "this is no video, whatever it is called";
  EXPECT_ERROR(VideoFile(dir_ / "text.mp4", 1), "is no video that can be opened");
  WriteSound(dir_ / "sound.mkv");
  EXPECT_ERROR(VideoFile(dir_ / "sound.mkv", 1), "no pictures");
  EXPECT_ERROR(VideoFile(dir_ / "missing.mp4", 1), "missing.mp4");
  // The index stands at the end, and was never written.
  const auto path = Write({}, 30, "a.mp4");
  std::filesystem::resize_file(path, 40);
  EXPECT_ERROR(VideoFile(path, 1), "cut off");
}

}  // namespace
}  // namespace colmap_seapoint
