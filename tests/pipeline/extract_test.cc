#include "colmap_seapoint/pipeline/extract.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/database_tables.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr int kNumPictures = 3;

class Extract : public StripSurvey {
 protected:
  void SetUp() override { WritePictures(kNumPictures); }

  RunReport Run(const FeatureExtractorOptions& options,
                const std::set<std::string>& second_chance_names = {}) const {
    const PictureSet pictures = ReadPictureSet(options);
    ColmapDatabase database = OpenDatabase();
    return ExtractPictures(options, pictures, second_chance_names, &database);
  }
  RunReport Run() const { return Run(ExtractorOptions()); }

  Features FeaturesOf(const std::string& name) const {
    const ColmapDatabase database = OpenDatabase();
    const auto features = ReadFeatures(database, ImageIds(database).at(name));
    EXPECT_TRUE(features.has_value()) << name;
    return features.value_or(Features());
  }
  std::map<std::string, std::string> Fingerprints() const {
    std::map<std::string, std::string> fingerprints;
    const ColmapDatabase database = OpenDatabase();
    for (const auto& [name, id] : ImageIds(database)) {
      fingerprints[name] = FeaturesFingerprint(database, id).value_or("none");
    }
    return fingerprints;
  }
  // Names whose fingerprints differ.
  static Names Changed(const std::map<std::string, std::string>& before,
                       const std::map<std::string, std::string>& after) {
    Names names;
    for (const auto& [name, fingerprint] : after) {
      const auto known = before.find(name);
      if (known == before.end() || known->second != fingerprint) names.push_back(name);
    }
    return names;
  }

  // Puts one SeaPoint in the place of those of a picture; true as long as they were not found anew.
  void Mark(const std::string& name) const {
    ColmapDatabase database = OpenDatabase();
    const uint32_t id = ImageIds(database).at(name);
    Features one = *ReadFeatures(database, id);
    one.points.resize(1);
    one.descriptors.resize(1);
    WriteFeatures(&database, id, one, *FeaturesFingerprint(database, id));
  }
  bool IsMarked(const std::string& name) const { return FeaturesOf(name).points.size() == 1; }
};

TEST_F(Extract, WritesSeaPointsAndTheReport) {
  const RunReport report = Run();
  EXPECT_EQ(report.command, "feature_extractor");
  EXPECT_EQ(report.images_in, kNumPictures);
  EXPECT_EQ(report.images_used, kNumPictures);
  EXPECT_TRUE(report.left_out.empty());
  ASSERT_EQ(report.inputs.size(), 3u);
  EXPECT_EQ(report.inputs[1].name, "img2.png");
  EXPECT_EQ(report.inputs[1].size, fs::file_size(Images() / "img2.png"));
  ASSERT_EQ(report.stages.size(), 1u);
  for (const char* name : {"img1.png", "img2.png", "img3.png"}) {
    const Features features = FeaturesOf(name);
    EXPECT_GE(features.points.size(), 400u) << name;
    EXPECT_LE(features.points.size(), 500u) << name;
    EXPECT_EQ(features.descriptors.size(), features.points.size()) << name;
  }
  const auto json =
      nlohmann::json::parse(ReadBytes(DatabasePath().string() + ".feature_extractor.run.json"));
  EXPECT_EQ(json["images_used"], kNumPictures);
  EXPECT_EQ(json["options"]["SeaPointExtraction.max_num_features"], "500");
}

TEST_F(Extract, TheCommandSaysWhetherAllPicturesAreIn) {
  EXPECT_TRUE(RunFeatureExtractor(ExtractorOptions()).is_complete);
  WriteBytes(Images() / "zero.png", "");
  EXPECT_FALSE(RunFeatureExtractor(ExtractorOptions()).is_complete);
}

