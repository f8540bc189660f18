// Pairs beyond the sequence: found, not made up, and the same however often the run was stopped.
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>

#include <chrono>
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

constexpr int kNumPictures = 9;
constexpr char kFound[] = "look alike";  // said only when the search is made

// Every row of the tables that matching writes.
std::vector<std::string> Dump(const fs::path& path) {
  std::vector<std::string> rows;
  sqlite3* db = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  for (const char* sql :
       {"SELECT pair_id, rows, hex(data) FROM matches ORDER BY pair_id",
        "SELECT pair_id, rows, hex(data), config, hex(F), hex(E), hex(H), hex(qvec), hex(tvec) "
        "FROM two_view_geometries ORDER BY pair_id"}) {
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(db, sql, -1, &statement, nullptr), SQLITE_OK);
    while (sqlite3_step(statement) == SQLITE_ROW) {
      rows.emplace_back();
      for (int i = 0; i < sqlite3_column_count(statement); ++i) {
        const auto* text = sqlite3_column_text(statement, i);
        rows.back() +=
            text == nullptr ? "|" : reinterpret_cast<const char*>(text) + std::string("|");
      }
    }
    sqlite3_finalize(statement);
  }
  sqlite3_close(db);
  return rows;
}

class LoopDetection : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", kNumPictures);
    ASSERT_EQ(Extract("features.db").exit_code, 0);
  }

  CliResult Extract(const std::string& database) const {
    return RunProgram(SEAPOINT_PROGRAM,
                      {"feature_extractor", "--database_path", (folder_ / database).string(),
                       "--image_path", (folder_ / "images").string()});
  }

  // A database with SeaPoints and no match.
  fs::path Fresh(const std::string& name) const {
    fs::copy_file(folder_ / "features.db", folder_ / name, fs::copy_options::overwrite_existing);
    return folder_ / name;
  }

  static CliResult Match(const fs::path& database, const std::vector<std::string>& more = {},
                         const CliOptions& options = {}) {
    std::vector<std::string> arguments = {"sequential_matcher", "--database_path",
                                          database.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (more.empty()) arguments.insert(arguments.end(), {"--SequentialMatching.overlap", "1"});
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  // Of all verified pairs, how far apart the pictures stand in the strip.
  static std::multiset<int> Distances(const fs::path& path) {
    const ColmapDatabase database(path, ColmapDatabase::Mode::kReadOnly);
    std::multiset<int> distances;
    for (const ImagePair& pair : ReadVerifiedPairs(database)) {
      distances.insert(static_cast<int>(pair.second) - static_cast<int>(pair.first));
    }
    return distances;
  }

  TemporaryFolder folder_;
};

TEST_F(LoopDetection, FindsWhatOverlapsAndNothingElse) {
  const fs::path with = Fresh("with.db"), without = Fresh("without.db");
  ASSERT_EQ(Match(with).exit_code, 0);
  ASSERT_EQ(Match(without,
                  {"--SequentialMatching.overlap", "1", "--SequentialMatching.loop_detection", "0"})
                .exit_code,
            0);
  EXPECT_EQ(Distances(without).size(), static_cast<size_t>(kNumPictures - 1));
  const auto distances = Distances(with);
  EXPECT_EQ(distances.count(1), static_cast<size_t>(kNumPictures - 1));
  EXPECT_EQ(distances.count(2), static_cast<size_t>(kNumPictures - 2));
  EXPECT_EQ(distances.count(3), static_cast<size_t>(kNumPictures - 3));
  EXPECT_LT(*distances.rbegin(), 5) << "five steps apart, the pictures share nothing";
}

TEST_F(LoopDetection, SameForAnyNumberOfThreads) {
  const fs::path one = Fresh("one.db"), many = Fresh("many.db");
  ASSERT_EQ(Match(one, {"--SequentialMatching.overlap", "1", "--num_threads", "1"}).exit_code, 0);
  ASSERT_EQ(Match(many, {"--SequentialMatching.overlap", "1", "--num_threads", "5"}).exit_code, 0);
  EXPECT_EQ(Dump(one), Dump(many));
}

TEST_F(LoopDetection, TheSameCommandAgainDoesNothing) {
  const fs::path database = Fresh("again.db");
  EXPECT_NE(Match(database).err.find(kFound), std::string::npos);
  const auto rows = Dump(database);
  const CliResult again = Match(database);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.err.find(kFound), std::string::npos) << again.err;
  EXPECT_EQ(Dump(database), rows);
}

