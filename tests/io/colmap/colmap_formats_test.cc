// Databases that other versions of COLMAP wrote: we add to them and change nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_copy.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/io/test_database.h"
namespace colmap_seapoint {
namespace {

using Mode = ColmapDatabase::Mode;

std::map<std::string, std::vector<std::string>> AllRows(const std::filesystem::path& path) {
  std::map<std::string, std::vector<std::string>> rows;
  for (const std::string& table :
       Query(path,
             "SELECT name FROM sqlite_master WHERE type = 'table' AND "
             "name NOT LIKE 'sqlite_%' AND name NOT LIKE 'seapoint_%'")) {
    rows[table] = Query(path, "SELECT * FROM " + table + " ORDER BY 1");
  }
  return rows;
}

void AddImageWithMatches(const std::filesystem::path& path) {
  ColmapDatabase db(path, Mode::kReadWrite);
  const auto before = ReadImages(db);
  const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kOpenCV, 700, 640, 480));
  const uint32_t c = AddImage(&db, "new/c.jpg", camera_id);
  const uint32_t d = AddImage(&db, "new/d.jpg", camera_id);
  const uint32_t e = AddImage(&db, "new/e.jpg", before.front().camera_id);
  for (const uint32_t image_id : {c, d, e}) {
    WriteFeatures(&db, image_id, MakeFeatures(30, image_id), "print");
  }
  WriteMatches(&db, d, c, {{1, 2}}, MakeGeometry({{1, 2}}));
  WriteMatches(&db, c, before.front().image_id, {{1, 0}}, MakeGeometry({{1, 0}}));
  ExpectSameFeatures(ReadFeatures(db, c), MakeFeatures(30, c));
  EXPECT_EQ(ReadMatches(db, {c, d}), (FeatureMatches{{2, 1}}));
  EXPECT_EQ(ReadTwoViewGeometry(db, {before.front().image_id, c}).inliers,
            (FeatureMatches{{0, 1}}));
}

void ExpectOnlyAdded(const std::filesystem::path& path) {
  const auto before = AllRows(path);
  AddImageWithMatches(path);
  const auto after = AllRows(path);
  for (const auto& [table, rows] : before) {
    ASSERT_GE(after.at(table).size(), rows.size()) << table;
    for (const std::string& row : rows) {
      EXPECT_EQ(std::count(after.at(table).begin(), after.at(table).end(), row), 1) << table;
    }
  }
  EXPECT_EQ(after.at("images").size(), before.at("images").size() + 3);
  EXPECT_EQ(after.at("two_view_geometries").size(), before.at("two_view_geometries").size() + 2);
  ExpectSound(path);
}

TEST(ColmapFormats, EveryDatabaseIsReadAndOnlyAddedTo) {
  const auto folder = DataDir() / "colmap_formats";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no folder " << folder;
  int num_databases = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".db") continue;
    const TempDir dir;
    const auto path = dir / entry.path().filename().string();
    std::filesystem::copy_file(entry.path(), path);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    {
      const ColmapDatabase db(path, Mode::kReadOnly);
      EXPECT_EQ(ReadCameras(db).size(), 1u) << path;
      EXPECT_EQ(ReadImages(db).size(), 12u) << path;
      EXPECT_FALSE(ReadFeatures(db, 1)) << "they are not ours";
      const auto pairs = ReadVerifiedPairs(db);
      EXPECT_FALSE(pairs.empty());
      for (const ImagePair& pair : pairs) {
        EXPECT_GT(ReadTwoViewGeometry(db, pair).inliers.size(), 0u);
        EXPECT_GT(ReadMatches(db, pair).size(), 0u);
      }
    }
    ExpectOnlyAdded(path);
    ++num_databases;
  }
  EXPECT_EQ(num_databases, 3);
}

