#include "colmap_seapoint/pipeline/match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/database_tables.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Pairs = std::set<ImagePair>;

class Match : public StripSurvey {
 protected:
  // "<name>.png" shows place `index` of the strip.
  void Extract(const std::vector<std::pair<std::string, int>>& pictures) const {
    fs::create_directories(Images());
    for (const auto& [name, index] : pictures) {
      WriteImage(Images() / (name + ".png"), StripPicture(index));
    }
    RunFeatureExtractor(ExtractorOptions());
  }

  SequentialMatcherOptions Sequential(int overlap) const {
    SequentialMatcherOptions options;
    options.database_path = DatabasePath().string();
    options.pairs.overlap = overlap;
    options.pairs.loop_detection = false;
    return options;
  }
  SpatialMatcherOptions Spatial(const std::string& positions) const {
    SpatialMatcherOptions options;
    options.database_path = DatabasePath().string();
    options.pairs.positions_path = Write("positions.csv", positions);
    options.pairs.max_num_neighbors = 1;
    return options;
  }

  // Pairs with a row, whether they were verified or not.
  Pairs Rows(const std::string& table = "two_view_geometries") const {
    constexpr int64_t kMaxImages = 2147483647;  // COLMAP's pair_id = id1 * kMaxImages + id2
    Pairs pairs;
    for (const std::string& row : QueryRows(DatabasePath(), "SELECT pair_id FROM " + table)) {
      const int64_t pair_id = std::stoll(row);
      pairs.insert({static_cast<uint32_t>(pair_id / kMaxImages),
                    static_cast<uint32_t>(pair_id % kMaxImages)});
    }
    return pairs;
  }
  Pairs Verified() const {
    const auto pairs = ReadVerifiedPairs(OpenDatabase());
    return {pairs.begin(), pairs.end()};
  }
};

TEST_F(Match, ExhaustiveTriesEveryPair) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(4));
  ColmapDatabase database = OpenDatabase();
  const RunReport report = MatchExhaustively(MatcherOptions(), &database);
  const Pairs all = {{1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  EXPECT_EQ(Rows(), all);
  EXPECT_EQ(Rows("matches"), all);
  EXPECT_EQ(report.command, "exhaustive_matcher");
  EXPECT_EQ(report.pairs, 6);
  EXPECT_EQ(report.images_in, 4);
  EXPECT_EQ(report.images_used, 4);
  ASSERT_EQ(report.stages.size(), 1u);
  EXPECT_EQ(report.stages[0].name, "exhaustive_matcher");
  const auto json =
      nlohmann::json::parse(ReadBytes(DatabasePath().string() + ".exhaustive_matcher.run.json"));
  EXPECT_EQ(json["pairs"], 6);
}

TEST_F(Match, MatchesShiftByTheStep) {
  ASSERT_NO_FATAL_FAILURE(MatchPicturesOf(2));
  const ColmapDatabase database = OpenDatabase();
  const auto geometry = ReadTwoViewGeometry(database, {1, 2});
  ASSERT_GT(geometry.inliers.size(), 100u);
  const Features first = *ReadFeatures(database, 1), second = *ReadFeatures(database, 2);
  for (const FeatureMatch& match : geometry.inliers) {
    EXPECT_NEAR(first.points[match.idx1].x - second.points[match.idx2].x, kStripStep, 0.5);
    EXPECT_NEAR(first.points[match.idx1].y - second.points[match.idx2].y, 0, 0.5);
  }
}

TEST_F(Match, SequentialTriesTheNextOnes) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(5));
  ColmapDatabase database = OpenDatabase();
  EXPECT_EQ(MatchSequentially(Sequential(1), &database).pairs, 4);
  EXPECT_EQ(Rows(), (Pairs{{1, 2}, {2, 3}, {3, 4}, {4, 5}}));
  EXPECT_EQ(MatchSequentially(Sequential(2), &database).pairs, 7);
  EXPECT_EQ(Rows(), (Pairs{{1, 2}, {2, 3}, {3, 4}, {4, 5}, {1, 3}, {2, 4}, {3, 5}}));
  EXPECT_EQ(Rows("matches"), Rows());
}

TEST_F(Match, TheSequenceIsInNaturalOrder) {
  // Ids are by bytes: img1, img10, img2, img9.
  Extract({{"img1", 1}, {"img2", 2}, {"img9", 3}, {"img10", 4}});
  ColmapDatabase database = OpenDatabase();
  const auto ids = ImageIds(database);
  ASSERT_EQ(ids.at("img10.png"), 2u);
  MatchSequentially(Sequential(1), &database);
  EXPECT_EQ(Rows(), (Pairs{{1, 3}, {3, 4}, {2, 4}}));
  EXPECT_EQ(Verified(), Rows());
}

