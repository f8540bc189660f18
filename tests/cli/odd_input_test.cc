// What divers bring that is not as it should be, through the built program: one clear line each,
// and the rest goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <exiv2/exiv2.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"
#include "tests/synthetic/camera_files.h"
#include "tests/synthetic/video_writer.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 6;
constexpr double kMetresPerDegree = 111195;  // along a meridian

std::string Printed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

class OddInput : public testing::Test {
 protected:
  void SetUp() override { WriteStrip(Pictures(), kNumPictures); }

  fs::path Pictures() const { return folder_ / "images"; }
  fs::path Workspace() const { return folder_ / "workspace"; }
  fs::path PictureAt(int i) const { return Pictures() / ("img" + std::to_string(i) + ".png"); }

  CliResult Reconstruct(std::vector<std::string> more = {}) const {
    more.insert(more.begin(),
                {"automatic_reconstructor", "--image_path", Pictures().string(), "--workspace_path",
                 Workspace().string(), "--colmap_path", FAKE_COLMAP});
    return RunProgram(SEAPOINT_PROGRAM, more);
  }

  // Name -> reason.
  std::map<std::string, std::string> LeftOut() const {
    std::map<std::string, std::string> left_out;
    const auto report = nlohmann::json::parse(ReadBytes(Workspace() / "report" / "run.json"));
    for (const auto& item : report["left_out"]) left_out[item["name"]] = item["reason"];
    return left_out;
  }

  // A position of picture i, a metre from the next one to the east at latitude 0, in XMP alone,
  // with a depth; or as EXIF has it.
  void Place(int i, double latitude, bool in_xmp) const {
    const auto image = Exiv2::ImageFactory::open(PictureAt(i).string());
    image->readMetadata();
    const double longitude = 5 + i / kMetresPerDegree;
    if (in_xmp) {
      Exiv2::XmpParser::initialize();
      image->xmpData()["Xmp.exif.GPSLatitude"] = "0," + Printed("%.8fN", 60 * latitude);
      image->xmpData()["Xmp.exif.GPSLongitude"] = "5," + Printed("%.8fE", 60 * (longitude - 5));
      Exiv2::XmpProperties::registerNs("http://depth/", "depth");
      image->xmpData()["Xmp.depth.WaterDepth"] = "12.5";
    } else {
      image->exifData()["Exif.GPSInfo.GPSLatitude"] =
          Printed("%.0f/1000000000 0/1 0/1", 1e9 * latitude);
      image->exifData()["Exif.GPSInfo.GPSLongitude"] =
          latitude == 0 ? "0/1 0/1 0/1" : Printed("%.0f/100000000 0/1 0/1", 1e8 * longitude);
      image->exifData()["Exif.GPSInfo.GPSAltitude"] = "1/1";
    }
    image->writeMetadata();
  }

  // A log of one dive with the pictures' times beside it: a metre a second, with a turn.
  void WriteLog(const std::string& name, int day, const std::string& header,
                const std::string& separator, bool has_commas) const {
    std::string log = header + "\n", times = "image,time\n";
    for (int i = -5; i < 15; ++i) {
      std::string x = Printed("%.2f", std::max(i, 0)), y = Printed("%.2f", std::min(i, 0));
      std::string time =
          "2024-05-" + Printed("%02.0f", day) + " 12:00:" + Printed("%04.1f", 20 + i);
      for (std::string* text : {&x, &y, &time}) {
        if (has_commas) (*text)[text->rfind('.')] = ',';
      }
      log += time + separator + x + separator + y + "\n";
      if (i < 1 || i > kNumPictures) continue;
      times +=
          PictureAt(i).filename().string() + ",2024-05-01 12:00:" + std::to_string(20 + i) + "\n";
    }
    WriteBytes(folder_ / name, log);
    WriteBytes(folder_ / "times.csv", times);
  }

  std::vector<std::string> WithLog(const std::string& names) const {
    return {"--nav", names, "--nav_times", (folder_ / "times.csv").string(), "--nav_offset", "0"};
  }

  TemporaryFolder folder_;
};

TEST_F(OddInput, GpsOfZeroZeroAndOneFarOff) {
  for (int i = 1; i <= kNumPictures; ++i) Place(i, i == 2 ? 0 : i == 5 ? 0.012 : 0.01, false);
  const CliResult result = Reconstruct();
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("of 1 pictures is latitude 0, longitude 0"), std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("positions 4 of 5"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("not img5.png: 22"), std::string::npos) << result.out;
}

TEST_F(OddInput, PositionsInXmpAlone) {
  for (int i = 1; i <= kNumPictures; ++i) Place(i, 0.01, true);
  const CliResult result = Reconstruct();
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("positions 6 of 6"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("heights from the depth in EXIF or XMP"), std::string::npos)
      << result.out;
}

TEST_F(OddInput, ALogWithSemicolonsAndDecimalCommas) {
  WriteLog("log.csv", 1, "time;x;y", ";", true);
  const CliResult result = Reconstruct(WithLog((folder_ / "log.csv").string()));
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("positions 6 of 6"), std::string::npos) << result.out;
}

