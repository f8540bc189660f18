#include "colmap_seapoint/pictures/model_pictures.h"

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

// Four pictures of ours in the database, whose ids run against the order of the model; the pair
// (a, b) is verified, (a, c) is verified and failed, (b, c) only matched, (c, d) not even that.
class ModelPicturesTest : public testing::Test {
 protected:
  ModelPicturesTest() : path_(dir_ / "database.db") {
    ColmapDatabase database(path_, ColmapDatabase::Mode::kCreateIfMissing);
    const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 640, 480);
    const uint32_t camera_id = AddCamera(&database, camera);
    for (const std::string name : {"d", "c", "b", "a"}) {
      ids_[name] = AddImage(&database, name, camera_id);
      WriteFeatures(&database, ids_[name], MakeFeatures(9, ids_[name]), "picture");
    }
    WriteMatches(&database, ids_["a"], ids_["b"], {{1, 2}, {3, 4}, {5, 6}},
                 MakeGeometry({{1, 2}, {5, 6}}));
    TwoViewGeometry failed;  // as our matchers say it
    failed.config = TwoViewConfig::kDegenerate;
    WriteMatches(&database, ids_["a"], ids_["c"], {{7, 8}}, failed);
    WriteMatches(&database, ids_["b"], ids_["c"], {{0, 8}, {2, 1}}, TwoViewGeometry());
    Execute(path_,
            "DELETE FROM two_view_geometries WHERE pair_id = (SELECT pair_id FROM matches "
            "WHERE rows = 2)");
    model_.cameras[1] = camera;
    for (const std::string name : {"a", "b", "c", "d", "not in the database"}) {
      PosedImage image;
      image.camera_id = 1;
      image.name = name;
      model_.images.push_back(image);
    }
  }

  ModelPictures Open() {
    database_.emplace(path_, ColmapDatabase::Mode::kReadOnly);
    return ModelPictures(model_, dir_.Path(), PictureMasks(""), &*database_, {}, {});
  }

  TempDir dir_;
  std::filesystem::path path_;
  std::map<std::string, uint32_t> ids_;
  SparseModel model_;
  std::optional<ColmapDatabase> database_;
};

TEST_F(ModelPicturesTest, VerifiedMatchesInTheOrderAskedFor) {
  ModelPictures pictures = Open();
  EXPECT_EQ(pictures.ReadMatches(0, 1), (FeatureMatches{{1, 2}, {5, 6}}));
  EXPECT_EQ(pictures.ReadMatches(1, 0), (FeatureMatches{{2, 1}, {6, 5}}));
}

TEST_F(ModelPicturesTest, AFailedVerificationIsAnAnswerAndNoVerificationIsNone) {
  ModelPictures pictures = Open();
  EXPECT_EQ(pictures.ReadMatches(0, 2), FeatureMatches());
  EXPECT_EQ(pictures.ReadMatches(1, 2), (FeatureMatches{{0, 8}, {2, 1}}));
  EXPECT_EQ(pictures.ReadMatches(2, 1), (FeatureMatches{{8, 0}, {1, 2}}));
  EXPECT_EQ(pictures.ReadMatches(2, 3), std::nullopt);
  EXPECT_EQ(pictures.ReadMatches(0, 4), std::nullopt);
}

TEST_F(ModelPicturesTest, DescribesTheBytesThatItRead) {
  ModelPictures pictures = Open();
  const auto replace = [&](const char* name, uint8_t grey) {
    GrayImage image(640, 480);
    std::fill(image.data.begin(), image.data.end(), grey);
    WriteImage(dir_ / "new.png", image);
    std::filesystem::rename(dir_ / "new.png", dir_ / name);
    return HashFile(dir_ / name);
  };
  const std::string first = replace("a", 10), of_b = replace("b", 20);
  pictures.ReadPicture(0);
  EXPECT_NE(replace("a", 20), first);
  EXPECT_EQ(pictures.Describe(0).name, "a");
  EXPECT_EQ(pictures.Describe(0).hash, first);
  EXPECT_EQ(pictures.Describe(1).hash, of_b);  // never read: as it is now
  EXPECT_EQ(pictures.Describe(1).size, std::filesystem::file_size(dir_ / "b"));
  EXPECT_EQ(pictures.Describe(2).hash, "");  // no file
}

TEST_F(ModelPicturesTest, SeaPointsOfTheDatabaseOrNone) {
  ModelPictures pictures = Open();
  ExpectSameFeatures(pictures.ReadSeaPoints(1), MakeFeatures(9, ids_["b"]));
  EXPECT_EQ(pictures.ReadSeaPoints(4), std::nullopt);
  EXPECT_EQ(pictures.NumInDatabase(), 4);
  ModelPictures without(model_, dir_.Path(), PictureMasks(""), nullptr, {}, {});
  EXPECT_EQ(without.ReadSeaPoints(1), std::nullopt);
  EXPECT_EQ(without.ReadMatches(0, 1), std::nullopt);
}

// paper 4, hybrid resolution: they were found in 640 x 480.
TEST_F(ModelPicturesTest, SeaPointsFollowTheSizeOfTheModelsCamera) {
  const Features stored = MakeFeatures(9, ids_["b"]);
  model_.cameras[1] = MakeCamera(CameraModel::kPinhole, 1500, 1920, 1440);
  const Features scaled = Open().ReadSeaPoints(1).value();
  ASSERT_EQ(scaled.points.size(), stored.points.size());
  for (size_t i = 0; i < stored.points.size(); ++i) {
    EXPECT_FLOAT_EQ(scaled.points[i].x, 3 * stored.points[i].x);
    EXPECT_FLOAT_EQ(scaled.points[i].y, 3 * stored.points[i].y);
    EXPECT_FLOAT_EQ(scaled.points[i].scale, 3 * stored.points[i].scale);
    EXPECT_EQ(scaled.points[i].orientation, stored.points[i].orientation);
  }
  EXPECT_EQ(scaled.descriptors, stored.descriptors);
  model_.cameras[1] = MakeCamera(CameraModel::kPinhole, 1500, 1920, 1080);
  EXPECT_EQ(Open().NumInDatabase(), 0);
  EXPECT_EQ(Open().ReadSeaPoints(1), std::nullopt);
  EXPECT_EQ(Open().ReadMatches(0, 1), std::nullopt);
}

// Indices of other software's keypoints are not ours.
TEST_F(ModelPicturesTest, MatchesOfReplacedKeypointsAreNotUsed) {
  Execute(path_, "UPDATE keypoints SET data = zeroblob(144) WHERE image_id = " +
                     std::to_string(ids_["b"]));
  ModelPictures pictures = Open();
  EXPECT_EQ(pictures.ReadMatches(0, 1), std::nullopt);
  EXPECT_EQ(pictures.ReadMatches(1, 0), std::nullopt);
  EXPECT_EQ(pictures.ReadSeaPoints(1), std::nullopt);
  EXPECT_EQ(pictures.ReadMatches(0, 2), FeatureMatches());
}

TEST_F(ModelPicturesTest, DamagedMatchesAreAsGoodAsNone) {
  Execute(path_,
          "UPDATE two_view_geometries SET data = x'ffffffff00000000', rows = 1 "
          "WHERE rows = 2");
  ModelPictures pictures = Open();
  EXPECT_EQ(pictures.ReadMatches(0, 1), std::nullopt);
  EXPECT_EQ(pictures.ReadMatches(0, 2), FeatureMatches());
}

}  // namespace
}  // namespace colmap_seapoint
