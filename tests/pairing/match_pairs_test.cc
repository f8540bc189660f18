// From pairs to rows: what is matched, what is left alone, what is said.
#include "colmap_seapoint/pairing/match_pairs.h"

#include <algorithm>
#include <random>

#include "colmap_seapoint/pairing/loop_pairs.h"
#include "tests/io/database_calls.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

constexpr int kNumPoints = 120;

// Pictures of one scene: points in space, each with a descriptor of its own, seen by cameras that
// stand side by side.
class MatchPairsTest : public testing::Test {
 protected:
  MatchPairsTest() : camera_(MakeCamera(CameraModel::kPinhole, 800, 640, 480)) {
    camera_id_ = AddCamera(&database_, camera_);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < kNumPoints; ++i) {
      points_.emplace_back(1.2 * uniform(random), 0.8 * uniform(random), 4 + uniform(random));
      Descriptor descriptor;
      for (uint8_t& byte : descriptor) byte = static_cast<uint8_t>(random());
      descriptors_.push_back(descriptor);
    }
  }

  // A picture taken `x` to the right of the first; of another scene where it is far off.
  uint32_t AddPicture(const std::string& name, double x) {
    Features features;
    for (size_t i = 0; i < points_.size(); ++i) {
      const auto pixel = camera_.ImgFromCam(points_[i] - Eigen::Vector3d(x, 0, 0));
      if (!pixel || !camera_.InImage(*pixel)) continue;
      SeaPoint point;
      point.x = static_cast<float>(pixel->x());
      point.y = static_cast<float>(pixel->y());
      features.points.push_back(point);
      features.descriptors.push_back(descriptors_[i]);
    }
    const uint32_t id = AddImage(&database_, name, camera_id_);
    WriteFeatures(&database_, id, features, "picture");
    return id;
  }

  void Match(const std::vector<ImagePair>& pairs, double min_overlap_share = 0, int threads = 1) {
    report_ = RunReport();
    MatchPairs(pairs, options_, asked_, min_overlap_share, threads, &database_, &report_);
  }

  TempDir dir_;
  const std::filesystem::path path_ = dir_ / "matches.db";
  ColmapDatabase database_{path_, ColmapDatabase::Mode::kCreateIfMissing};
  const Camera camera_;
  uint32_t camera_id_ = 0;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> descriptors_;
  SeaPointMatchingOptions options_;
  std::string asked_ = "as at first";
  RunReport report_;
};

TEST_F(MatchPairsTest, APairOfOneSceneIsVerified) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.2);
  Match({{a, b}});
  EXPECT_EQ(ReadVerifiedPairs(database_), (std::vector<ImagePair>{{a, b}}));
  EXPECT_GT(ReadTwoViewGeometry(database_, {a, b}).inliers.size(), 50u);
  EXPECT_EQ(report_.pairs, 1);
}

TEST_F(MatchPairsTest, APairThatFailsHasARowToo) {
  const uint32_t a = AddPicture("a", 0);
  const uint32_t other = AddImage(&database_, "other", camera_id_);
  WriteFeatures(&database_, other, MakeFeatures(100, 77), "picture");
  const uint32_t empty = AddImage(&database_, "empty", camera_id_);
  WriteFeatures(&database_, empty, Features(), "picture");
  Match({{a, other}, {a, empty}});
  EXPECT_TRUE(HasMatches(database_, {a, other}));
  EXPECT_TRUE(HasMatches(database_, {a, empty}));
  EXPECT_TRUE(ReadVerifiedPairs(database_).empty());
}

TEST_F(MatchPairsTest, RowsThatAreThereStay) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.2), c = AddPicture("c", 0.4);
  WriteMatches(&database_, a, b, {{0, 1}, {1, 0}}, MakeGeometry({{0, 1}}));
  Match({{a, b}, {b, c}});
  EXPECT_EQ(ReadMatches(database_, {a, b}).size(), 2u);
  EXPECT_GT(ReadMatches(database_, {b, c}).size(), 50u);
  EXPECT_EQ(report_.pairs, 2);
}

TEST_F(MatchPairsTest, PairsThatWereMatchedWithOtherOptionsAreMatchedAgain) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.2), c = AddPicture("c", 0.4);
  WriteMatches(&database_, a, c, {{0, 1}, {1, 0}}, MakeGeometry({{0, 1}}));  // somebody else's
  Match({{a, b}, {a, c}});
  Match({{a, b}});
  const size_t num_verified = ReadTwoViewGeometry(database_, {a, b}).inliers.size();
  ASSERT_GT(num_verified, 0u);
  options_.verification.min_num_inliers = static_cast<int>(num_verified) + 1;
  Match({{a, b}});  // asked for the same
  EXPECT_FALSE(ReadVerifiedPairs(database_).empty());
  asked_ = "more inliers";
  Match({{a, b}, {a, c}});
  EXPECT_TRUE(ReadTwoViewGeometry(database_, {a, b}).inliers.empty());
  EXPECT_EQ(ReadMatches(database_, {a, c}).size(), 2u);
  EXPECT_EQ(PairsMatchedOtherwise(database_, asked_), std::set<ImagePair>());
  EXPECT_EQ(PairsMatchedOtherwise(database_, "less"), (std::set<ImagePair>{{a, b}}));
}

