// Pairs from positions: tables, EXIF, priors of the database, and what is wrong with them.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <exiv2/exiv2.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 6;

class SpatialMatcher : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", kNumPictures);
    const CliResult result =
        RunProgram(SEAPOINT_PROGRAM, {"feature_extractor", "--database_path", Database(),
                                      "--image_path", (folder_ / "images").string()});
    ASSERT_EQ(result.exit_code, 0) << result.Text();
  }

  std::string Database() const { return (folder_ / "database.db").string(); }
  std::string Table() const { return (folder_ / "nav.csv").string(); }

  CliResult Match(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"spatial_matcher", "--database_path", Database()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }
  CliResult MatchByTable(const std::string& table,
                         const std::vector<std::string>& more = {}) const {
    WriteBytes(Table(), table);
    std::vector<std::string> arguments = {"--SpatialMatching.positions_path", Table()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Match(arguments);
  }

  // Picture i stands at x = `step` i; of all of them but `but`.
  static std::string Line(const std::string& header, double step, int but = 0) {
    std::string table = header + "\n";
    for (int i = 1; i <= kNumPictures; ++i) {
      if (i == but) continue;
      table += "img" + std::to_string(i) + ".png," + std::to_string(step * i) + ",5,0\n";
    }
    return table;
  }

  std::set<ImagePair> Rows() const {
    const ColmapDatabase database(Database(), ColmapDatabase::Mode::kReadOnly);
    std::set<ImagePair> rows;
    for (uint32_t i = 1; i <= kNumPictures; ++i) {
      for (uint32_t j = i + 1; j <= kNumPictures; ++j) {
        if (HasMatches(database, {i, j})) rows.insert({i, j});
      }
    }
    return rows;
  }

  void Execute(const std::string& sql) const {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(Database().c_str(), &db), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(db);
    sqlite3_close(db);
  }

  TemporaryFolder folder_;
};

const std::set<ImagePair> kNeighbours = {{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}};

TEST_F(SpatialMatcher, MatchesWhatIsNear) {
  const CliResult result =
      MatchByTable(Line("image,x,y,z", 1), {"--SpatialMatching.max_distance", "1.5"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Rows(), kNeighbours);
  const ColmapDatabase database(Database(), ColmapDatabase::Mode::kReadOnly);
  EXPECT_EQ(ReadVerifiedPairs(database).size(), kNeighbours.size());
  // Once more, and further: what is there stays.
  const CliResult again =
      Match({"--SpatialMatching.positions_path", Table(), "--SpatialMatching.max_distance", "2.5"});
  EXPECT_NE(again.err.find("5 pairs were there already"), std::string::npos) << again.Text();
  EXPECT_EQ(Rows().size(), 9u);
}

TEST_F(SpatialMatcher, DegreesBecomeMetres) {
  // A thousandth of a degree of latitude is 111 m.
  const CliResult result =
      MatchByTable(Line("image,lat,lon,alt", 0.001), {"--SpatialMatching.max_distance", "120"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Rows(), kNeighbours);
}

TEST_F(SpatialMatcher, PicturesWithoutPositionAreNamed) {
  const CliResult result = MatchByTable(Line("image,x,y,z", 1, 4) + "other.png,1,2,3\n",
                                        {"--SpatialMatching.max_distance", "1.5"});
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.err.find("img4.png is left out: has no line in"), std::string::npos);
  EXPECT_NE(result.err.find("1 of its pictures are not in the database: other.png"),
            std::string::npos)
      << result.err;
  const auto report = nlohmann::json::parse(ReadBytes(Database() + ".spatial_matcher.run.json"));
  ASSERT_EQ(report["left_out"].size(), 1u);
  EXPECT_EQ(report["left_out"][0]["name"], "img4.png");
  EXPECT_EQ(report["images_used"], kNumPictures - 1);
  EXPECT_EQ(Rows(), (std::set<ImagePair>{{1, 2}, {2, 3}, {5, 6}}));
}

TEST_F(SpatialMatcher, WrongTablesFailBeforeAnythingIsWritten) {
  struct Wrong {
    std::string table, where, word;
  };
  for (const Wrong& wrong : {Wrong{"image,x,y,z\nimg1.png,1,2\n", ":2: ", "3 fields"},
                             Wrong{"image,x,y,z\n\nimg1.png,1,2,x\n", ":3: ", "'x'"},
                             Wrong{"img1.png,1,2,3\n", ":1: ", "header"},
                             Wrong{"image,x,y,z\nelse.png,1,2,3\n", "", "no picture is known"}}) {
    const CliResult result = MatchByTable(wrong.table);
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(wrong.word), std::string::npos) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(wrong.where), std::string::npos) << result.Text();
  }
  EXPECT_TRUE(Rows().empty());
}

TEST_F(SpatialMatcher, ReadsExif) {
  for (int i = 1; i <= kNumPictures; ++i) {
    if (i == 6) continue;
    const auto image =
        Exiv2::ImageFactory::open((folder_ / "images" / ("img" + std::to_string(i) + ".png")));
    image->readMetadata();
    image->exifData()["Exif.GPSInfo.GPSLatitude"] = "43/1 0/1 " + std::to_string(i) + "/1";
    image->exifData()["Exif.GPSInfo.GPSLatitudeRef"] = "N";
    image->exifData()["Exif.GPSInfo.GPSLongitude"] = "5/1 0/1 0/1";
    image->exifData()["Exif.GPSInfo.GPSLongitudeRef"] = "E";
    image->writeMetadata();
  }
  // A second of latitude is 31 m.
  const CliResult result = Match(
      {"--image_path", (folder_ / "images").string(), "--SpatialMatching.max_distance", "40"});
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.err.find("img6.png is left out: has no GPS"), std::string::npos) << result.err;
  EXPECT_EQ(Rows(), (std::set<ImagePair>{{1, 2}, {2, 3}, {3, 4}, {4, 5}}));
}

TEST_F(SpatialMatcher, ReadsThePriorsOfTheDatabase) {
  CliResult result = Match();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("positions_path"), std::string::npos) << result.Text();
  Execute("UPDATE images SET prior_tx = 1000 + image_id, prior_ty = 0, prior_tz = 0");
  result = Match();
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("SpatialMatching.is_gps 0"), std::string::npos)
      << result.Text();
  result = Match({"--SpatialMatching.is_gps", "0", "--SpatialMatching.max_distance", "1.5"});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Rows(), kNeighbours);
}

}  // namespace
}  // namespace colmap_seapoint
