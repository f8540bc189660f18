// Databases that COLMAP made, of every version at hand: we add pictures of ours and change nothing
// that was there. And the other way round: COLMAP's tools on a database of ours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/cli/synthetic_strip.h"
#include "tests/colmap_options.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;
using Tables = std::map<std::string, TableRows>;

constexpr int kNumOurs = 4;

fs::path Data() {
  const char* folder = std::getenv("SEAPOINT_DATA");
  return folder != nullptr ? folder : SEAPOINT_DEFAULT_DATA;
}

bool HasColmap() { return std::system("command -v colmap >/dev/null 2>&1") == 0; }

// `after` without what COLMAPs later than 3.8 add by opening a database: tables, and columns at the
// end that are NULL.
Tables WithoutAdditions(const Tables& before, const Tables& after) {
  Tables rest;
  for (const auto& [table, rows] : before) {
    const auto found = after.find(table);
    if (found == after.end()) continue;
    for (std::string row : found->second) {
      const auto is_known = [&] { return std::binary_search(rows.begin(), rows.end(), row); };
      constexpr char kNull[] = "|NULL";
      constexpr size_t kLength = sizeof(kNull) - 1;
      const std::string whole = row;
      while (!is_known() && row.size() > kLength &&
             row.compare(row.size() - kLength, kLength, kNull) == 0) {
        row.resize(row.size() - kLength);
      }
      rest[table].push_back(is_known() ? row : whole);
    }
    rest.try_emplace(table);
  }
  return rest;
}

class ColmapDatabases : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { WriteStrip(folder_ / "ours", kNumOurs, "ours"); }

  static CliResult Colmap(const Arguments& arguments) {
    CliOptions options;
    options.environment["QT_QPA_PLATFORM"] = "offscreen";
    options.timeout_seconds = 120;
    Arguments all = {"colmap"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return RunProgram("/usr/bin/env", all, options);
  }

  std::string Database() const { return (folder_ / "a.db").string(); }

  CliResult Extract(const std::string& pictures) const {
    return RunProgram(SEAPOINT_PROGRAM, {"feature_extractor", "--database_path", Database(),
                                         "--image_path", (folder_ / pictures).string()});
  }
  CliResult Match(const std::string& command) const {
    return RunProgram(SEAPOINT_PROGRAM, {command, "--database_path", Database()});
  }

  int64_t Count(const std::string& table) const {
    return std::stoll(QueryRows(Database(), "SELECT count(*) FROM " + table).front());
  }

  // COLMAP's own project: SIFT of three pictures, their matches.
  void MakeSiftProject() {
    WriteStrip(folder_ / "theirs", 3, "theirs");
    const Arguments database = {"--database_path", Database()};
    const auto run = [&](Arguments arguments) {
      arguments.insert(arguments.end(), database.begin(), database.end());
      const CliResult result = Colmap(arguments);
      ASSERT_EQ(result.exit_code, 0) << result.Text();
    };
    run({"database_creator"});
    run({"feature_extractor", "--image_path", (folder_ / "theirs").string(),
         GpuOption("feature_extractor"), "0", "--SiftExtraction.max_num_features", "500"});
    run({"exhaustive_matcher", GpuOption("exhaustive_matcher"), "0"});
    ASSERT_EQ(Count("two_view_geometries"), 3);
  }

  // Our pictures, SeaPoints and matches go in; what was there stays.
  void ExtendAndCheck() {
    const Tables before = ReadTables(Database());
    const auto version = QueryRows(Database(), "PRAGMA user_version");
    const bool has_frames = before.count("frames") > 0 && !before.at("frames").empty();
    const CliResult extracted = Extract("ours");
    ASSERT_EQ(extracted.exit_code, 0) << extracted.Text();
    for (const char* command : {"sequential_matcher", "exhaustive_matcher"}) {
      const CliResult matched = Match(command);
      ASSERT_EQ(matched.exit_code, 3) << matched.Text();  // theirs have no SeaPoints
      EXPECT_NE(matched.err.find("has no SeaPoints in the database"), std::string::npos);
    }
    const Tables after = ReadTables(Database());
    EXPECT_EQ(LostRows(before, after), std::vector<std::string>());
    EXPECT_EQ(Unsound(Database()), std::vector<std::string>());
    EXPECT_EQ(QueryRows(Database(), "PRAGMA user_version"), version);
    const auto expect_added = [&](const std::string& table, size_t count) {
      if (before.count(table) == 0) return;
      EXPECT_EQ(after.at(table).size(), before.at(table).size() + count) << table;
    };
    expect_added("cameras", 1);
    for (const char* table : {"images", "keypoints", "descriptors"}) expect_added(table, kNumOurs);
    for (const char* table : {"matches", "two_view_geometries"}) {
      expect_added(table, kNumOurs * (kNumOurs - 1) / 2);
    }
    expect_added("rigs", has_frames ? 1 : 0);
    for (const char* table : {"frames", "frame_data"}) {
      expect_added(table, has_frames ? kNumOurs : 0);
    }
    for (const char* table : {"rig_sensors", "pose_priors"}) expect_added(table, 0);
    CheckOurRows(after, has_frames);
  }

  void CheckOurRows(const Tables& tables, bool has_frames) const {
    const std::string first =
        QueryRows(Database(), "SELECT min(image_id) FROM images WHERE name LIKE 'ours%'").front();
    const std::string ours = " WHERE pair_id / 2147483647 >= " + first;
    for (const char* column : {"F", "E", "H", "qvec", "tvec", "camera1", "camera2"}) {
      const auto columns =
          QueryRows(Database(), std::string("SELECT 1 FROM pragma_table_info('two_view_geometries')"
                                            " WHERE name = '") +
                                    column + "'");
      if (columns.empty()) continue;
      const std::string name = column;
      EXPECT_EQ(Count("two_view_geometries" + ours + " AND " + name + " IS NOT NULL AND length(" +
                      name + ") = 0"),
                0)
          << column;
      if (name.find("camera") == 0) {
        EXPECT_EQ(Count("two_view_geometries" + ours + " AND " + name + " IS NOT NULL"), 0);
      }
    }
    EXPECT_GE(Count("two_view_geometries" + ours + " AND rows > 100 AND F IS NOT NULL"),
              kNumOurs - 1);
    EXPECT_EQ(Count("descriptors WHERE image_id >= " + first + " AND (rows <> 0 OR cols <> 128)"),
              0);
    if (tables.count("frames") == 0) return;
    EXPECT_EQ(Count("descriptors WHERE image_id >= " + first + " AND type <> 0"), 0);
    if (!has_frames) return;
    // One frame an image, of a rig whose reference sensor is the image's camera.
    EXPECT_EQ(Count("images JOIN frame_data ON data_id = image_id AND sensor_type = 0 AND "
                    "sensor_id = camera_id JOIN frames USING(frame_id) JOIN rigs USING(rig_id) "
                    "WHERE ref_sensor_id = camera_id AND ref_sensor_type = 0"),
              Count("images"));
  }

  TemporaryFolder folder_;
};

