// Round trips through the colmap binary that is installed.
#include <gtest/gtest.h>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/colmap_options.h"
#include "tests/io/test_database.h"
namespace colmap_seapoint {
namespace {

using Mode = ColmapDatabase::Mode;

class ColmapBinary : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasColmap()) GTEST_SKIP() << "colmap is not installed";
  }

  std::string Arguments() const { return " --database_path " + (dir_ / "a.db").string() + " "; }

  TempDir dir_;
};

TEST_F(ColmapBinary, ItsNewDatabaseIsOurs) {
  ASSERT_EQ(RunColmap("database_creator" + Arguments()), 0);
  ColmapDatabase db(dir_ / "a.db", Mode::kReadWrite);
  const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kOpenCV, 500, 640, 480));
  const uint32_t image_id = AddImage(&db, "a.png", camera_id);
  WriteFeatures(&db, image_id, MakeFeatures(10, 1), "p");
  ExpectSameFeatures(ReadFeatures(db, image_id), MakeFeatures(10, 1));
  ExpectSound(dir_ / "a.db");
}

TEST_F(ColmapBinary, OurDatabaseSurvivesItsTools) {
  std::filesystem::create_directory(dir_ / "images");
  {
    ColmapDatabase db(dir_ / "a.db", Mode::kCreateIfMissing);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kOpenCV, 120, 100, 80));
    for (const char* name : {"a.png", "b.png"}) {
      WriteImage(dir_ / (std::string("images/") + name), GrayImage(100, 80, 1, 90));
      const uint32_t image_id = AddImage(&db, name, camera_id);
      WriteFeatures(&db, image_id, MakeFeatures(30, image_id), "p");
    }
    WriteMatches(&db, 1, 2, {{1, 2}, {3, 4}}, MakeGeometry({{1, 2}}));
  }
  const auto rows = [&] {
    return Query(dir_ / "a.db", "SELECT * FROM keypoints, two_view_geometries, matches");
  };
  const auto before = rows();
  EXPECT_EQ(RunColmap("feature_extractor " + GpuOption("feature_extractor") + " 0 --image_path " +
                      (dir_ / "images").string() + Arguments()),
            0);
  EXPECT_EQ(RunColmap("exhaustive_matcher " + GpuOption("exhaustive_matcher") + " 0" + Arguments()),
            0);
  EXPECT_EQ(rows(), before);
  {
    const ColmapDatabase db(dir_ / "a.db", Mode::kReadWrite);
    EXPECT_EQ(ReadImages(db).size(), 2u);
    ExpectSameFeatures(ReadFeatures(db, 1), MakeFeatures(30, 1));
    EXPECT_EQ(ReadMatches(db, {1, 2}).size(), 2u);
  }
  ExpectSound(dir_ / "a.db");
  EXPECT_EQ(RunColmap("database_cleaner --type all" + Arguments()), 0);
  EXPECT_EQ(QueryOne(dir_ / "a.db", "SELECT count(*) FROM seapoint_descriptors"), "0");
  ColmapDatabase db(dir_ / "a.db", Mode::kReadWrite);
  EXPECT_TRUE(ReadImages(db).empty());
  EXPECT_TRUE(ReadVerifiedPairs(db).empty());
}

