// feature_extractor on pictures that are broken, odd or change.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

class Extractor : public testing::Test {
 protected:
  std::filesystem::path Images() const { return folder_ / "images"; }
  std::filesystem::path Database() const { return folder_ / "database.db"; }

  CliResult Extract(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"feature_extractor", "--database_path",
                                          Database().string(), "--image_path", Images().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }

  nlohmann::json Report() const {
    return nlohmann::json::parse(ReadBytes(Database().string() + ".feature_extractor.run.json"));
  }

  std::string WriteList(const std::string& names) const {
    WriteBytes(folder_ / "list.txt", names + "\n");
    return (folder_ / "list.txt").string();
  }

  ColmapDatabase Open() const { return {Database(), ColmapDatabase::Mode::kReadWrite}; }

  // Exactly these pictures are left out, each for a reason with this word, in the report and on
  // stderr.
  void ExpectLeftOut(const CliResult& result, const std::map<std::string, std::string>& expected) {
    EXPECT_EQ(result.exit_code, 3) << result.Text();
    std::map<std::string, std::string> left_out;
    const nlohmann::json report = Report();
    for (const auto& item : report["left_out"]) left_out[item["name"]] = item["reason"];
    EXPECT_EQ(left_out.size(), expected.size()) << result.Text();
    for (const auto& [name, word] : expected) {
      EXPECT_NE(left_out[name].find(word), std::string::npos) << name << ": " << left_out[name];
      EXPECT_NE(result.err.find(name + " is left out: " + left_out[name]), std::string::npos)
          << result.Text();
    }
  }

  TemporaryFolder folder_;
};

// Between the start of a JPEG and its first segment: an EXIF block with nothing but the
// orientation.
std::string WithOrientation(const std::string& jpeg, char orientation) {
  std::string exif("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 24);
  exif += orientation;
  exif += std::string("\0\0\0\0\0\0\0", 7);
  const size_t length = exif.size() + 2;
  std::string segment = "\xff\xe1";
  segment += static_cast<char>(length >> 8);
  segment += static_cast<char>(length & 255);
  return jpeg.substr(0, 2) + segment + exif + jpeg.substr(2);
}

TEST_F(Extractor, FindsPicturesInSubFolders) {
  WriteStrip(Images(), 2);
  WriteStrip(Images() / "dive 1" / "left", 2, "b");
  const CliResult result = Extract();
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(result.out, "");
  const ColmapDatabase database = Open();
  const auto images = ReadImages(database);
  ASSERT_EQ(images.size(), 4u);
  EXPECT_EQ(images[0].name, "dive 1/left/b1.png");
  EXPECT_EQ(images[3].name, "img2.png");
  EXPECT_EQ(images[0].camera_id, images[1].camera_id);
  EXPECT_NE(images[0].camera_id, images[2].camera_id);  // one camera a folder
  for (const DatabaseImage& image : images) {
    EXPECT_GT(ReadFeatures(database, image.image_id).value().points.size(), 500u);
  }
  const Camera camera = ReadCameras(database).at(1);
  EXPECT_EQ(camera.model, CameraModel::kOpenCV);
  EXPECT_FALSE(camera.has_prior_focal_length);
  EXPECT_DOUBLE_EQ(camera.FocalX(), 1.2 * kStripWidth);
  const nlohmann::json report = Report();
  EXPECT_EQ(report["images_in"], 4);
  EXPECT_EQ(report["images_used"], 4);
  EXPECT_EQ(report["command"], "feature_extractor");
  EXPECT_EQ(report["inputs"].size(), 4u);
  EXPECT_EQ(report["inputs"][3]["hash"], HashFile(Images() / "img2.png"));
  EXPECT_GT(report["peak_rss_bytes"].get<uint64_t>(), 1000000u);
}

TEST_F(Extractor, CameraOptionsAreColmaps) {
  WriteStrip(Images(), 2);
  WriteStrip(Images() / "b", 1);
  ASSERT_EQ(Extract({"--ImageReader.single_camera", "1", "--ImageReader.camera_model", "PINHOLE",
                     "--ImageReader.camera_params", "500,501,200,150"})
                .exit_code,
            0);
  {
    const auto cameras = ReadCameras(Open());
    ASSERT_EQ(cameras.size(), 1u);
    EXPECT_TRUE(cameras.at(1).has_prior_focal_length);
    EXPECT_EQ(cameras.at(1).params, (std::vector<double>{500, 501, 200, 150}));
  }
  std::filesystem::remove(Database());
  ASSERT_EQ(Extract({"--ImageReader.single_camera_per_folder", "0"}).exit_code, 0);
  EXPECT_EQ(ReadCameras(Open()).size(), 3u);
}

TEST_F(Extractor, TakesTheListedPicturesOnly) {
  WriteStrip(Images(), 3);
  WriteBytes(folder_ / "list.txt", "# two of three\nimg3.png\n\nimg1.png\nimg3.png\n");
  ASSERT_EQ(Extract({"--image_list_path", (folder_ / "list.txt").string()}).exit_code, 0);
  EXPECT_EQ(ReadImages(Open()).size(), 2u);
  WriteBytes(folder_ / "list.txt", "img1.png\n../img2.png\n");
  const CliResult result = Extract({"--image_list_path", (folder_ / "list.txt").string()});
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("../img2.png"), std::string::npos) << result.Text();
  WriteBytes(folder_ / "list.txt", "img1.png\nabsent.png\n");
  ExpectLeftOut(Extract({"--image_list_path", (folder_ / "list.txt").string()}),
                {{"absent.png", "No such file"}});
}

