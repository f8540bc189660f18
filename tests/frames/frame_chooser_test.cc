// Frames chosen from videos of a known motion over a synthetic seabed.
#include "colmap_seapoint/frames/frame_chooser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "colmap_seapoint/frames/extract_frames.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"
#include "tests/synthetic/video_writer.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 480, kHeight = 270;

const GrayImage& Seabed() {
  static const GrayImage seabed = MakeSeabed(3200, 400, 7);
  return seabed;
}

class FrameChooserTest : public testing::Test {
 protected:
  // The camera is at lefts[i] (pixels along the seabed) in frame i; blurs: smear in pixels.
  std::filesystem::path Record(const std::vector<double>& lefts, const std::vector<int>& blurs = {},
                               const VideoSpec& spec = {}) {
    WriteVideo(dir_ / "dive.mp4", spec, static_cast<int>(lefts.size()), [&](int i) {
      const auto at = static_cast<size_t>(i);
      return Crop(Seabed(), lefts[at], 60, kWidth, kHeight, blurs.empty() ? 0 : blurs[at]);
    });
    return dir_ / "dive.mp4";
  }

  std::vector<ChosenFrame> Choose(const std::filesystem::path& path, int num_threads = 1,
                                  FrameSelectionOptions options = {}) {
    VideoFile video(path, num_threads);
    std::vector<ChosenFrame> chosen;
    FrameChooser chooser(options, [&](const ChosenFrame& frame) { chosen.push_back(frame); });
    while (const auto frame = video.Next()) chooser.Add(*frame);
    chooser.Finish();
    return chosen;
  }

  TempDir dir_;
};

double TrueOverlap(double left1, double left2) {
  return std::max(0.0, 1 - std::abs(left2 - left1) / kWidth);
}

TEST_F(FrameChooserTest, EvenMotionGivesAFrameAtEachOverlap) {
  std::vector<double> lefts;
  for (int i = 0; i < 120; ++i) lefts.push_back(10 * i);
  const auto path = Record(lefts);
  for (const double overlap : {0.78, 0.6}) {
    const auto chosen = Choose(path, 1, {overlap});
    // 1190 pixels of motion; a frame every (1 - overlap) x 480 of them.
    const double expected = 1190 / ((1 - overlap) * kWidth);
    EXPECT_NEAR(static_cast<double>(chosen.size()), expected + 1, 2.0);
    for (size_t k = 1; k < chosen.size(); ++k) {
      const double truth = TrueOverlap(lefts[static_cast<size_t>(chosen[k - 1].frame.index)],
                                       lefts[static_cast<size_t>(chosen[k].frame.index)]);
      EXPECT_NEAR(chosen[k].overlap, truth, 0.02) << k;
      if (k + 1 < chosen.size()) {
        EXPECT_NEAR(truth, overlap, 0.09) << k;
      }
    }
  }
}

TEST_F(FrameChooserTest, StandingStillGivesNoFrame) {
  std::vector<double> lefts(90, 100.0);  // three seconds
  for (int i = 0; i < 90; ++i) lefts[static_cast<size_t>(i)] += 3 * std::sin(i * 0.3);  // a hand
  EXPECT_EQ(Choose(Record(lefts)).size(), 1u);
}

TEST_F(FrameChooserTest, TurningBackAndForthInTheSurgeGivesFewFrames) {
  std::vector<double> lefts;
  for (int i = 0; i < 150; ++i) lefts.push_back(300 + 45 * std::sin(i * 0.15));
  // Within 90 pixels of 480, so all overlap by more than 0.81.
  EXPECT_LE(Choose(Record(lefts)).size(), 2u);
}

TEST_F(FrameChooserTest, BlurredStretchIsAvoided) {
  std::vector<double> lefts;
  std::vector<int> blurs;
  for (int i = 0; i < 120; ++i) {
    lefts.push_back(8 * i);
    // A frame is due about every 13th; those around the due places are smeared.
    blurs.push_back(i % 13 >= 11 || i % 13 == 0 ? 15 : 0);
  }
  const auto chosen = Choose(Record(lefts, blurs));
  ASSERT_GT(chosen.size(), 6u);
  int num_blurred = 0;
  for (const ChosenFrame& frame : chosen) {
    // The first frame of all begins a track, whatever it is like.
    if (frame.frame.index > 0) num_blurred += blurs[static_cast<size_t>(frame.frame.index)] > 0;
  }
  EXPECT_EQ(num_blurred, 0);
}

