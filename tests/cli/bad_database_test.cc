// Databases that are locked, damaged, foreign or no databases.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

class BadDatabase : public testing::Test {
 protected:
  void SetUp() override { WriteStrip(folder_ / "images", 2); }

  std::string Database() const { return (folder_ / "database.db").string(); }

  std::vector<std::string> ExtractArguments() const {
    return {"feature_extractor", "--database_path", Database(), "--image_path",
            (folder_ / "images").string()};
  }
  CliResult Extract() const { return RunProgram(SEAPOINT_PROGRAM, ExtractArguments()); }
  CliResult Match() const {
    return RunProgram(SEAPOINT_PROGRAM, {"exhaustive_matcher", "--database_path", Database()});
  }

  // Fails with one line that names the database, and leaves its bytes alone.
  void ExpectRefusal(const CliResult& result, const std::string& bytes, const std::string& word) {
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    EXPECT_EQ(result.LastErrorLine().find("error: "), 0u) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(Database()), std::string::npos) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(word), std::string::npos) << result.Text();
    EXPECT_TRUE(ReadBytes(Database()) == bytes);
  }

  void Execute(const std::string& sql) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(Database().c_str(), &db), SQLITE_OK);
    char* message = nullptr;
    EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
    sqlite3_close(db);
  }

  TemporaryFolder folder_;
};

TEST_F(BadDatabase, MissingForAMatcher) {
  const CliResult result = Match();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(Database()), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(Database()));
}

TEST_F(BadDatabase, NotADatabase) {
  const std::string bytes(4096, 'x');
  WriteBytes(Database(), bytes);
  ExpectRefusal(Extract(), bytes, "not a database");
  ExpectRefusal(Match(), bytes, "not a database");
}

TEST_F(BadDatabase, AnotherProgramsDatabase) {
  Execute("CREATE TABLE songs(title TEXT)");
  const std::string bytes = ReadBytes(Database());
  const CliResult result = Extract();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("no COLMAP database"), std::string::npos) << result.Text();
  EXPECT_TRUE(ReadBytes(Database()) == bytes);
}

// Of a shape that no COLMAP we know has: refused with one line, and not a byte is written.
TEST_F(BadDatabase, UnknownShapes) {
  const struct {
    const char* sql;
    const char* word;
  } kShapes[] = {
      {"ALTER TABLE keypoints RENAME COLUMN cols TO width", "no column keypoints.cols"},
      {"DROP TABLE two_view_geometries", "no column two_view_geometries.pair_id"},
      {"DROP TABLE descriptors; CREATE TABLE descriptors(image_id INTEGER PRIMARY KEY NOT NULL, "
       "rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, space INTEGER NOT NULL)",
       "descriptors.space must have a value"},
      {"DROP TABLE matches; CREATE TABLE matches(pair_id INTEGER NOT NULL, rows INTEGER NOT NULL, "
       "cols INTEGER NOT NULL, data BLOB, model TEXT NOT NULL, PRIMARY KEY(pair_id, model))",
       "matches.pair_id is no INTEGER PRIMARY KEY"},
      {"DROP TABLE matches; CREATE VIEW matches AS SELECT 1 AS pair_id, 0 AS rows, 2 AS cols, "
       "NULL AS data",
       "matches is no table but a view"},
      {"CREATE TABLE frames(frame_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, rig_id INTEGER "
       "NOT NULL)",
       "no column rigs.rig_id"},
      {"DROP TABLE seapoint_descriptors; CREATE TABLE seapoint_descriptors(image_id INTEGER "
       "PRIMARY KEY, colour TEXT)",
       "no column seapoint_descriptors.rows"}};
  ASSERT_EQ(Extract().exit_code, 0);
  ExecuteSql(Database(), "PRAGMA journal_mode = DELETE");  // every byte in the one file
  const std::string sound = ReadBytes(Database());
  for (const auto& shape : kShapes) {
    WriteBytes(Database(), sound);
    ExecuteSql(Database(), shape.sql);
    const std::string bytes = ReadBytes(Database());
    ExpectRefusal(Extract(), bytes, shape.word);
    ExpectRefusal(Match(), bytes, shape.word);
  }
  // More than we know is welcome where it may stay empty.
  WriteBytes(Database(), sound);
  ExecuteSql(Database(),
             "ALTER TABLE images ADD COLUMN depth REAL; ALTER TABLE two_view_geometries ADD COLUMN "
             "score REAL NOT NULL DEFAULT 0; CREATE TABLE dives(name TEXT NOT NULL)");
  EXPECT_EQ(Extract().exit_code, 0);
  EXPECT_EQ(Match().exit_code, 0);
}