TEST_F(Extractor, SaysWhenThereIsNothingToDo) {
  CliResult result = Extract();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(Images().string()), std::string::npos) << result.Text();
  std::filesystem::create_directories(Images());
  result = Extract();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(Images().string()), std::string::npos) << result.Text();
  WriteBytes(Images() / "notes.txt", "no picture");
  EXPECT_EQ(Extract().exit_code, 1);
  WriteBytes(Images() / "a.jpg", "");
  result = Extract();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("a.jpg"), std::string::npos) << result.Text();
  EXPECT_FALSE(std::filesystem::exists(Database()));
}

TEST_F(Extractor, LeavesOutWhatIsBrokenAndGoesOn) {
  WriteStrip(Images(), 2);
  WriteImage(Images() / "whole.jpg", StripPicture(3));
  const std::string jpeg = ReadBytes(Images() / "whole.jpg");
  const std::string png = ReadBytes(Images() / "img1.png");
  WriteBytes(Images() / "half.jpg", jpeg.substr(0, jpeg.size() / 2));
  WriteBytes(Images() / "half.png", png.substr(0, png.size() / 2));
  WriteBytes(Images() / "zero.jpg", "");
  WriteBytes(Images() / "text.tif", "I am no picture, whatever my name says.");
  WriteImage(Images() / "flat.png", ColorImage(kStripWidth, kStripHeight, 3, 90));
  const CliResult result = Extract();
  ExpectLeftOut(result, {{"half.jpg", "whole"},
                         {"half.png", "whole"},
                         {"zero.jpg", "empty"},
                         {"text.tif", "no picture"},
                         {"flat.png", "no SeaPoint"}});
  EXPECT_EQ(Report()["images_used"], 3);
  {
    const ColmapDatabase database = Open();
    for (const DatabaseImage& image : ReadImages(database)) {
      // An empty row: otherwise COLMAP's own extractor would add SIFT to it.
      EXPECT_TRUE(HasFeatures(database, image.image_id)) << image.name;
    }
  }
  // Once more: the same answer.
  const CliResult again = Extract();
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_EQ(Report()["left_out"].size(), 5u);
  EXPECT_EQ(Report()["images_used"], 3);
  // Repaired: taken in.
  WriteBytes(Images() / "half.jpg", jpeg);
  std::filesystem::remove(Images() / "half.png");
  std::filesystem::remove(Images() / "zero.jpg");
  std::filesystem::remove(Images() / "text.tif");
  std::filesystem::remove(Images() / "flat.png");
  const CliResult repaired = Extract();
  EXPECT_EQ(repaired.exit_code, 0) << repaired.Text();
  EXPECT_EQ(Report()["images_used"], 4);
}