// As root this proves little: root may write into any folder.
TEST(ColmapFormats, OpensInAFolderThatCannotBeWritten) {
  const TempDir dir;
  const auto folder = dir / "locked";
  std::filesystem::create_directory(folder);
  { ColmapDatabase db(folder / "a.db", Mode::kCreateIfMissing); }
  std::filesystem::permissions(folder / "a.db", std::filesystem::perms::owner_read);
  std::filesystem::permissions(
      folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_TRUE(ReadImages(ColmapDatabase(folder / "a.db", Mode::kReadOnly)).empty());
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
}

// COLMAP 3.12 and later: all images have frames, or none has.
void MakeDatabaseWithFrames(const std::filesystem::path& path) {
  {
    ColmapDatabase db(path, Mode::kCreateIfMissing);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    const uint32_t image_id = AddImage(&db, "a.jpg", camera_id);
    WriteFeatures(&db, image_id, MakeFeatures(5, 1), "print");
  }
  Execute(path,
          "CREATE TABLE rigs(rig_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, "
          "ref_sensor_id INTEGER NOT NULL, ref_sensor_type INTEGER NOT NULL);"
          "CREATE TABLE rig_sensors(rig_id INTEGER NOT NULL, sensor_id INTEGER NOT NULL, "
          "sensor_type INTEGER NOT NULL, sensor_from_rig BLOB);"
          "CREATE TABLE frames(frame_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, "
          "rig_id INTEGER NOT NULL);"
          "CREATE TABLE frame_data(frame_id INTEGER NOT NULL, data_id INTEGER NOT NULL, "
          "sensor_id INTEGER NOT NULL, sensor_type INTEGER NOT NULL)");
}

TEST(ColmapFormats, FramesAreAllOrNothing) {
  const TempDir dir;
  const auto path = dir / "a.db";
  MakeDatabaseWithFrames(path);
  // No frames: newer COLMAPs make them by themselves.
  {
    ColmapDatabase db(path, Mode::kReadWrite);
    AddImage(&db, "b.jpg", 1);
  }
  EXPECT_EQ(QueryOne(path, "SELECT (SELECT count(*) FROM rigs) + (SELECT count(*) FROM frames)"),
            "0");
  Execute(path,
          "INSERT INTO rigs VALUES(5, 1, 0); INSERT INTO frames VALUES(8, 5), (9, 5);"
          "INSERT INTO frame_data VALUES(8, 1, 1, 0), (9, 2, 1, 0)");
  {
    ColmapDatabase db(path, Mode::kReadWrite);
    AddImage(&db, "c.jpg", 1);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    AddImage(&db, "d.jpg", camera_id);
    AddImage(&db, "e.jpg", camera_id);
  }
  EXPECT_EQ(Query(path, "SELECT * FROM rigs"), (std::vector<std::string>{"5|1|0", "6|2|0"}));
  EXPECT_EQ(Query(path, "SELECT * FROM frames"),
            (std::vector<std::string>{"8|5", "9|5", "10|5", "11|6", "12|6"}));
  EXPECT_EQ(Query(path, "SELECT * FROM frame_data"),
            (std::vector<std::string>{"8|1|1|0", "9|2|1|0", "10|3|1|0", "11|4|2|0", "12|5|2|0"}));
}

// What COLMAP's matchers leave for pictures whose descriptors are stubs: 3.8 and 3.10 with config
// 0, 4.2.1 with config 1, which our own rows of pairs without inliers have too.
TEST(ColmapFormats, RowsOfColmapsMatchersAreNoMatchesOfOurs) {
  for (const char* config : {"0", "1"}) {
    const TempDir dir;
    MakeDatabaseWithFrames(dir / "a.db");
    ColmapDatabase db(dir / "a.db", Mode::kReadWrite);
    AddImage(&db, "b.jpg", 1);
    Execute(dir / "a.db",
            "INSERT INTO matches VALUES(2147483649, 0, 2, NULL);"
            "INSERT INTO two_view_geometries(pair_id, rows, cols, data, config) "
            "VALUES(2147483649, 0, 2, NULL, " +
                std::string(config) + ")");
    EXPECT_FALSE(HasMatches(db, {1, 2})) << config;
    TwoViewGeometry none;
    none.config = TwoViewConfig::kDegenerate;
    WriteMatches(&db, 1, 2, {}, none);
    EXPECT_TRUE(HasMatches(db, {1, 2})) << config;
  }
}

// The table as COLMAP 3.10 and 4.2.1 made it: neither opens a database with the other's.
constexpr char kPosePriorsOf310[] =
    "CREATE TABLE pose_priors   (image_id          INTEGER  PRIMARY KEY  NOT NULL,    position"
    "          BLOB,    coordinate_system INTEGER               NOT NULL,FOREIGN KEY(image_id) "
    "REFERENCES images(image_id) ON DELETE CASCADE); "
    "INSERT INTO pose_priors VALUES(1, zeroblob(24), 1)";
constexpr char kPosePriorsOf421[] =
    "CREATE TABLE pose_priors   (pose_prior_id              INTEGER  PRIMARY KEY  NOT NULL,    "
    "corr_data_id               INTEGER               NOT NULL,    corr_sensor_id             "
    "INTEGER               NOT NULL,    corr_sensor_type           INTEGER               NOT NULL,"
    "    position                   BLOB,    position_covariance        BLOB,    gravity"
    "                    BLOB,    coordinate_system          INTEGER               NOT NULL); "
    "CREATE UNIQUE INDEX pose_prior_data_assignment ON    pose_priors(corr_data_id, "
    "corr_sensor_id, "
    "corr_sensor_type); "
    "INSERT INTO pose_priors VALUES(1, 1, 1, 0, zeroblob(24), NULL, NULL, 1)";

TEST(DatabaseCopy, TakesAllButThePosePriorsOfAnyVersion) {
  for (const char* pose_priors : {"", kPosePriorsOf310, kPosePriorsOf421}) {
    const TempDir dir;
    MakeDatabaseWithFrames(dir / "a.db");
    Execute(dir / "a.db", pose_priors);
    auto rows = AllRows(dir / "a.db");
    {
      const ColmapDatabase db(dir / "a.db", Mode::kReadOnly);
      EXPECT_EQ(HasPosePriorTable(db), *pose_priors != '\0');
      WriteBytes(dir / "copy.db", "in the way");
      CopyDatabase(db, dir / "copy.db");
    }
    EXPECT_EQ(AllRows(dir / "a.db"), rows);
    rows.erase("pose_priors");
    EXPECT_EQ(AllRows(dir / "copy.db"), rows);
    EXPECT_FALSE(HasPosePriorTable(ColmapDatabase(dir / "copy.db", Mode::kReadWrite)));
    EXPECT_EQ(Query(dir / "copy.db", "SELECT name FROM sqlite_master WHERE name LIKE 'pose%'"),
              std::vector<std::string>());
    ExpectSound(dir / "copy.db");
    RemoveDatabase(dir / "copy.db");
    EXPECT_FALSE(std::filesystem::exists(dir / "copy.db"));
  }
}

}  // namespace
}  // namespace colmap_seapoint