TEST_F(FrameChooserTest, AJumpBeginsATrackAndIsTold) {
  std::vector<double> lefts;
  for (int i = 0; i < 60; ++i) lefts.push_back((i < 30 ? 0 : 1500) + 8 * i);
  const auto chosen = Choose(Record(lefts));
  ASSERT_GT(chosen.size(), 3u);
  int num_begun = 0;
  for (const ChosenFrame& frame : chosen) {
    if (frame.overlap > 0) continue;
    ++num_begun;
    if (num_begun == 2) {
      // Waited for a fifth of a second, in case a fish swims by.
      EXPECT_GE(frame.frame.index, 30);
      EXPECT_LE(frame.frame.index, 38);
    }
  }
  EXPECT_EQ(num_begun, 2);
}

TEST_F(FrameChooserTest, EmptyWaterGivesNoFrame) {
  WriteVideo(dir_ / "blue.mp4", {}, 40, [](int) { return GrayImage(kWidth, kHeight, 1, 90); });
  EXPECT_TRUE(Choose(dir_ / "blue.mp4").empty());
  // Particles: each frame shows others.
  WriteVideo(dir_ / "particles.mp4", {}, 20,
             [](int i) { return MakeSeabed(kWidth, kHeight, static_cast<uint32_t>(100 + i)); });
  EXPECT_LE(Choose(dir_ / "particles.mp4").size(), 1u);
}

TEST_F(FrameChooserTest, OneFrameIsTaken) { EXPECT_EQ(Choose(Record({50})).size(), 1u); }

TEST_F(FrameChooserTest, FastMotionFollowsFrameByFrame) {
  std::vector<double> lefts;
  for (int i = 0; i < 20; ++i) lefts.push_back(120 * i);  // overlap 0.75 from frame to frame
  const auto chosen = Choose(Record(lefts));
  EXPECT_GE(chosen.size(), 19u);
}

TEST_F(FrameChooserTest, VariableRateCountsOverlapNotTime) {
  VideoSpec spec;
  std::vector<double> lefts;
  double seconds = 0;
  for (int i = 0; i < 60; ++i) {
    spec.times.push_back(seconds);
    seconds += i % 7 == 0 ? 0.4 : 0.03;
    lefts.push_back(12 * i);
  }
  const auto chosen = Choose(Record(lefts, {}, spec));
  for (size_t k = 1; k + 1 < chosen.size(); ++k) {
    EXPECT_NEAR(TrueOverlap(lefts[static_cast<size_t>(chosen[k - 1].frame.index)],
                            lefts[static_cast<size_t>(chosen[k].frame.index)]),
                0.78, 0.09);
  }
  EXPECT_NEAR(static_cast<double>(chosen.size()), 708 / (0.22 * kWidth) + 1, 2.0);
}

TEST_F(FrameChooserTest, AnyNumberOfThreadsChoosesTheSame) {
  std::vector<double> lefts;
  for (int i = 0; i < 60; ++i) lefts.push_back(0.2 * i * i);
  const auto path = Record(lefts);
  const auto one = Choose(path, 1), four = Choose(path, 4);
  ASSERT_EQ(one.size(), four.size());
  for (size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].frame.index, four[k].frame.index);
    EXPECT_EQ(one[k].overlap, four[k].overlap);
    EXPECT_EQ(one[k].frame.Color().data, four[k].frame.Color().data);
  }
}

TEST_F(FrameChooserTest, FramesAreWrittenWithTheirTime) {
  std::vector<double> lefts;
  for (int i = 0; i < 40; ++i) lefts.push_back(10 * i);
  VideoSpec spec;
  spec.creation_time = "2023-05-01T10:00:00.000000Z";
  VideoFile video(Record(lefts, {}, spec), 1);
  std::vector<std::string> begun;
  const ExtractedClip clip = ExtractFrames(&video, "dive.mp4", dir_ / "images", "dive/dive", {},
                                           [&](const std::string& name) { begun.push_back(name); });
  ASSERT_GE(clip.frames.size(), 3u);
  EXPECT_EQ(clip.num_frames, 40);
  ASSERT_EQ(begun.size(), clip.frames.size());
  EXPECT_EQ(clip.frames[0].name, "dive/dive_000000.jpg");
  EXPECT_EQ(clip.frames[0].time, "2023-05-01T10:00:00.000");
  for (const ExtractedFrame& frame : clip.frames) {
    const ImageInfo info = ReadImageInfo(dir_ / "images" / frame.name);
    EXPECT_EQ(info.width, kWidth);
    EXPECT_EQ(info.height, kHeight);
  }
  const std::string jpeg = ReadBytes(dir_ / "images" / clip.frames[0].name);
  EXPECT_NE(jpeg.find("2023:05:01 10:00:00"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
