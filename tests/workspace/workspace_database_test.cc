#include "colmap_seapoint/workspace/workspace_database.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/database_tables.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 3;

class WorkspaceDatabase : public StripSurvey {
 protected:
  void SetUp() override { WritePictures(kNumPictures); }

  fs::path Root() const { return folder_ / "ws"; }
  fs::path Path() const { return Root() / "database.db"; }

  ColmapDatabase Open(const std::string& inputs, const ImageReaderOptions& reader = {}) const {
    WorkspaceState state(Root());
    const auto pictures = ReadPictureSet(ExtractorOptions()).readable;
    DatabaseInputs remembered = {options_, {}};
    for (const ReadablePicture& picture : pictures) remembered.pictures.push_back(picture.name);
    return OpenWorkspaceDatabase(Path(), pictures, reader, {"database", "1", inputs, ""},
                                 remembered, &state);
  }

  // Extracts and matches all pictures, as the chain does.
  void Fill(ColmapDatabase* database) const {
    FeatureExtractorOptions extractor = ExtractorOptions();
    extractor.database_path = Path().string();
    ExtractPictures(extractor, ReadPictureSet(extractor), {}, database);
    ExhaustiveMatcherOptions matcher = MatcherOptions();
    matcher.database_path = Path().string();
    MatchExhaustively(matcher, database);
  }
  void OpenAndFill(const std::string& inputs) const {
    ColmapDatabase database = Open(inputs);
    Fill(&database);
  }

  std::map<std::string, TableRows> Tables() const { return ReadTables(Path()); }

  std::string options_ = "options";
};

TEST_F(WorkspaceDatabase, GrowsWithPicturesThatComeInAfterItsModelsWereMade) {
  OpenAndFill("a");
  const auto before = Tables();
  WritePictures(kNumPictures + 1);
  { WorkspaceState(Root()).Write("mapper", {{"fingerprint", "of models"}}); }
  const std::string log = LogOf([&] { Open("b"); });
  EXPECT_NE(log.find("Pictures came in"), std::string::npos) << log;
  EXPECT_EQ(Tables(), before);
  OpenAndFill("b");
  const auto after = Tables();
  EXPECT_EQ(after.at("two_view_geometries").size(), 6u);
  for (const auto& row : before.at("two_view_geometries")) {
    const auto& rows = after.at("two_view_geometries");
    EXPECT_NE(std::find(rows.begin(), rows.end(), row), rows.end());
  }
  // One that goes, or other options, begin it anew.
  options_ = "others";
  EXPECT_NE(LogOf([&] { Open("c"); }).find("begun anew"), std::string::npos);
  OpenAndFill("c");
  fs::remove(Images() / "img1.png");
  WriteImage(Images() / "img9.png", StripPicture(9));
  EXPECT_NE(LogOf([&] { Open("d"); }).find("begun anew"), std::string::npos);
}

TEST_F(WorkspaceDatabase, IsBegunAnewWithMorePicturesWhereNoModelWasMade) {
  OpenAndFill("a");
  WritePictures(kNumPictures + 1);
  EXPECT_NE(LogOf([&] { Open("b"); }).find("begun anew"), std::string::npos);
}

TEST_F(WorkspaceDatabase, IsCreated) {
  const ColmapDatabase database = Open("a");
  EXPECT_TRUE(ReadImages(database).empty());  // registering them is the extraction's
  EXPECT_TRUE(fs::exists(Root() / "state/database.json"));
}

TEST_F(WorkspaceDatabase, IsKeptAsLongAsTheStageIsTheSame) {
  OpenAndFill("a");
  const auto before = Tables();
  ASSERT_EQ(before.at("two_view_geometries").size(), 3u);
  const std::string log = LogOf([&] { EXPECT_EQ(ReadImages(Open("a")).size(), 3u); });
  EXPECT_EQ(log.find("begun anew"), std::string::npos) << log;
  EXPECT_EQ(Tables(), before);
}

// A run that was stopped before it wrote anything is no reason to refuse the next one.
TEST_F(WorkspaceDatabase, OneThatIsEmptyIsBegunAnew) {
  OpenAndFill("a");
  const auto whole = Tables();
  for (const char* suffix : {"-wal", "-shm", ""}) fs::remove(Path().string() + suffix);
  fs::create_directories(Root());
  std::ofstream(Path()).flush();
  ASSERT_EQ(fs::file_size(Path()), 0u);
  OpenAndFill("b");
  EXPECT_EQ(Tables(), whole);
}

TEST_F(WorkspaceDatabase, AnotherStageBeginsItAnewWithTheSeaPoints) {
  OpenAndFill("a");
  const auto before = Tables();
  const std::string log = LogOf([&] { Open("b"); });
  EXPECT_NE(log.find("begun anew"), std::string::npos) << log;
  const auto after = Tables();
  EXPECT_EQ(after.at("matches").size(), 0u);
  EXPECT_EQ(after.at("two_view_geometries").size(), 0u);
  for (const char* table : {"cameras", "images", "keypoints", "seapoint_descriptors"}) {
    ASSERT_FALSE(before.at(table).empty()) << table;
    EXPECT_EQ(after.at(table), before.at(table)) << table;
  }
  EXPECT_EQ(Unsound(Path()), std::vector<std::string>());
  EXPECT_FALSE(fs::exists(Root() / "state/fresh.db"));
  // That is its state now.
  const std::string again = LogOf([&] { Open("b"); });
  EXPECT_EQ(again.find("begun anew"), std::string::npos) << again;
}