// SIFT lies where COLMAP keeps its own: its matcher finds what is the same in both pictures.
TEST_F(ColmapBinary, ItMatchesOurSift) {
  std::filesystem::create_directory(dir_ / "images");
  const Features features = MakeFeaturesWithSift(200, 1);
  {
    ColmapDatabase db(dir_ / "a.db", Mode::kCreateIfMissing);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kOpenCV, 800, 640, 480));
    for (const char* name : {"a.png", "b.png"}) {
      WriteImage(dir_ / (std::string("images/") + name), GrayImage(640, 480, 1, 90));
      WriteFeatures(&db, AddImage(&db, name, camera_id), features, "p");
    }
  }
  EXPECT_EQ(RunColmap("feature_extractor " + GpuOption("feature_extractor") + " 0 --image_path " +
                      (dir_ / "images").string() + Arguments()),
            0);
  EXPECT_EQ(RunColmap("exhaustive_matcher " + GpuOption("exhaustive_matcher") + " 0" + Arguments()),
            0);
  {
    const ColmapDatabase db(dir_ / "a.db", Mode::kReadWrite);
    ExpectSameFeatures(ReadFeatures(db, 1), features);
    const FeatureMatches matches = ReadMatches(db, {1, 2});
    EXPECT_GE(matches.size(), 190u);  // COLMAP's search is approximate
    for (const FeatureMatch& match : matches) EXPECT_EQ(match.idx1, match.idx2);
    EXPECT_GE(ReadTwoViewGeometry(db, {1, 2}).inliers.size(), 190u);
  }
  EXPECT_EQ(RunColmap("database_cleaner --type all" + Arguments()), 0);
  EXPECT_EQ(QueryOne(dir_ / "a.db", "SELECT count(*) FROM seapoint_descriptors"), "0");
  ExpectSound(dir_ / "a.db");
}

TEST_F(ColmapBinary, ItConvertsOurModels) {
  SparseModel model;
  Camera camera = MakeCamera(CameraModel::kOpenCV, 500.125, 640, 480);
  camera.camera_id = 1;
  model.cameras[1] = camera;
  PosedImage image;
  image.image_id = 1;
  image.camera_id = 1;
  image.name = "dive/a.jpg";
  image.cam_from_world.translation = Eigen::Vector3d(1.0 / 3.0, 2, 3);
  image.points2D = {Eigen::Vector2d(1.5, 2.5)};
  image.point3D_ids = {1};
  model.images = {image};
  model.points3D[1].xyz = Eigen::Vector3d(0.1, 0.2, 0.3);
  model.points3D[1].track = {{1, 0}};
  WriteSparseModelBinary(dir_ / "bin", model);
  WriteSparseModelText(dir_ / "txt", model);
  for (const std::string from : {"bin", "txt"}) {
    for (const std::string to : {"BIN", "TXT"}) {
      const auto output = dir_ / (from + "_to_" + to);
      std::filesystem::create_directory(output);
      ASSERT_EQ(RunColmap("model_converter --input_path " + (dir_ / from).string() +
                          " --output_path " + output.string() + " --output_type " + to),
                0);
      const SparseModel read = ReadSparseModel(output);
      ASSERT_EQ(read.images.size(), 1u);
      EXPECT_EQ(read.images[0].name, "dive/a.jpg");
      EXPECT_NEAR(read.images[0].cam_from_world.translation.x(), 1.0 / 3.0, 1e-15);
      EXPECT_EQ(read.cameras.at(1).params, camera.params);
      ASSERT_EQ(read.points3D.at(1).track.size(), 1u);
    }
  }
}

TEST_F(ColmapBinary, ItMeshesOurCloud) {
  {
    CloudWriter writer(dir_ / "fused.ply");
    for (int i = 0; i < 2000; ++i) {
      const double z = 1 - 2 * (i + 0.5) / 2000, angle = 2.399963 * i;
      CloudPoint point;
      point.normal = Eigen::Vector3d(std::sqrt(1 - z * z) * std::cos(angle),
                                     std::sqrt(1 - z * z) * std::sin(angle), z)
                         .cast<float>();
      point.xyz = point.normal;
      point.confidence = 1e6f / static_cast<float>(i + 1);  // would be seen in a mesh
      writer.Add(point, nullptr, 0);
    }
    writer.Finish();
  }
  EXPECT_EQ(
      RunColmap("poisson_mesher --PoissonMeshing.depth 4 --PoissonMeshing.trim 0 "
                "--PoissonMeshing.num_threads 1 "
                "--input_path " +
                (dir_ / "fused.ply").string() + " --output_path " + (dir_ / "mesh.ply").string()),
      0);
  // A property of ours behind its own changes nothing.
  const std::vector<CloudPoint> mesh = ReadCloud(dir_ / "mesh.ply");
  EXPECT_GT(mesh.size(), 100u);
  for (const CloudPoint& point : mesh) EXPECT_NEAR(point.xyz.norm(), 1, 0.1);
}

}  // namespace
}  // namespace colmap_seapoint