TEST_F(MatchPairsTest, ThreadsChangeNothing) {
  std::vector<uint32_t> ids;
  for (int i = 0; i < 9; ++i) ids.push_back(AddPicture(std::to_string(i), 0.1 * i));
  std::vector<ImagePair> pairs;
  for (size_t i = 0; i < ids.size(); ++i) {
    for (size_t j = i + 1; j < ids.size(); ++j) pairs.emplace_back(ids[i], ids[j]);
  }
  Match(pairs, 0, 1);
  const char* sql = "SELECT * FROM two_view_geometries, matches USING (pair_id) ORDER BY pair_id";
  const std::vector<std::string> rows = Query(path_, sql);
  EXPECT_EQ(rows.size(), 36u);
  Execute(path_, "DELETE FROM two_view_geometries; DELETE FROM matches");
  Match(pairs, 0, 3);
  EXPECT_EQ(Query(path_, sql), rows);
}

TEST_F(MatchPairsTest, InliersMustShareAsMuchAsIsAskedFor) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.8);
  Match({{a, b}}, 1.1);  // more than all
  EXPECT_TRUE(ReadVerifiedPairs(database_).empty());
  EXPECT_GT(ReadMatches(database_, {a, b}).size(), 20u);  // the raw matches are kept
}

TEST_F(MatchPairsTest, ACameraThatIsMissingIsAnError) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.2);
  Execute(path_, "PRAGMA foreign_keys = OFF; DELETE FROM cameras");
  EXPECT_ERROR(Match({{a, b}}), "its camera 1 is not in the database");
}

TEST_F(MatchPairsTest, PicturesWithoutSeaPointsAreLeftOut) {
  EXPECT_ERROR(ImagesWithSeaPoints(path_.string(), database_, &report_),
               "none of its 0 images has SeaPoints");
  const uint32_t a = AddPicture("a", 0);
  AddImage(&database_, "bare", camera_id_);
  const auto images = ImagesWithSeaPoints(path_.string(), database_, &report_);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images[0].image_id, a);
  EXPECT_EQ(report_.images_in, 2);
  EXPECT_EQ(report_.images_used, 1);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_EQ(report_.left_out[0].name, "bare");
}

TEST_F(MatchPairsTest, LonelyPicturesAreNamed) {
  const uint32_t a = AddPicture("a", 0), b = AddPicture("b", 0.2);
  for (int i = 1; i <= 7; ++i) AddPicture("lonely" + std::to_string(i), 50);
  Match({{a, b}});
  testing::internal::CaptureStderr();
  WarnOfLonelyImages(database_, ReadImages(database_));
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("7 of 9 pictures match no other one: lonely1 lonely2 lonely3 lonely4 lonely5 "
                      "..."),
            std::string::npos)
      << said;
  testing::internal::CaptureStderr();
  WarnOfLonelyImages(database_, {ReadImages(database_)[0], ReadImages(database_)[1]});
  WarnOfLonelyImages(database_, {ReadImages(database_)[5]});  // nobody to match it with
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(DemandingOptionsTest, AtLeastThirtyInliers) {
  SeaPointMatchingOptions options;
  options.verification.min_num_inliers = 15;
  EXPECT_EQ(DemandingOptions(options).verification.min_num_inliers, 30);
  options.verification.min_num_inliers = 45;
  EXPECT_EQ(DemandingOptions(options).verification.min_num_inliers, 45);
}

// There and back over the same ground: picture i looks like picture 2n - 1 - i.
class LoopPairsTest : public MatchPairsTest {
 protected:
  static constexpr int kOneWay = 12;

  LoopPairsTest() {
    std::mt19937 random(5);
    for (int i = 0; i < 2 * kOneWay; ++i) {
      const int place = i < kOneWay ? i : 2 * kOneWay - 1 - i;
      Features features = MakeFeatures(150, 100 + static_cast<unsigned>(place));
      for (SeaPoint& point : features.points) point.scale = 1;  // of one level
      const uint32_t id = AddImage(&database_, "img" + std::to_string(i) + ".jpg", camera_id_);
      WriteFeatures(&database_, id, features, "picture");
    }
    sequence_ = ReadImages(database_);
    search_.overlap = 3;
    search_.num_images = 4;
    search_.run.num_threads = 2;
  }

  std::vector<DatabaseImage> sequence_;
  LoopSearch search_;
};

TEST_F(LoopPairsTest, LookAlikesBeyondTheSequence) {
  const auto pairs = FindLoopPairs(sequence_, search_, &database_);
  ASSERT_FALSE(pairs.empty());
  int num_true = 0;
  for (const auto& [a, b] : pairs) {
    EXPECT_GT(b - a, 3u);
    num_true += (a - 1) + (b - 1) == 2 * kOneWay - 1 ? 1 : 0;
  }
  EXPECT_GE(num_true, kOneWay - 3);  // but for those within the overlap
  EXPECT_EQ(ReadLoopPairs(database_), pairs);
  // The same call again reads the list, whatever the number of threads.
  search_.run.num_threads = 1;
  EXPECT_EQ(FindLoopPairs(sequence_, search_, &database_), pairs);
}

TEST_F(LoopPairsTest, PairsThatHaveARowAlreadyAreNotAmongThem) {
  const ImagePair taken = {1, 2 * kOneWay};
  WriteMatches(&database_, taken.first, taken.second, {{0, 0}}, MakeGeometry({{0, 0}}));
  const auto pairs = FindLoopPairs(sequence_, search_, &database_);
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), taken), 0);
  EXPECT_FALSE(pairs.empty());
}

}  // namespace
}  // namespace colmap_seapoint