TEST_F(WorkspaceDatabase, OtherOptionsGiveOtherCameras) {
  OpenAndFill("a");
  const auto before = Tables();
  ImageReaderOptions reader;
  reader.camera_model = "SIMPLE_RADIAL";
  reader.single_camera_per_folder = false;
  const ColmapDatabase database = Open("b", reader);
  const auto cameras = ReadCameras(database);
  EXPECT_EQ(cameras.size(), 3u);
  for (const auto& [id, camera] : cameras) EXPECT_EQ(camera.model, CameraModel::kSimpleRadial);
  EXPECT_EQ(Tables().at("keypoints"), before.at("keypoints"));
}

TEST_F(WorkspaceDatabase, FollowsThePicturesThatAreThere) {
  OpenAndFill("a");
  const ColmapDatabase before = Open("a");
  const auto old_ids = ImageIds(before);
  const auto old_features = ReadFeatures(before, old_ids.at("img2.png"));
  ASSERT_TRUE(old_features.has_value());
  fs::remove(Images() / "img1.png");
  WriteImage(Images() / "img9.png", StripPicture(9));
  const ColmapDatabase after = Open("b");
  const auto ids = ImageIds(after);
  ASSERT_EQ(ids.size(), 3u);
  EXPECT_EQ(ids.count("img1.png"), 0u);
  EXPECT_FALSE(HasFeatures(after, ids.at("img9.png")));
  EXPECT_NE(ids.at("img2.png"), old_ids.at("img2.png"));  // ids are those of a fresh run
  const auto features = ReadFeatures(after, ids.at("img2.png"));
  ASSERT_TRUE(features.has_value());
  EXPECT_EQ(features->descriptors, old_features->descriptors);
  EXPECT_EQ(FeaturesFingerprint(after, ids.at("img2.png")),
            FeaturesFingerprint(before, old_ids.at("img2.png")));
}

TEST_F(WorkspaceDatabase, OfOtherPicturesAltogether) {
  OpenAndFill("a");
  fs::remove_all(Images());
  WriteStrip(Images(), 2, "other");
  const ColmapDatabase database = Open("b");
  const auto ids = ImageIds(database);
  ASSERT_EQ(ids.size(), 2u);
  for (const auto& [name, id] : ids) {
    EXPECT_EQ(name.rfind("other", 0), 0u) << name;
    EXPECT_FALSE(HasFeatures(database, id)) << name;
  }
  EXPECT_EQ(Tables().at("keypoints").size(), 0u);
}

TEST_F(WorkspaceDatabase, SomebodyElsesIsRefusedAndNotTouched) {
  // Of the user's own extraction, without a word of ours about it.
  ExtractPicturesOf(kNumPictures);
  fs::create_directories(Root());
  fs::copy_file(DatabasePath(), Path());
  const std::string before = ReadBytes(Path());
  EXPECT_ERROR(Open("a"), "was not made by colmap_seapoint");
  EXPECT_ERROR(Open("a"), "--workspace_path");
  EXPECT_EQ(ReadBytes(Path()), before);
  EXPECT_FALSE(fs::exists(Root() / "state/database.json"));
  // Not even a whole one.
  WriteBytes(Path(), "somebody's work");
  EXPECT_ERROR(Open("a"), "was not made by");
  EXPECT_EQ(ReadBytes(Path()), "somebody's work");
}

TEST_F(WorkspaceDatabase, OneOfAnOlderVersionIsOurs) {
  OpenAndFill("a");
  const auto before = Tables();
  nlohmann::ordered_json old = RunReport();
  old["fingerprint"] = "0123456789abcdef";
  WriteBytes(Root() / "state/database.json", old.dump());
  const std::string log = LogOf([&] { Open("a"); });
  EXPECT_NE(log.find("begun anew"), std::string::npos) << log;
  EXPECT_EQ(Tables().at("keypoints"), before.at("keypoints"));
  EXPECT_EQ(Tables().at("matches").size(), 0u);
}

TEST_F(WorkspaceDatabase, GoesOnAfterItWasTakenAway) {
  OpenAndFill("a");
  fs::remove(Path());
  EXPECT_TRUE(ReadImages(Open("a")).empty());
  fs::remove(Path());
  EXPECT_TRUE(ReadImages(Open("b")).empty());
}

TEST_F(WorkspaceDatabase, LeftoversOfAKilledRunAreReplaced) {
  OpenAndFill("a");
  WriteBytes(Root() / "state/fresh.db", "half a database");
  WriteBytes(Root() / "state/fresh.db-journal", "and its journal");
  EXPECT_EQ(ReadImages(Open("b")).size(), 3u);
  EXPECT_FALSE(fs::exists(Root() / "state/fresh.db"));
  EXPECT_FALSE(fs::exists(Root() / "state/fresh.db-journal"));
}

TEST_F(WorkspaceDatabase, FingerprintIsOfPicturesCamerasAndSeaPoints) {
  OpenAndFill("a");
  const auto fingerprint = [&] { return DatabaseFingerprint(Open("a")); };
  const std::string first = fingerprint();
  EXPECT_EQ(first.size(), 21u);
  EXPECT_EQ(fingerprint(), first);
  // Matches follow from what the database was begun with: the record tells of that.
  ExecuteSql(Path(), "DELETE FROM matches");
  EXPECT_EQ(fingerprint(), first);
  std::set<std::string> seen = {first};
  for (const char* change :
       {"UPDATE images SET name = 'renamed.png' WHERE image_id = 2",
        "UPDATE cameras SET prior_focal_length = 1", "UPDATE cameras SET width = width + 1",
        "UPDATE cameras SET params = x'0000000000007940' || "
        "substr(params, 9)",
        "DELETE FROM seapoint_descriptors WHERE image_id = 1",
        "DELETE FROM images WHERE image_id = 3"}) {
    ExecuteSql(Path(), change);
    EXPECT_TRUE(seen.insert(fingerprint()).second) << change;
  }
}

}  // namespace
}  // namespace colmap_seapoint