TEST_F(Extract, ThePictureSetNamesWhatCannotBeRead) {
  WriteBytes(Images() / "sub/zero.png", "");
  WriteBytes(Images() / "notes.txt", "no picture");
  const PictureSet pictures = ReadPictureSet(ExtractorOptions());
  ASSERT_EQ(pictures.readable.size(), 3u);
  EXPECT_EQ(pictures.readable[2].name, "img3.png");
  EXPECT_EQ(pictures.readable[2].info.width, kStripWidth);
  EXPECT_EQ(pictures.readable[2].info.height, kStripHeight);
  EXPECT_EQ(pictures.num_listed, 4);
  EXPECT_EQ(NamesOf(pictures.left_out), Names{"sub/zero.png"});
  EXPECT_FALSE(pictures.left_out[0].reason.empty());
  // What was left out of the set is left out of the report.
  const RunReport report = Run();
  EXPECT_EQ(report.images_in, 4);
  EXPECT_EQ(report.images_used, 3);
  EXPECT_EQ(NamesOf(report.left_out), Names{"sub/zero.png"});
}

TEST_F(Extract, AListChooses) {
  FeatureExtractorOptions options = ExtractorOptions();
  options.image_list_path = Write("list.txt", "img3.png\nimg1.png\nabsent.png\n");
  const PictureSet pictures = ReadPictureSet(options);
  ASSERT_EQ(pictures.readable.size(), 2u);
  EXPECT_EQ(pictures.readable[0].name, "img1.png");
  EXPECT_EQ(pictures.readable[1].name, "img3.png");
  EXPECT_EQ(NamesOf(pictures.left_out), Names{"absent.png"});
}

TEST_F(Extract, NoReadablePictureIsAnError) {
  fs::remove_all(Images());
  WriteBytes(Images() / "a.png", "");
  WriteBytes(Images() / "b.png", "text");
  const std::string error = ErrorOf([&] { ReadPictureSet(ExtractorOptions()); });
  EXPECT_NE(error.find("none of its 2 pictures can be used (a.png: "), std::string::npos) << error;
  EXPECT_FALSE(fs::exists(DatabasePath()));
  const auto json =
      nlohmann::json::parse(ReadBytes(DatabasePath().string() + ".feature_extractor.run.json"));
  EXPECT_EQ(json["left_out"].size(), 2u);
}

TEST_F(Extract, NoTextureInAnyPictureIsAnError) {
  fs::remove_all(Images());
  fs::create_directories(Images());
  WriteImage(Images() / "flat.png", ColorImage(kStripWidth, kStripHeight, 3, 90));
  for (int i = 0; i < 2; ++i) {  // the second time from the database
    EXPECT_ERROR(Run(), "flat.png: has no SeaPoint");
  }
}

TEST_F(Extract, UnchangedPicturesAreLeftAlone) {
  Run();
  Mark("img2.png");
  RunReport report;
  const std::string log = LogOf([&] { report = Run(); });
  EXPECT_TRUE(IsMarked("img2.png"));
  EXPECT_EQ(report.images_used, kNumPictures);
  EXPECT_EQ(report.inputs.size(), 3u);
  EXPECT_NE(log.find("3 pictures were there already"), std::string::npos) << log;
}

TEST_F(Extract, AChangedPictureAloneIsExtractedAgainAndLosesItsMatches) {
  MatchPicturesOf(kNumPictures);
  Mark("img2.png");  // and its matches go
  RunExhaustiveMatcher(MatcherOptions());
  ASSERT_EQ(QueryRows(DatabasePath(), "SELECT pair_id FROM matches").size(), 3u);
  WriteImage(Images() / "img3.png", StripPicture(5));
  Run();
  EXPECT_TRUE(IsMarked("img2.png"));
  const ColmapDatabase database = OpenDatabase();
  const auto ids = ImageIds(database);
  EXPECT_TRUE(HasMatches(database, {ids.at("img1.png"), ids.at("img2.png")}));
  EXPECT_FALSE(HasMatches(database, {ids.at("img1.png"), ids.at("img3.png")}));
  EXPECT_FALSE(HasMatches(database, {ids.at("img2.png"), ids.at("img3.png")}));
}