TEST_F(LoopDetection, KilledAtManyMoments) {
  const fs::path whole = Fresh("whole.db");
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Match(whole).exit_code, 0);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  constexpr int kNumKills = 12;
  int num_killed = 0;
  for (int i = 1; i <= kNumKills; ++i) {
    const fs::path database = Fresh("killed" + std::to_string(i) + ".db");
    CliOptions options;
    const double moment = seconds * i / (kNumKills + 1);
    options.kill_when = [&](double now) { return now > moment; };
    num_killed += Match(database, {}, options).signal_number == SIGKILL ? 1 : 0;
    ASSERT_EQ(Match(database).exit_code, 0);
    EXPECT_EQ(Dump(database), Dump(whole)) << "killed after " << moment << " s";
  }
  EXPECT_GE(num_killed, kNumKills / 3);
}

TEST_F(LoopDetection, AChangedPictureGivesWhatAFreshRunGives) {
  const fs::path changed = Fresh("changed.db");
  ASSERT_EQ(Match(changed).exit_code, 0);
  WriteImage(folder_ / "images" / "img5.png", StripPicture(15));
  ASSERT_EQ(Extract("changed.db").exit_code, 0);
  ASSERT_EQ(Match(changed).exit_code, 0);
  ASSERT_EQ(Extract("features.db").exit_code, 0);
  const fs::path fresh = Fresh("fresh.db");
  ASSERT_EQ(Match(fresh).exit_code, 0);
  EXPECT_EQ(Dump(changed), Dump(fresh));
}

TEST_F(LoopDetection, AnotherOverlapGivesWhatAFreshRunGives) {
  const std::vector<std::string> wider = {"--SequentialMatching.overlap", "2"};
  const fs::path changed = Fresh("changed.db"), fresh = Fresh("fresh.db");
  ASSERT_EQ(Match(changed).exit_code, 0);
  ASSERT_EQ(Match(changed, wider).exit_code, 0);
  ASSERT_EQ(Match(fresh, wider).exit_code, 0);
  EXPECT_EQ(Dump(changed), Dump(fresh));
}

TEST_F(LoopDetection, WhatOtherMatchersWroteStays) {
  const fs::path database = Fresh("all.db");
  ASSERT_EQ(
      RunProgram(SEAPOINT_PROGRAM, {"exhaustive_matcher", "--database_path", database.string()})
          .exit_code,
      0);
  const auto rows = Dump(database);
  ASSERT_EQ(Match(database).exit_code, 0);
  ASSERT_EQ(Match(database, {"--SequentialMatching.overlap", "2"}).exit_code, 0);
  EXPECT_EQ(Dump(database), rows);
}

TEST_F(LoopDetection, ADamagedListIsAnError) {
  const fs::path database = Fresh("damaged.db");
  ASSERT_EQ(Match(database).exit_code, 0);
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(database.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "UPDATE seapoint_loop_pairs SET data = x'0102030405060708'", nullptr,
                         nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(db);
  const CliResult result = Match(database);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("seapoint_loop_pairs"), std::string::npos) << result.Text();
}

TEST_F(LoopDetection, OnePictureIsNoReasonToFail) {
  fs::remove_all(folder_ / "images");
  WriteStrip(folder_ / "images", 1);
  ASSERT_EQ(Extract("one.db").exit_code, 0);
  EXPECT_EQ(Match(folder_ / "one.db").exit_code, 0);
}

}  // namespace
}  // namespace colmap_seapoint