TEST_P(ColmapDatabases, AreOnlyAddedTo) {
  const fs::path source = Data() / "colmap_formats" / GetParam();
  if (!fs::exists(source)) GTEST_SKIP() << "no evaluation data at " << source;
  fs::copy_file(source, Database());
  fs::permissions(Database(), fs::perms::owner_read | fs::perms::owner_write);
  ExecuteSql(Database(),
             "INSERT INTO pose_priors(pose_prior_id, corr_data_id, corr_sensor_id, "
             "corr_sensor_type, position, coordinate_system) "
             "VALUES(1, 1, 1, 0, zeroblob(24), 1)");
  ExtendAndCheck();
}

INSTANTIATE_TEST_SUITE_P(Versions, ColmapDatabases,
                         testing::Values("fresh_4.2.db", "with_rigs_and_frames_4.2.db",
                                         "migrated_3.8_to_4.2.db"),
                         [](const auto& version) {
                           std::string name = version.param;
                           for (char& c : name) {
                             if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
                           }
                           return name;
                         });

class InstalledColmap : public ColmapDatabases {
 protected:
  void SetUp() override {
    if (!HasColmap()) GTEST_SKIP() << "colmap is not installed";
    ColmapDatabases::SetUp();
  }
};

TEST_F(InstalledColmap, ASiftProjectIsOnlyAddedTo) {
  MakeSiftProject();
  ExtendAndCheck();
}

TEST_F(InstalledColmap, SiftOfTheSamePicturesIsLeftAlone) {
  MakeSiftProject();
  const Tables before = ReadTables(Database());
  const CliResult extracted = Extract("theirs");
  EXPECT_EQ(extracted.exit_code, 1);
  EXPECT_NE(extracted.LastErrorLine().find("holds keypoints of other software for theirs1.png"),
            std::string::npos)
      << extracted.Text();
  for (const char* command : {"sequential_matcher", "exhaustive_matcher"}) {
    const CliResult matched = Match(command);
    EXPECT_EQ(matched.exit_code, 1);
    EXPECT_NE(matched.LastErrorLine().find("none of its 3 images has SeaPoints"), std::string::npos)
        << matched.Text();
  }
  EXPECT_EQ(ReadTables(Database()), before);

  // Densification finds SeaPoints by itself, whatever the database holds.
  WriteSparseModelBinary(folder_ / "model", StripModel(3, "theirs"));
  const CliResult densified = RunProgram(
      SEAPOINT_PROGRAM, {"partial_densifier", "--image_path", (folder_ / "theirs").string(),
                         "--input_path", (folder_ / "model").string(), "--output_path",
                         (folder_ / "dense").string(), "--database_path", Database()});
  EXPECT_EQ(densified.exit_code, 0) << densified.Text();
  EXPECT_NE(densified.err.find("holds SeaPoints of no picture of the model"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "dense" / "fused.ply"));
  EXPECT_EQ(ReadTables(Database()), before);
}

