// What a diver brings becomes a folder of pictures, once.
#include "colmap_seapoint/pipeline/intake/take_in.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/expect_error.h"
#include "tests/synthetic/camera_files.h"
#include "tests/synthetic/video_writer.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class TakeIn : public testing::Test {
 protected:
  void SetUp() override { fs::create_directory(Card()); }

  fs::path Card() const { return folder_ / "card"; }
  fs::path Root() const { return folder_ / "ws"; }

  // Returns the folder of the pictures; what was left out is in left_out_.
  fs::path Take(const fs::path& given, const TakeInOptions& options = {}) {
    Workspace workspace(given.string(), Root().string());
    WorkspaceState state(workspace.root, workspace.Names());
    RunReport report;
    left_out_.clear();
    TakeInPictures(options, &workspace, &state, &report);
    for (const auto& left_out : report.left_out) left_out_.push_back(left_out.name);
    return workspace.images;
  }

  // The camera swims along a seabed, 10 pixels a frame.
  void Film(const std::string& name, int num_frames, int begin = 0) const {
    static const GrayImage seabed = MakeSeabed(1600, 300, 11);
    WriteVideo(Card() / name, {}, num_frames,
               [&](int i) { return Crop(seabed, 10 * (begin + i), 20, 320, 180); });
  }

  static GrayImage Photo(uint32_t seed) { return MakeSeabed(128, 96, seed); }

  TemporaryFolder folder_;
  Names left_out_;
};

TEST_F(TakeIn, APictureFolderIsLeftAsItIs) {
  WriteImage(Card() / "a.jpg", Photo(1));
  WriteBytes(Card() / "dive.mp4", "x");
  EXPECT_EQ(Take(Card()), Card());
  EXPECT_FALSE(fs::exists(Root() / "images"));
}

TEST_F(TakeIn, AVideoBecomesFrames) {
  Film("dive.mp4", 50);
  const fs::path images = Take(Card() / "dive.mp4");
  EXPECT_EQ(images, Root() / "images");
  EXPECT_EQ(left_out_, Names());
  const Names frames = ListImages(images);
  EXPECT_NEAR(static_cast<double>(frames.size()), 490 / (0.22 * 320) + 1, 2);
  EXPECT_EQ(frames[0], "dive/dive_000000.jpg");
  const std::string csv = ReadBytes(images / "frames.csv");
  EXPECT_EQ(csv.rfind("frame,clip,seconds,overlap,sharpness,time\n"
                      "dive/dive_000000.jpg,dive.mp4,0.000,0.000,",
                      0),
            0u)
      << csv;
}

TEST_F(TakeIn, ClipsAreDoneOnceAndOthersRemoved) {
  Film("GX010007.MP4", 20);
  Film("GX020007.MP4", 20, 20);
  const auto first = ReadTree(Take(Card()));
  EXPECT_TRUE(first.count("GX010007/GX020007_000000.jpg") > 0);
  // Nothing has changed: not a file is written.
  const fs::path frame = Root() / "images/GX010007/GX010007_000000.jpg";
  const auto time = fs::last_write_time(frame);
  EXPECT_TRUE(ReadTree(Take(Card())) == first);
  EXPECT_EQ(fs::last_write_time(frame), time);
  // Another overlap gives other frames, and those of before are gone.
  TakeInOptions dense;
  dense.frames.overlap = 0.9;
  const auto more = ReadTree(Take(Card(), dense));
  EXPECT_GT(more.size(), first.size());
  EXPECT_TRUE(ReadTree(Take(Card())) == first);
  // A frame that is gone is made again, and a file of the user's stays.
  fs::remove(frame);
  WriteBytes(Root() / "images/mine.txt", "mine");
  Take(Card());
  EXPECT_TRUE(fs::exists(frame));
  EXPECT_TRUE(fs::exists(Root() / "images/mine.txt"));
}

TEST_F(TakeIn, BadClipsAreNamedAndTheRestGoesOn) {
  Film("a.mp4", 20);
  WriteBytes(Card() / "b.mp4", "");
  WriteBytes(Card() / "c.mp4", "no video");
  Film("d.mp4", 60);
  fs::resize_file(Card() / "d.mp4", fs::file_size(Card() / "d.mp4") / 2);
  const Names frames = ListImages(Take(Card()));
  EXPECT_EQ(left_out_, (Names{"b.mp4", "c.mp4", "a part of d.mp4"}));
  EXPECT_EQ(frames.front().substr(0, 4), "a/a_");
  EXPECT_EQ(frames.back().substr(0, 4), "d/d_");
  EXPECT_ERROR(Take(Card() / "b.mp4"), "is empty");
}

TEST_F(TakeIn, HeicAndRawBecomeCopiesBesideLinks) {
  fs::create_directory(Card() / "sub");
  WriteImage(Card() / "sub/a.jpg", Photo(1));
  WriteDng(Card() / "sub/b.dng", Photo(2));
  WriteDng(Card() / "a.dng", Photo(3));
  const bool has_heic = WriteHeic(Card() / "c.heic", Photo(4));
  WriteBytes(Card() / "d.nef", "no picture");
  WriteBytes(Card() / "dive.mp4", "x");
  const fs::path images = Take(Card());
  Names expected = {"a.dng.jpg", "sub/a.jpg", "sub/b.dng.jpg"};
  if (has_heic) expected.insert(expected.begin() + 1, "c.heic.jpg");
  EXPECT_EQ(ListImages(images), expected);
  EXPECT_EQ(left_out_, (Names{"dive.mp4", "d.nef"}));
  EXPECT_EQ(ReadBytes(images / "sub/a.jpg"), ReadBytes(Card() / "sub/a.jpg"));
  EXPECT_TRUE(fs::is_symlink(images / "sub/a.jpg"));

  // Once more without one, and with one changed.
  const auto time = fs::last_write_time(images / "a.dng.jpg");
  const std::string before = ReadBytes(images / "sub/b.dng.jpg");
  WriteDng(Card() / "sub/b.dng", Photo(5));
  fs::remove(Card() / "c.heic");
  Take(Card());
  EXPECT_EQ(ListImages(images), (Names{"a.dng.jpg", "sub/a.jpg", "sub/b.dng.jpg"}));
  EXPECT_EQ(fs::last_write_time(images / "a.dng.jpg"), time);
  EXPECT_NE(ReadBytes(images / "sub/b.dng.jpg"), before);
}

TEST_F(TakeIn, TheUsersOwnImagesFolderIsNotTouched) {
  fs::create_directories(Root() / "images");
  WriteDng(Root() / "images/a.dng", Photo(1));
  WriteImage(Root() / "images/b.jpg", Photo(2));
  const fs::path images = Take(Root() / "images");
  EXPECT_EQ(images, Root() / "pictures");
  EXPECT_EQ(ListImages(images), (Names{"a.dng.jpg", "b.jpg"}));
  EXPECT_EQ(ReadTree(Root() / "images").size(), 2u);
}

}  // namespace
}  // namespace colmap_seapoint