TEST_F(Extractor, MixedSizesGetTheirOwnCameras) {
  WriteStrip(Images(), 2);
  ColorImage narrow(200, kStripHeight, 3);
  const ColorImage whole = StripPicture(4);
  for (int y = 0; y < narrow.height; ++y) {
    std::copy(whole.Row(y), whole.Row(y) + narrow.Stride(), narrow.Row(y));
  }
  WriteImage(Images() / "narrow.png", narrow);
  ASSERT_EQ(Extract().exit_code, 0);
  EXPECT_EQ(ReadCameras(Open()).size(), 2u);
  std::filesystem::remove(Database());
  ExpectLeftOut(Extract({"--ImageReader.single_camera", "1"}), {{"narrow.png", "200x300"}});
}

TEST_F(Extractor, ExifRotationIsOneWarning) {
  WriteStrip(Images(), 1);
  WriteImage(folder_ / "upright.jpg", StripPicture(2));
  const std::string jpeg = ReadBytes(folder_ / "upright.jpg");
  WriteBytes(Images() / "turned1.jpg", WithOrientation(jpeg, 6));
  WriteBytes(Images() / "turned2.jpg", WithOrientation(jpeg, 3));
  const CliResult result = Extract();
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  const size_t warning = result.err.find("warning: 2 pictures are stored turned");
  EXPECT_NE(warning, std::string::npos) << result.Text();
  EXPECT_EQ(result.err.find("warning: ", warning + 1), std::string::npos) << result.Text();
  // As stored: 400 wide, not 300.
  for (const auto& [id, camera] : ReadCameras(Open())) EXPECT_EQ(camera.width, kStripWidth);
}

TEST_F(Extractor, SkipsWhatIsUnchangedAndRedoesWhatChanged) {
  WriteStrip(Images(), 3);
  ASSERT_EQ(Extract().exit_code, 0);
  CliResult result = Extract();
  EXPECT_NE(result.err.find("3 pictures were there already"), std::string::npos) << result.Text();
  {
    ColmapDatabase database = Open();
    TwoViewGeometry geometry;
    geometry.config = TwoViewConfig::kUncalibrated;
    geometry.inliers = {{0, 0}};
    WriteMatches(&database, 1, 2, {{0, 0}}, geometry);
    WriteMatches(&database, 2, 3, {{0, 0}}, geometry);
  }
  WriteImage(Images() / "img1.png", StripPicture(9));
  result = Extract();
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("2 pictures were there already"), std::string::npos) << result.Text();
  {
    const ColmapDatabase database = Open();
    EXPECT_FALSE(HasMatches(database, {1, 2}));  // of the changed picture
    EXPECT_TRUE(HasMatches(database, {2, 3}));
  }
  result = Extract({"--SeaPointExtraction.min_num_features", "100",
                    "--SeaPointExtraction.max_num_features", "200"});
  EXPECT_EQ(result.err.find("there already"), std::string::npos) << result.Text();
  EXPECT_LE(ReadFeatures(Open(), 2).value().points.size(), 200u);
}