// COLMAP's matchers find nothing in stubs and say so in rows of their own, which must not keep ours
// from matching; its cleaner takes features away, which are then found anew.
TEST_F(InstalledColmap, ItsMatchersAndCleanerBeforeOurs) {
  ASSERT_EQ(Extract("ours").exit_code, 0);
  const Tables extracted = ReadTables(Database());
  const CliResult theirs = Colmap(
      {"exhaustive_matcher", "--database_path", Database(), GpuOption("exhaustive_matcher"), "0"});
  ASSERT_EQ(theirs.exit_code, 0) << theirs.Text();
  ASSERT_EQ(Count("two_view_geometries WHERE rows = 0"), kNumOurs * (kNumOurs - 1) / 2);
  ASSERT_EQ(Match("exhaustive_matcher").exit_code, 0);
  EXPECT_GE(Count("two_view_geometries WHERE rows > 100"), kNumOurs - 1);

  const CliResult cleaned =
      Colmap({"database_cleaner", "--type", "features", "--database_path", Database()});
  ASSERT_EQ(cleaned.exit_code, 0) << cleaned.Text();
  ASSERT_EQ(Count("keypoints"), 0);
  EXPECT_EQ(Match("exhaustive_matcher").exit_code, 1);
  EXPECT_EQ(Count("two_view_geometries"), 0);
  ASSERT_EQ(Extract("ours").exit_code, 0);
  EXPECT_EQ(WithoutAdditions(extracted, ReadTables(Database())), extracted);
}

// Real matches, COLMAP 3.8's tools: as on a database of its own, which they all end with 0 on.
TEST_F(InstalledColmap, ItsToolsRunOnOurDatabase) {
  CliOptions minutes;
  minutes.timeout_seconds = 180;
  const fs::path survey = folder_ / "survey";
  ASSERT_EQ(RunProgram(DEMO_SURVEY,
                       {"generate", "--output_path", survey.string(), "--num_strips", "1",
                        "--images_per_strip", "5", "--width", "680", "--height", "512"},
                       minutes)
                .exit_code,
            0);
  const std::string images = (survey / "images").string();
  ASSERT_EQ(Extract("survey/images").exit_code, 0);
  ASSERT_EQ(Match("exhaustive_matcher").exit_code, 0);
  const Tables ours = ReadTables(Database());
  const auto expect_success = [&](const Arguments& arguments) {
    const CliResult result = Colmap(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments.front() << "\n" << result.Text();
  };
  const std::string sparse = (folder_ / "sparse").string(), again = (folder_ / "again").string();
  for (const std::string& folder : {sparse, again}) fs::create_directory(folder);
  expect_success({"mapper", "--database_path", Database(), "--image_path", images, "--output_path",
                  sparse, "--Mapper.init_min_tri_angle", "4", "--Mapper.min_model_size", "3"});
  ASSERT_TRUE(IsSparseModel(sparse + "/0"));
  EXPECT_EQ(ReadSparseModel(sparse + "/0").images.size(), 5u);
  expect_success(
      {"exhaustive_matcher", "--database_path", Database(), GpuOption("exhaustive_matcher"), "0"});
  expect_success({"feature_extractor", "--database_path", Database(), "--image_path", images,
                  GpuOption("feature_extractor"), "0"});
  EXPECT_EQ(WithoutAdditions(ours, ReadTables(Database())), ours);
  expect_success({"point_triangulator", "--database_path", Database(), "--image_path", images,
                  "--input_path", sparse + "/0", "--output_path", again});
  EXPECT_GT(ReadSparseModel(again).points3D.size(), 500u);
  for (const std::string type : {"TXT", "BIN"}) {
    expect_success(
        {"model_converter", "--input_path", again, "--output_path", again, "--output_type", type});
  }
  EXPECT_EQ(LostRows(ours, WithoutAdditions(ours, ReadTables(Database()))),
            std::vector<std::string>());
  EXPECT_EQ(Unsound(Database()), std::vector<std::string>());
  for (const std::string type : {"matches", "features", "images", "all"}) {
    expect_success({"database_cleaner", "--type", type, "--database_path", Database()});
    EXPECT_EQ(Unsound(Database()), std::vector<std::string>()) << type;
  }
  EXPECT_EQ(Count("images"), 0);
  EXPECT_EQ(Count("seapoint_descriptors"), 0);
}

}  // namespace
}  // namespace colmap_seapoint