TEST_F(Extract, AChangedOptionExtractsAllAgain) {
  Run();
  const auto before = Fingerprints();
  FeatureExtractorOptions options = ExtractorOptions();
  options.extraction.max_num_features = 450;
  Run(options);
  EXPECT_EQ(Changed(before, Fingerprints()), (Names{"img1.png", "img2.png", "img3.png"}));
  // Where nothing of the pictures depends on it, nothing happens.
  Mark("img1.png");
  options.run.num_threads = 2;
  Run(options);
  EXPECT_TRUE(IsMarked("img1.png"));
}

TEST_F(Extract, TheSameRowsForAnyNumberOfThreads) {
  FeatureExtractorOptions options = ExtractorOptions();
  options.run.num_threads = 1;
  Run(options);
  const auto one = ReadTables(DatabasePath());
  fs::remove(DatabasePath());
  options.run.num_threads = 3;
  Run(options);
  EXPECT_EQ(ReadTables(DatabasePath()), one);
}

TEST_F(Extract, NothingIsFoundUnderAMask) {
  FeatureExtractorOptions options = ExtractorOptions();
  Run(options);
  const auto before = Fingerprints();
  options.reader.mask_path = (folder_ / "masks").string();
  GrayImage mask(kStripWidth, kStripHeight, 1, 255);
  for (int y = 0; y < kStripHeight; ++y) {
    for (int x = 0; x < kStripWidth / 2; ++x) mask.At(x, y) = 0;
  }
  fs::create_directories(options.reader.mask_path);
  WriteImage(folder_ / "masks/img2.png.png", mask);
  Run(options);
  // The others have no mask, and are as they were.
  EXPECT_EQ(Changed(before, Fingerprints()), Names{"img2.png"});
  const Features masked = FeaturesOf("img2.png");
  EXPECT_GT(masked.points.size(), 50u);
  for (const SeaPoint& point : masked.points) EXPECT_GE(point.x, kStripWidth / 2);
  const Features whole = FeaturesOf("img1.png");
  EXPECT_TRUE(std::any_of(whole.points.begin(), whole.points.end(),
                          [](const SeaPoint& point) { return point.x < kStripWidth / 2; }));
  // Another mask: extracted again; none: as before.
  mask.At(kStripWidth - 1, 0) = 0;
  WriteImage(folder_ / "masks/img2.png.png", mask);
  const auto masked_once = Fingerprints();
  Run(options);
  EXPECT_EQ(Changed(masked_once, Fingerprints()), Names{"img2.png"});
  fs::remove(folder_ / "masks/img2.png.png");
  Run(options);
  EXPECT_EQ(Fingerprints(), before);
}

TEST_F(Extract, BadMasksLeaveTheirPicturesOut) {
  FeatureExtractorOptions options = ExtractorOptions();
  options.reader.mask_path = (folder_ / "masks").string();
  WriteBytes(folder_ / "masks/img1.png.png", "no picture");
  WriteImage(folder_ / "masks/img2.png.png", GrayImage(8, 8, 1, 255));
  const RunReport report = Run(options);
  EXPECT_EQ(report.images_used, 1);
  ASSERT_EQ(NamesOf(report.left_out), (Names{"img1.png", "img2.png"}));
  EXPECT_EQ(report.left_out[0].reason.rfind("its mask ", 0), 0u) << report.left_out[0].reason;
  EXPECT_EQ(report.left_out[1].reason.rfind("its mask is of another size than the picture", 0), 0u);
  // A mask that covers all.
  WriteImage(folder_ / "masks/img1.png.png", GrayImage(kStripWidth, kStripHeight, 1, 0));
  fs::remove(folder_ / "masks/img2.png.png");
  const RunReport again = Run(options);
  ASSERT_EQ(NamesOf(again.left_out), Names{"img1.png"});
  EXPECT_NE(again.left_out[0].reason.find("its mask covers it"), std::string::npos);
}