// Another place, into which a corner of the first picture is copied: both show it, but for all that
// they would have to share where it fits, they share little.
ColorImage PictureWithACorner() {
  constexpr int kSide = 120;
  ColorImage picture = StripPicture(20);
  const ColorImage first = StripPicture(1);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) picture.At(x, y, c) = first.At(x, y, c);
    }
  }
  return picture;
}

// The next picture is the track itself; one further on must earn its place.
TEST_F(Match, FurtherPairsMustShareMore) {
  Extract({{"img1", 1}, {"img3", 2}});
  WriteImage(Images() / "img2.png", PictureWithACorner());
  RunFeatureExtractor(ExtractorOptions());
  ColmapDatabase database = OpenDatabase();
  const auto ids = ImageIds(database);
  const ImagePair pair = {ids.at("img1.png"), ids.at("img2.png")};
  MatchSequentially(Sequential(1), &database);
  EXPECT_EQ(Verified().count(pair), 1u);
  ASSERT_GE(ReadTwoViewGeometry(database, pair).inliers.size(), 30u);  // as further pairs need
  // The same two, with a picture between them in the sequence; or tried for being there at all.
  for (const bool is_exhaustive : {false, true}) {
    ExecuteSql(DatabasePath(), "DELETE FROM matches");
    ExecuteSql(DatabasePath(), "DELETE FROM two_view_geometries");
    ExecuteSql(DatabasePath(), "UPDATE images SET name = 'img4.png' WHERE name = 'img2.png'");
    is_exhaustive ? MatchExhaustively(MatcherOptions(), &database)
                  : MatchSequentially(Sequential(2), &database);
    EXPECT_EQ(Rows().count(pair), 1u) << is_exhaustive;
    EXPECT_EQ(Verified().count(pair), 0u) << is_exhaustive;
  }
}

TEST_F(Match, EveryPictureIsTriedWithThoseBehindIt) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(6));
  ColmapDatabase database = OpenDatabase();
  MatchSequentially(Sequential(5), &database);
  EXPECT_EQ(Rows().size(), 15u);
  const Pairs verified = Verified();
  for (uint32_t id = 1; id < 6; ++id) EXPECT_EQ(verified.count({id, id + 1}), 1u) << id;
  EXPECT_EQ(verified.count({1, 6}), 0u);  // shares nothing
}

TEST_F(Match, LoopsAreAddedToTheSequence) {
  // There and back again.
  Extract({{"img01", 1},
           {"img02", 2},
           {"img03", 3},
           {"img04", 4},
           {"img05", 5},
           {"img06", 6},
           {"img07", 6},
           {"img08", 5},
           {"img09", 4},
           {"img10", 3},
           {"img11", 2},
           {"img12", 1}});
  ColmapDatabase database = OpenDatabase();
  SequentialMatcherOptions options = Sequential(1);
  options.pairs.loop_detection = true;
  const RunReport report = MatchSequentially(options, &database);
  const auto loops = ReadLoopPairs(database);
  Pairs expected(loops.begin(), loops.end());
  EXPECT_EQ(expected.count({3, 10}), 1u);
  for (uint32_t id = 1; id < 12; ++id) expected.insert({id, id + 1});
  EXPECT_EQ(Rows(), expected);
  EXPECT_EQ(Verified().count({3, 10}), 1u);
  std::vector<std::string> stages;
  for (const RunReport::Stage& stage : report.stages) stages.push_back(stage.name);
  EXPECT_EQ(stages, (std::vector<std::string>{"loop_detection", "sequential_matcher"}));
}

TEST_F(Match, SpatialTriesTheNearest) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(4));
  ColmapDatabase database = OpenDatabase();
  // Two by two, the first of each nearer to its own other.
  const RunReport report = MatchSpatially(
      Spatial("image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,50,0,0\nimg4.png,51,0,0\n"),
      &database);
  EXPECT_EQ(report.command, "spatial_matcher");
  EXPECT_EQ(Rows(), (Pairs{{1, 2}, {3, 4}}));
  EXPECT_TRUE(report.left_out.empty());
}

TEST_F(Match, SpatialLeavesOutWhatHasNoPlace) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(3));
  const SpatialMatcherOptions options = Spatial("image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\n");
  EXPECT_FALSE(RunSpatialMatcher(options).is_complete);
  EXPECT_EQ(Rows(), (Pairs{{1, 2}}));
  ColmapDatabase database = OpenDatabase();
  const RunReport report = MatchSpatially(options, &database);
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>{"img3.png"});
  EXPECT_ERROR(MatchSpatially(Spatial("image,x,y,z\nother.png,0,0,0\n"), &database), "survey.db");
}