TEST_F(OddInput, ALogOfAnotherDayIsLeftOut) {
  WriteLog("log.csv", 9, "time,x,y", ",", false);
  auto arguments = WithLog((folder_ / "log.csv").string());
  arguments.resize(4);
  const CliResult result = Reconstruct(arguments);
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  const auto left_out = LeftOut();
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_NE(left_out.begin()->second.find("of another time"), std::string::npos);
  EXPECT_TRUE(fs::exists(Workspace() / "dense/0/fused.ply"));
}

// Which of two is right only their owner knows: said before any work.
TEST_F(OddInput, TwoLogsOfOneTime) {
  WriteLog("a.csv", 1, "time,x,y", ",", false);
  WriteLog("b.csv", 1, "time,x,y", ",", false);
  const CliResult result =
      Reconstruct(WithLog((folder_ / "a.csv").string() + "," + (folder_ / "b.csv").string()));
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("b.csv: overlaps in time with the log before it"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(Workspace() / "database.db"));
}

TEST_F(OddInput, MasksOfAnotherSize) {
  fs::create_directories(folder_ / "masks");
  WriteImage(folder_ / "masks/img1.png.png", GrayImage(kStripWidth / 2, kStripHeight / 2, 1, 255));
  WriteImage(folder_ / "masks/img2.png.png", GrayImage(kStripWidth / 2, kStripHeight, 1, 255));
  Reconstruct({"--ImageReader.mask_path", (folder_ / "masks").string()});
  const auto left_out = LeftOut();
  ASSERT_EQ(left_out.count("img2.png"), 1u);
  EXPECT_EQ(left_out.size(), 1u);
  EXPECT_NE(left_out.at("img2.png").find("its mask is of another size"), std::string::npos);
}

TEST_F(OddInput, LinkedFoldersAreSaid) {
  fs::create_directories(Pictures() / "deeper");
  fs::create_directory_symlink(Pictures(), Pictures() / "deeper" / "up");
  fs::create_symlink(folder_ / "unplugged", Pictures() / "disk");
  const CliResult result = Reconstruct();
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.err.find("deeper/up is a link to a folder that is read anyway"),
            std::string::npos);
  EXPECT_NE(LeftOut().at("disk").find("leads nowhere"), std::string::npos);
}

// As where libheif's plugin for HEVC is not installed: a codec that there is not.
TEST_F(OddInput, HeicWithoutItsCodecAndACutOne) {
  if (!WriteHeic(Pictures() / "a.heic", MakeSeabed(128, 96, 3))) GTEST_SKIP() << "no encoder";
  std::string bytes = ReadBytes(Pictures() / "a.heic");
  fs::remove(Pictures() / "a.heic");
  WriteBytes(Pictures() / "cut.heic", bytes.substr(0, bytes.size() / 2));
  for (size_t at = bytes.find("hvc1"); at != std::string::npos; at = bytes.find("hvc1", at)) {
    bytes.replace(at, 4, "vvc1");
  }
  WriteBytes(Pictures() / "strange.heic", bytes);
  const CliResult result = Reconstruct();
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  const auto left_out = LeftOut();
  ASSERT_EQ(left_out.size(), 2u);
  EXPECT_NE(left_out.at("strange.heic").find("cannot be decoded here"), std::string::npos);
  EXPECT_NE(left_out.at("cut.heic").find("cannot be decoded whole"), std::string::npos);
}

// No frame that the mapper's stand-in knows comes of it: what is said is looked at.
TEST_F(OddInput, VideosThatAreCutTurnedOrNone) {
  fs::remove_all(Pictures());
  fs::create_directories(Pictures());
  const GrayImage seabed = MakeSeabed(700, 300, 11);
  VideoSpec turned;
  turned.rotation_deg = 90;
  turned.times = {0, 0.03, 0.06, 0.5, 0.9, 1.5, 1.6, 1.7, 1.8, 2};  // of a variable rate
  WriteVideo(Pictures() / "a.mp4", turned, 10,
             [&](int i) { return Crop(seabed, 20 * i, 20, 320, 180); });
  const std::string bytes = ReadBytes(Pictures() / "a.mp4");
  WriteBytes(Pictures() / "cut.mp4", bytes.substr(0, bytes.size() / 2));
  WriteBytes(Pictures() / "text.mp4", "no video\n");
  const CliResult result = Reconstruct();
  EXPECT_NE(result.err.find("a.mp4: "), std::string::npos) << result.Text();
  EXPECT_NE(result.err.find("(180x320)"), std::string::npos) << result.Text();
  EXPECT_NE(result.err.find("a part of cut.mp4 is left out: can be read for"), std::string::npos)
      << result.Text();
  EXPECT_NE(result.err.find("text.mp4 is left out: is no video that can be opened"),
            std::string::npos)
      << result.Text();
}

}  // namespace
}  // namespace colmap_seapoint