TEST_F(Extract, UnreadablePicturesAreTriedAgain) {
  const std::string bytes = ReadBytes(Images() / "img2.png");
  WriteBytes(Images() / "img2.png", bytes.substr(0, bytes.size() / 2));  // its header is whole
  std::string reason;
  for (int i = 0; i < 2; ++i) {
    const RunReport report = Run();
    EXPECT_EQ(report.images_in, kNumPictures);
    EXPECT_EQ(report.images_used, kNumPictures - 1);
    ASSERT_EQ(NamesOf(report.left_out), Names{"img2.png"});
    if (i == 0) reason = report.left_out[0].reason;
    // Not "has no SeaPoint", as the database alone would tell.
    EXPECT_EQ(report.left_out[0].reason, reason);
  }
  EXPECT_EQ(reason.find("SeaPoint"), std::string::npos) << reason;
  WriteBytes(Images() / "img2.png", bytes);
  EXPECT_EQ(Run().images_used, kNumPictures);
}

TEST_F(Extract, ASecondChanceAddsLevelsAndTakesNothingAway) {
  Run();
  const auto before = Fingerprints();
  const Features usual = FeaturesOf("img2.png");
  Run(ExtractorOptions(), {"img2.png"});
  EXPECT_EQ(Changed(before, Fingerprints()), Names{"img2.png"});
  const Features more = FeaturesOf("img2.png");
  ASSERT_GT(more.points.size(), usual.points.size());
  for (size_t i = 0; i < usual.points.size(); ++i) {
    EXPECT_EQ(more.points[i].x, usual.points[i].x);
    EXPECT_EQ(more.points[i].y, usual.points[i].y);
    EXPECT_TRUE(more.descriptors[i] == usual.descriptors[i]);
  }
  std::set<float> scales;
  for (const SeaPoint& point : more.points) scales.insert(point.scale);
  EXPECT_GT(scales.size(), 1u);
  EXPECT_LE(scales.size(), static_cast<size_t>(kSecondChanceLevels));
  // The same call again finds them there.
  Mark("img2.png");
  Run(ExtractorOptions(), {"img2.png"});
  EXPECT_TRUE(IsMarked("img2.png"));
  // Without the name, its own again.
  Run();
  EXPECT_EQ(Fingerprints(), before);
}

TEST_F(Extract, KeypointsOfOtherSoftwareAreRefusedBeforeAnythingIsWritten) {
  Run();
  ExecuteSql(DatabasePath(), "DELETE FROM seapoint_descriptors WHERE image_id = 3");
  ExecuteSql(DatabasePath(),
             "UPDATE keypoints SET rows = 1, cols = 2, data = x'0000803f00008040' "
             "WHERE image_id = 3");
  WriteImage(Images() / "img0.png", StripPicture(0));
  const auto before = ReadTables(DatabasePath());
  EXPECT_ERROR(Run(), "holds keypoints of other software for img3.png");
  EXPECT_EQ(ReadTables(DatabasePath()), before);
  // Of pictures that are not asked for they do not matter.
  FeatureExtractorOptions options = ExtractorOptions();
  options.image_list_path = Write("list.txt", "img0.png\nimg1.png\n");
  EXPECT_EQ(Run(options).images_used, 2);
  EXPECT_EQ(LostRows(before, ReadTables(DatabasePath())), Names());
}

TEST_F(Extract, OptionsAreCheckedBeforeTheWork) {
  FeatureExtractorOptions options = ExtractorOptions();
  options.reader.camera_params = "1,2,3";
  EXPECT_USAGE_ERROR(ReadPictureSet(options), "camera_params");
  options = ExtractorOptions();
  options.extraction.max_num_features = options.extraction.min_num_features - 1;
  EXPECT_USAGE_ERROR(ReadPictureSet(options), "max_num_features");
  options = ExtractorOptions();
  options.reader.mask_path = (folder_ / "no masks").string();
  EXPECT_ERROR(ReadPictureSet(options), "check --ImageReader.mask_path");
  options = ExtractorOptions();
  options.image_path = (folder_ / "no pictures").string();
  EXPECT_ERROR(ReadPictureSet(options), "no pictures");
  EXPECT_FALSE(fs::exists(DatabasePath()));
}

}  // namespace
}  // namespace colmap_seapoint