TEST_F(Match, TheSameAgainHasNothingToDo) {
  ASSERT_NO_FATAL_FAILURE(MatchPicturesOf(4));
  const auto before = ReadTables(DatabasePath());
  bool is_complete = false;
  const std::string log =
      LogOf([&] { is_complete = RunExhaustiveMatcher(MatcherOptions()).is_complete; });
  EXPECT_TRUE(is_complete);
  EXPECT_NE(log.find("6 pairs were there already"), std::string::npos) << log;
  EXPECT_EQ(ReadTables(DatabasePath()), before);
  // Another matcher takes what is there, too.
  EXPECT_TRUE(RunSequentialMatcher(Sequential(3)).is_complete);
  EXPECT_EQ(ReadTables(DatabasePath()), before);
}

TEST_F(Match, OnlyPairsWithoutARowAreMatched) {
  ASSERT_NO_FATAL_FAILURE(MatchPicturesOf(3));
  const auto whole = ReadTables(DatabasePath());
  for (const char* table : {"matches", "two_view_geometries"}) {
    ExecuteSql(DatabasePath(), std::string("DELETE FROM ") + table +
                                   " WHERE pair_id % 2147483647 "
                                   "= 3");
  }
  ASSERT_EQ(Rows(), (Pairs{{1, 2}}));
  const std::string log = LogOf([&] { RunExhaustiveMatcher(MatcherOptions()); });
  EXPECT_NE(log.find("1 pairs were there already"), std::string::npos) << log;
  EXPECT_EQ(ReadTables(DatabasePath()), whole);
}

TEST_F(Match, TheSameRowsForAnyNumberOfThreads) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(4));
  fs::copy_file(DatabasePath(), folder_ / "other.db");
  ExhaustiveMatcherOptions options = MatcherOptions();
  options.run.num_threads = 1;
  RunExhaustiveMatcher(options);
  options.database_path = (folder_ / "other.db").string();
  options.run.num_threads = 3;
  RunExhaustiveMatcher(options);
  EXPECT_EQ(ReadTables(folder_ / "other.db"), ReadTables(DatabasePath()));
}

TEST_F(Match, LonelyPicturesAreNamed) {
  Extract({{"img1", 1}, {"img2", 2}, {"lonely", 20}});
  std::string log = LogOf([&] { RunExhaustiveMatcher(MatcherOptions()); });
  EXPECT_NE(log.find("1 of 3 pictures match no other one: lonely.png\n"), std::string::npos) << log;
  fs::remove(Images() / "lonely.png");
  fs::remove(DatabasePath());
  Extract({{"img1", 1}, {"img2", 2}});
  log = LogOf([&] { RunExhaustiveMatcher(MatcherOptions()); });
  EXPECT_EQ(log.find("match no other one"), std::string::npos) << log;
}

TEST_F(Match, ManyLonelyPicturesAreNamedInPart) {
  std::vector<std::pair<std::string, int>> pictures;
  for (int i = 0; i < 4; ++i) pictures.push_back({"img" + std::to_string(i), 1 + 6 * i});
  Extract(pictures);
  ColmapDatabase database = OpenDatabase();
  std::string log = LogOf([&] { MatchSequentially(Sequential(1), &database); });
  EXPECT_NE(log.find("4 of 4 pictures match no other one: img0.png img1.png img2.png img3.png\n"),
            std::string::npos)
      << log;
}

TEST_F(Match, PicturesWithoutSeaPointsAreLeftOut) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(3));
  ExecuteSql(DatabasePath(), "DELETE FROM seapoint_descriptors WHERE image_id = 2");
  ColmapDatabase database = OpenDatabase();
  const RunReport report = MatchExhaustively(MatcherOptions(), &database);
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>{"img2.png"});
  EXPECT_EQ(report.images_in, 3);
  EXPECT_EQ(report.images_used, 2);
  EXPECT_EQ(Rows(), (Pairs{{1, 3}}));
}

TEST_F(Match, NoSeaPointsAtAllIsAnError) {
  ASSERT_NO_FATAL_FAILURE(ExtractPicturesOf(2));
  ExecuteSql(DatabasePath(), "DELETE FROM seapoint_descriptors");
  ColmapDatabase database = OpenDatabase();
  const std::string remedy = "run colmap_seapoint feature_extractor on it first";
  EXPECT_ERROR(MatchExhaustively(MatcherOptions(), &database), remedy);
  EXPECT_ERROR(MatchSequentially(Sequential(1), &database), remedy);
  EXPECT_ERROR(MatchSpatially(Spatial("image,x,y,z\nimg1.png,0,0,0\n"), &database), remedy);
  EXPECT_EQ(Rows(), Pairs());
}

TEST_F(Match, ADatabaseMustBeThere) {
  EXPECT_ERROR(RunExhaustiveMatcher(MatcherOptions()), "survey.db");
  EXPECT_ERROR(RunSequentialMatcher(Sequential(1)), "survey.db");
  EXPECT_FALSE(fs::exists(DatabasePath()));
}

}  // namespace
}  // namespace colmap_seapoint