// Another descriptor is another option: everything is extracted again, and a mixed database works.
TEST_F(Extractor, EitherDescriptor) {
  WriteStrip(Images(), 3);
  ColorImage darker = StripPicture(1);  // so that hardly two rBRIEF descriptors are the same
  for (uint8_t& level : darker.data) level = static_cast<uint8_t>(level * level / 255);
  WriteImage(Images() / "img2.png", darker);
  const std::string option = "--SeaPointExtraction.descriptor";
  EXPECT_EQ(Extract({option, "surf"}).exit_code, 2);
  ASSERT_EQ(Extract({option, "rbrief"}).exit_code, 0);
  EXPECT_TRUE(ReadFeatures(Open(), 1).value().sift_descriptors.empty());
  CliResult result =
      Extract({option, "sift", "--image_list_path", WriteList("img1.png\nimg2.png")});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(result.err.find("there already"), std::string::npos) << result.Text();
  {
    const ColmapDatabase database = Open();
    for (const uint32_t id : {1u, 2u}) {
      const Features features = ReadFeatures(database, id).value();
      EXPECT_EQ(features.sift_descriptors.size(), features.points.size());
    }
    EXPECT_TRUE(ReadFeatures(database, 3).value().sift_descriptors.empty());
  }
  // Nothing is left to match rBRIEF by: only the pair that has SIFT is matched.
  result = RunProgram(SEAPOINT_PROGRAM,
                      {"exhaustive_matcher", "--database_path", Database().string(),
                       "--SeaPointMatching.max_distance", "0", "--SeaPointMatching.guided", "0"});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_GT(ReadMatches(Open(), {1, 2}).size(), 200u);
  EXPECT_LT(ReadMatches(Open(), {2, 3}).size(), 20u);
  ASSERT_EQ(Extract({option, "sift"}).exit_code, 0);
  result =
      RunProgram(SEAPOINT_PROGRAM, {"sequential_matcher", "--database_path", Database().string()});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_GT(ReadTwoViewGeometry(Open(), {2, 3}).inliers.size(), 200u);
}

TEST_F(Extractor, MasksKeepSeaPointsAway) {
  WriteStrip(Images(), 3);
  Image<uint8_t> mask(kStripWidth, kStripHeight, 1, 255);
  for (int y = 0; y < mask.height; ++y) std::fill(mask.Row(y), mask.Row(y) + 200, uint8_t{0});
  std::filesystem::create_directories(folder_ / "masks");
  WriteImage(folder_ / "masks" / "img1.png.png", mask);
  WriteImage(folder_ / "masks" / "img3.png.png", Image<uint8_t>(10, 10, 1, 255));
  const CliResult result = Extract({"--ImageReader.mask_path", (folder_ / "masks").string()});
  ExpectLeftOut(result, {{"img3.png", "mask"}});
  const ColmapDatabase database = Open();
  float leftmost[2] = {1e9f, 1e9f};
  for (uint32_t id : {1u, 2u}) {
    const Features features = ReadFeatures(database, id).value();
    for (const SeaPoint& point : features.points) {
      leftmost[id - 1] = std::min(leftmost[id - 1], point.x);
    }
  }
  EXPECT_GE(leftmost[0], 200);
  EXPECT_LT(leftmost[1], 100);
  EXPECT_EQ(Extract({"--ImageReader.mask_path", (folder_ / "absent").string()}).exit_code, 1);
}

TEST_F(Extractor, SameDatabaseForAnyNumberOfThreads) {
  WriteStrip(Images(), 6);
  ASSERT_EQ(Extract({"--num_threads", "1"}).exit_code, 0);
  std::vector<Features> one;
  {
    const ColmapDatabase database = Open();
    for (uint32_t id = 1; id <= 6; ++id) one.push_back(ReadFeatures(database, id).value());
  }
  std::filesystem::remove(Database());
  ASSERT_EQ(Extract({"--num_threads", "3"}).exit_code, 0);
  const ColmapDatabase database = Open();
  for (uint32_t id = 1; id <= 6; ++id) {
    EXPECT_EQ(ReadFeatures(database, id).value().descriptors, one[id - 1].descriptors);
  }
}

}  // namespace
}  // namespace colmap_seapoint