// What colmap database_cleaner and COLMAP's own matchers leave behind.
TEST_F(BadDatabase, CleanedFeaturesAreFoundAgainAndEmptyRowsMatchedAgain) {
  ASSERT_EQ(Extract().exit_code, 0);
  const auto extracted = ReadTables(Database());
  ExecuteSql(Database(), "DELETE FROM keypoints; DELETE FROM descriptors");
  const CliResult refused = Match();
  EXPECT_EQ(refused.exit_code, 1) << refused.Text();
  EXPECT_NE(refused.LastErrorLine().find("none of its 2 images has SeaPoints"), std::string::npos);
  EXPECT_EQ(Extract().exit_code, 0);
  EXPECT_EQ(ReadTables(Database()), extracted);
  ExecuteSql(Database(),
             "INSERT INTO matches(pair_id, rows, cols) VALUES(2147483649, 0, 0); "
             "INSERT INTO two_view_geometries(pair_id, rows, cols, config) "
             "VALUES(2147483649, 0, 0, 0)");
  EXPECT_EQ(Match().exit_code, 0);
  EXPECT_EQ(QueryRows(Database(), "SELECT count(*) FROM two_view_geometries WHERE rows > 100"),
            TableRows{"1"});
}

TEST_F(BadDatabase, Damaged) {
  ASSERT_EQ(Extract().exit_code, 0);
  std::string bytes = ReadBytes(Database());
  for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 3000; ++i) {
    bytes[i] = static_cast<char>(bytes[i] ^ 0x5a);
  }
  WriteBytes(Database(), bytes);
  ExpectRefusal(Match(), bytes, "damaged");
  std::string cut = bytes.substr(0, bytes.size() / 2);
  WriteBytes(Database(), cut);
  ExpectRefusal(Match(), cut, "damaged");
}

TEST_F(BadDatabase, LockedByAnotherProgram) {
  ASSERT_EQ(Extract().exit_code, 0);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(Database().c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
  const CliResult result = Match();
  sqlite3_exec(db, "ROLLBACK", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("locked"), std::string::npos) << result.Text();
  EXPECT_EQ(Match().exit_code, 0);
}

TEST_F(BadDatabase, KeypointsOfOtherSoftwareAreNeverOverwritten) {
  ASSERT_EQ(Extract().exit_code, 0);
  Execute("DROP TABLE seapoint_descriptors");
  Execute("UPDATE keypoints SET cols = 6, rows = 2, data = zeroblob(48)");
  const CliResult result = Extract();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("other software"), std::string::npos) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("new --database_path"), std::string::npos);
  EXPECT_NE(Match().LastErrorLine().find("feature_extractor"), std::string::npos);
  Execute("DELETE FROM images WHERE 0 = (SELECT count(*) FROM keypoints WHERE rows = 2)");
  EXPECT_EQ(ReadImages(ColmapDatabase(Database(), ColmapDatabase::Mode::kReadOnly)).size(), 2u);
}

TEST_F(BadDatabase, ImageNamesThatLeadOutside) {
  ASSERT_EQ(Extract().exit_code, 0);
  for (const char* name : {"../../outside/x.jpg", "/etc/x.jpg"}) {
    Execute(std::string("UPDATE images SET name = '") + name + "' WHERE image_id = 1");
    for (const CliResult& result : {Match(), Extract()}) {
      EXPECT_EQ(result.exit_code, 1) << result.Text();
      EXPECT_NE(result.LastErrorLine().find(name), std::string::npos) << result.Text();
    }
  }
}

TEST_F(BadDatabase, WithoutSeaPoints) {
  { ColmapDatabase(Database(), ColmapDatabase::Mode::kCreateIfMissing); }
  const CliResult result = Match();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("feature_extractor"), std::string::npos) << result.Text();
}

TEST_F(BadDatabase, MatchersGoOnWhereTheyStopped) {
  WriteStrip(folder_ / "images", 12);
  ASSERT_EQ(Extract().exit_code, 0);
  const auto sequential = [&](const std::string& overlap) {
    return RunProgram(SEAPOINT_PROGRAM, {"sequential_matcher", "--database_path", Database(),
                                         "--SequentialMatching.overlap", overlap,
                                         "--SequentialMatching.loop_detection", "0"});
  };
  ASSERT_EQ(sequential("1").exit_code, 0);
  {
    // Natural order: img2 is followed by img3, not by img10. Ids are in bytewise order:
    // 1 img1, 2 img10, 3 img11, 4 img12, 5 img2, 6 img3 ...
    const ColmapDatabase database(Database(), ColmapDatabase::Mode::kReadOnly);
    EXPECT_TRUE(HasMatches(database, {1, 5}));
    EXPECT_TRUE(HasMatches(database, {5, 6}));
    EXPECT_TRUE(HasMatches(database, {2, 12}));
    EXPECT_FALSE(HasMatches(database, {1, 2}));
    const TwoViewGeometry geometry = ReadTwoViewGeometry(database, {5, 6});
    EXPECT_GT(geometry.inliers.size(), 100u);
    EXPECT_GE(ReadMatches(database, {5, 6}).size(), geometry.inliers.size());
  }
  const CliResult result = sequential("3");
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("11 pairs were there already"), std::string::npos) << result.Text();
  EXPECT_NE(Match().err.find("30 pairs were there already"), std::string::npos);
  EXPECT_EQ(HasMatches(ColmapDatabase(Database(), ColmapDatabase::Mode::kReadOnly), {3, 11}), true);
}

}  // namespace
}  // namespace colmap_seapoint
