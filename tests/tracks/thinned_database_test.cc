// The copy that the mapper gets: same pictures and keypoints, fewer matches, nothing untied.
#include "colmap_seapoint/tracks/thinned_database.h"

#include <random>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

constexpr int kNumPoints = 3000;  // that all pictures show

class ThinnedDatabaseTest : public testing::Test {
 protected:
  ThinnedDatabaseTest() {
    camera_ = MakeCamera(CameraModel::kPinhole, 800, 640, 480);
    camera_.camera_id = AddCamera(&database_, camera_);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> x(0, 640), y(0, 480);
    for (int i = 0; i < kNumPoints; ++i) {
      SeaPoint point;
      point.x = x(random);
      point.y = y(random);
      features_.points.push_back(point);
    }
    features_.descriptors.resize(kNumPoints);
  }

  uint32_t AddPicture(const std::string& name) {
    const uint32_t id = AddImage(&database_, name, camera_.camera_id);
    WriteFeatures(&database_, id, features_, "picture");
    return id;
  }

  // Keypoint i matches i, for `count` of them from `begin` on.
  void Tie(uint32_t id1, uint32_t id2, uint32_t begin, uint32_t count) {
    TwoViewGeometry geometry;
    geometry.config = TwoViewConfig::kUncalibrated;
    geometry.F = Eigen::Matrix3d::Identity();
    for (uint32_t i = begin; i < begin + count; ++i) geometry.inliers.push_back({i, i});
    WriteMatches(&database_, id1, id2, geometry.inliers, geometry);
  }

  size_t MatchesOfCopy(ImagePair pair) {
    const ColmapDatabase copy(copy_, ColmapDatabase::Mode::kReadOnly);
    return ReadTwoViewGeometry(copy, pair).inliers.size();
  }

  TempDir dir_;
  const std::filesystem::path copy_ = dir_ / "thin.db";
  ColmapDatabase database_{dir_ / "all.db", ColmapDatabase::Mode::kCreateIfMissing};
  Camera camera_;
  Features features_;
};

TEST_F(ThinnedDatabaseTest, KeepsPicturesAndKeypointsAndAFewHundredMatchesAPair) {
  const uint32_t a = AddPicture("a.jpg"), b = AddPicture("b.jpg"), c = AddPicture("c.jpg");
  Tie(a, b, 0, 2000);
  Tie(b, c, 0, 3000);
  const Thinning thinning = WriteThinnedDatabase(database_, {256, 40}, copy_);
  EXPECT_EQ(thinning.num_matches, 5000);
  EXPECT_LT(thinning.num_chosen_matches, 1000);
  const ColmapDatabase copy(copy_, ColmapDatabase::Mode::kReadOnly);
  EXPECT_EQ(ReadImages(copy).size(), 3u);
  EXPECT_EQ(ReadKeypointPlaces(copy, c).size(), static_cast<size_t>(kNumPoints));
  const TwoViewGeometry geometry = ReadTwoViewGeometry(copy, {a, b});
  EXPECT_EQ(geometry.config, TwoViewConfig::kUncalibrated);
  EXPECT_TRUE(geometry.F.has_value());
  EXPECT_GT(geometry.inliers.size(), 128u);
  EXPECT_LT(geometry.inliers.size(), 512u);
  EXPECT_EQ(ReadMatches(copy, {a, b}).size(), geometry.inliers.size());
}

TEST_F(ThinnedDatabaseTest, TheOriginalStaysAsItWas) {
  const uint32_t a = AddPicture("a.jpg"), b = AddPicture("b.jpg");
  Tie(a, b, 0, 2000);
  WriteThinnedDatabase(database_, {}, copy_);
  EXPECT_EQ(ReadTwoViewGeometry(database_, {a, b}).inliers.size(), 2000u);
}

// Strips that are tied by a few short tracks only, beside long ones by the thousand.
TEST_F(ThinnedDatabaseTest, AWeakPairKeepsWhatTiesIt) {
  const uint32_t a = AddPicture("a.jpg"), b = AddPicture("b.jpg"), c = AddPicture("c.jpg");
  const uint32_t d = AddPicture("d.jpg"), e = AddPicture("e.jpg"), f = AddPicture("f.jpg");
  Tie(a, b, 0, 2500);
  Tie(b, c, 0, 2500);
  Tie(d, e, 0, 2500);
  Tie(e, f, 0, 2500);
  Tie(a, d, 2600, 35);
  Tie(b, e, 2700, 200);
  WriteThinnedDatabase(database_, {128, 40}, copy_);
  EXPECT_EQ(MatchesOfCopy({a, d}), 35u);
  EXPECT_GE(MatchesOfCopy({b, e}), 40u);
}

TEST_F(ThinnedDatabaseTest, AnOldCopyIsReplaced) {
  const uint32_t a = AddPicture("a.jpg"), b = AddPicture("b.jpg");
  Tie(a, b, 0, 100);
  WriteThinnedDatabase(database_, {}, copy_);
  const uint32_t c = AddPicture("c.jpg");
  Tie(b, c, 0, 50);
  WriteThinnedDatabase(database_, {}, copy_);
  EXPECT_EQ(MatchesOfCopy({b, c}), 50u);
}

TEST_F(ThinnedDatabaseTest, ACopyThatCannotBeWrittenIsAnError) {
  AddPicture("a.jpg");
  EXPECT_THROW(WriteThinnedDatabase(database_, {}, dir_ / "missing" / "thin.db"), Error);
}

TEST_F(ThinnedDatabaseTest, DamagedKeypointsAreAnError) {
  AddPicture("a.jpg");
  database_.Finish();
  Execute(dir_ / "all.db", "UPDATE keypoints SET rows = rows + 1");
  EXPECT_THROW(WriteThinnedDatabase(database_, {}, copy_), Error);
}

TEST_F(ThinnedDatabaseTest, ACalibrationOfTheCopyOnly) {
  AddPicture("a.jpg");
  WriteThinnedDatabase(database_, {}, copy_);
  ColmapDatabase copy(copy_, ColmapDatabase::Mode::kReadWrite);
  Camera known = camera_;
  known.params[0] = 777;
  SetCalibration(&copy, known);
  EXPECT_EQ(ReadCameras(copy).begin()->second.params[0], 777);
  EXPECT_TRUE(ReadCameras(copy).begin()->second.has_prior_focal_length);
  EXPECT_EQ(ReadCameras(database_).begin()->second.params[0], 800);
}

}  // namespace
}  // namespace colmap_seapoint
