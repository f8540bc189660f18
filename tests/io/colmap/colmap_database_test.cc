#include "colmap_seapoint/io/colmap/colmap_database.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/LU>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

using Mode = ColmapDatabase::Mode;
using Check = ColmapDatabase::Check;

constexpr int kShortTimeoutMs = 50;

// Two images with 20 and 10 features.
class DatabaseTest : public testing::Test {
 protected:
  DatabaseTest() : path_(dir_ / "database.db"), db_(path_, Mode::kCreateIfMissing) {
    Camera camera = MakeCamera(CameraModel::kOpenCV, 800, 640, 480);
    camera.has_prior_focal_length = true;
    camera_id_ = AddCamera(&db_, camera);
    a_ = AddImage(&db_, "dive/a.jpg", camera_id_);
    b_ = AddImage(&db_, "dive/b.jpg", camera_id_);
    WriteFeatures(&db_, a_, MakeFeatures(20, 1), "print a");
    WriteFeatures(&db_, b_, MakeFeatures(10, 2), "print b");
  }

  TempDir dir_;
  std::filesystem::path path_;
  ColmapDatabase db_;
  uint32_t camera_id_ = 0, a_ = 0, b_ = 0;
};

TEST_F(DatabaseTest, CamerasAndImagesRoundTrip) {
  const auto cameras = ReadCameras(db_);
  ASSERT_EQ(cameras.size(), 1u);
  const Camera& camera = cameras.at(camera_id_);
  EXPECT_EQ(camera.model, CameraModel::kOpenCV);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.params, MakeCamera(CameraModel::kOpenCV, 800, 640, 480).params);
  EXPECT_TRUE(camera.has_prior_focal_length);
  const auto images = ReadImages(db_);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].name, "dive/a.jpg");
  EXPECT_EQ(images[1].image_id, b_);
  EXPECT_EQ(images[1].camera_id, camera_id_);
  ExpectSound(path_);
}

TEST_F(DatabaseTest, FeaturesRoundTripBesideAStub) {
  ExpectSameFeatures(ReadFeatures(db_, a_), MakeFeatures(20, 1));
  EXPECT_EQ(FeaturesFingerprint(db_, b_), "print b");
  EXPECT_TRUE(HasFeatures(db_, a_));
  EXPECT_FALSE(HasFeatures(db_, 99));
  EXPECT_FALSE(FeaturesFingerprint(db_, 99));
  EXPECT_FALSE(ReadFeatures(db_, 99));
  EXPECT_EQ(Query(path_, "SELECT image_id, rows, cols, data, typeof(data), type FROM descriptors"),
            (std::vector<std::string>{"1|0|128||blob|0", "2|0|128||blob|0"}));
  EXPECT_EQ(QueryOne(path_, "SELECT rows, cols, length(data) FROM keypoints"), "20|4|320");
  WriteFeatures(&db_, a_, Features(), "none");
  ExpectSameFeatures(ReadFeatures(db_, a_), Features());
}

TEST_F(DatabaseTest, SiftIsStoredAsColmapsOwn) {
  const Features features = MakeFeaturesWithSift(20, 1);
  WriteFeatures(&db_, a_, features, "sift");
  ExpectSameFeatures(ReadFeatures(db_, a_), features);
  ExpectSameFeatures(ReadFeatures(db_, b_), MakeFeatures(10, 2));  // without, in the same database
  EXPECT_EQ(Query(path_, "SELECT rows, cols, length(data), type FROM descriptors"),
            (std::vector<std::string>{"20|128|2560|0", "0|128|0|0"}));
  WriteFeatures(&db_, a_, MakeFeatures(20, 1), "rbrief");
  ExpectSameFeatures(ReadFeatures(db_, a_), MakeFeatures(20, 1));
  EXPECT_EQ(QueryOne(path_, "SELECT rows, cols, length(data) FROM descriptors"), "0|128|0");
}

TEST_F(DatabaseTest, DamagedSiftIsAnError) {
  const std::string damages[] = {"UPDATE descriptors SET data = zeroblob(2560)",
                                 "UPDATE descriptors SET rows = 19",
                                 "UPDATE descriptors SET rows = 0, data = x''",
                                 "UPDATE descriptors SET cols = 32", "DELETE FROM descriptors"};
  for (const std::string& damage : damages) {
    WriteFeatures(&db_, a_, MakeFeaturesWithSift(20, 1), "sift");
    ASSERT_TRUE(ReadFeatures(db_, a_));
    Execute(path_, damage + " WHERE image_id = 1");
    EXPECT_ERROR(ReadFeatures(db_, a_), "the SIFT descriptors of image 1 are damaged");
  }
}

// A database of the time before SIFT is read, and taken further.
TEST_F(DatabaseTest, OurTableGrows) {
  Execute(path_, "ALTER TABLE seapoint_descriptors DROP COLUMN sift_hash");
  ExpectSameFeatures(ReadFeatures(db_, a_), MakeFeatures(20, 1));
  WriteFeatures(&db_, b_, MakeFeaturesWithSift(7, 5), "sift");
  ExpectSameFeatures(ReadFeatures(db_, a_), MakeFeatures(20, 1));
  ExpectSameFeatures(ReadFeatures(db_, b_), MakeFeaturesWithSift(7, 5));
}

TEST_F(DatabaseTest, ForeignKeypointsAreNotOurs) {
  Execute(path_, "UPDATE keypoints SET data = zeroblob(320) WHERE image_id = 1");
  EXPECT_FALSE(ReadFeatures(db_, a_));
  Execute(path_, "UPDATE keypoints SET rows = 5, data = zeroblob(80) WHERE image_id = 2");
  EXPECT_FALSE(ReadFeatures(db_, b_));
}

TEST_F(DatabaseTest, DamagedDescriptorsAreAnError) {
  Execute(path_, "UPDATE seapoint_descriptors SET data = zeroblob(640) WHERE image_id = 1");
  EXPECT_ERROR(ReadFeatures(db_, a_), "descriptors of image 1 are damaged");
  Execute(path_, "UPDATE seapoint_descriptors SET rows = 1000000000000 WHERE image_id = 2");
  EXPECT_ERROR(ReadFeatures(db_, b_), "descriptors of image 2 are damaged");
}

TEST_F(DatabaseTest, MatchesRoundTrip) {
  const FeatureMatches raw = {{0, 1}, {19, 9}, {3, 4}};
  const TwoViewGeometry geometry = MakeGeometry({{19, 9}, {3, 4}});
  EXPECT_FALSE(HasMatches(db_, {a_, b_}));
  WriteMatches(&db_, a_, b_, raw, geometry);
  EXPECT_TRUE(HasMatches(db_, {a_, b_}));
  EXPECT_EQ(ReadMatches(db_, {a_, b_}), raw);
  const TwoViewGeometry read = ReadTwoViewGeometry(db_, {a_, b_});
  EXPECT_EQ(read.config, TwoViewConfig::kCalibrated);
  EXPECT_EQ(read.inliers, geometry.inliers);
  EXPECT_EQ(*read.F, *geometry.F);
  EXPECT_EQ(*read.E, *geometry.E);
  EXPECT_EQ(*read.H, *geometry.H);
  EXPECT_EQ(read.cam2_from_cam1->translation, geometry.cam2_from_cam1->translation);
  EXPECT_LT(read.cam2_from_cam1->rotation.angularDistance(geometry.cam2_from_cam1->rotation),
            1e-15);
  EXPECT_EQ(ReadVerifiedPairs(db_), (std::vector<ImagePair>{{a_, b_}}));
  // Row-major: the second number is F(0, 1) = 2.
  EXPECT_EQ(QueryOne(path_, "SELECT hex(substr(F, 9, 8)) FROM two_view_geometries"),
            "0000000000000040");
  EXPECT_EQ(QueryOne(path_, "SELECT pair_id FROM matches"), "2147483649");
}

TEST_F(DatabaseTest, SwappedPairsAreTurnedAround) {
  const TwoViewGeometry geometry = MakeGeometry({{9, 19}});
  WriteMatches(&db_, b_, a_, {{9, 19}}, geometry);
  EXPECT_EQ(ReadMatches(db_, {a_, b_}), (FeatureMatches{{19, 9}}));
  const TwoViewGeometry read = ReadTwoViewGeometry(db_, {a_, b_});
  EXPECT_EQ(read.inliers, (FeatureMatches{{19, 9}}));
  EXPECT_EQ(*read.F, geometry.F->transpose());
  EXPECT_EQ(*read.E, geometry.E->transpose());
  EXPECT_TRUE((*read.H * *geometry.H).isIdentity(1e-12));
  const Rigid3d identity = *read.cam2_from_cam1 * *geometry.cam2_from_cam1;
  EXPECT_LT(identity.translation.norm(), 1e-15);
  EXPECT_LT(identity.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-14);
}

TEST_F(DatabaseTest, UnsetMatricesAreNull) {
  TwoViewGeometry geometry;
  geometry.config = TwoViewConfig::kDegenerate;
  WriteMatches(&db_, a_, b_, {}, geometry);
  EXPECT_EQ(QueryOne(path_,
                     "SELECT rows, cols, typeof(data), config, F, E, H, qvec, tvec "
                     "FROM two_view_geometries"),
            "0|2|blob|1|NULL|NULL|NULL|NULL|NULL");
  const TwoViewGeometry read = ReadTwoViewGeometry(db_, {a_, b_});
  EXPECT_EQ(read.config, TwoViewConfig::kDegenerate);
  EXPECT_FALSE(read.F || read.E || read.H || read.cam2_from_cam1);
  EXPECT_TRUE(ReadVerifiedPairs(db_).empty());
  EXPECT_TRUE(HasMatches(db_, {a_, b_}));
  // What COLMAP 3.8 writes for "not computed".
  Execute(path_, "UPDATE two_view_geometries SET F = x'', E = zeroblob(72), qvec = zeroblob(32)");
  const TwoViewGeometry zeros = ReadTwoViewGeometry(db_, {a_, b_});
  EXPECT_FALSE(zeros.F || zeros.E || zeros.cam2_from_cam1);
}

TEST_F(DatabaseTest, HostileMatches) {
  WriteMatches(&db_, a_, b_, {{0, 1}}, MakeGeometry({{0, 1}}));
  Execute(path_, "UPDATE matches SET data = x'1400000000000000'");  // 20: one too many
  EXPECT_ERROR(ReadMatches(db_, {a_, b_}), "name keypoints 20 and 0");
  Execute(path_, "UPDATE matches SET rows = 2");
  EXPECT_ERROR(ReadMatches(db_, {a_, b_}), "are damaged: 8 bytes for 2 rows");
  Execute(path_, "UPDATE matches SET rows = 4611686018427387905");
  EXPECT_ERROR(ReadMatches(db_, {a_, b_}), "are damaged");
  Execute(path_, "UPDATE two_view_geometries SET F = x'00'");
  EXPECT_ERROR(ReadTwoViewGeometry(db_, {a_, b_}), "damaged matrix");
  Execute(path_, "UPDATE two_view_geometries SET rows = -1");
  EXPECT_ERROR(ReadTwoViewGeometry(db_, {a_, b_}), "are damaged");
}

TEST_F(DatabaseTest, NewFeaturesDropTheImagesMatches) {
  const uint32_t c = AddImage(&db_, "c.jpg", camera_id_);
  WriteFeatures(&db_, c, MakeFeatures(5, 3), "print c");
  WriteMatches(&db_, a_, b_, {{0, 0}}, MakeGeometry({{0, 0}}));
  WriteMatches(&db_, b_, c, {{0, 0}}, MakeGeometry({{0, 0}}));
  WriteMatches(&db_, a_, c, {{0, 0}}, MakeGeometry({{0, 0}}));
  WriteFeatures(&db_, b_, MakeFeatures(11, 4), "changed");
  EXPECT_EQ(ReadVerifiedPairs(db_), (std::vector<ImagePair>{{a_, c}}));
  EXPECT_EQ(Query(path_, "SELECT pair_id FROM matches").size(), 1u);
  ExpectSameFeatures(ReadFeatures(db_, b_), MakeFeatures(11, 4));
}

TEST_F(DatabaseTest, DeletedImagesCascade) {
  Execute(path_, "PRAGMA foreign_keys = ON; DELETE FROM images WHERE image_id = 1");
  EXPECT_EQ(QueryOne(path_, "SELECT count(*) FROM seapoint_descriptors"), "1");
  EXPECT_FALSE(ReadFeatures(db_, a_));
}

TEST_F(DatabaseTest, HostileImagesAndCameras) {
  EXPECT_ERROR(AddImage(&db_, "../x.jpg", camera_id_), "no legal image name");
  EXPECT_ERROR(AddImage(&db_, "dive/a.jpg", camera_id_), "UNIQUE");
  EXPECT_ERROR(AddImage(&db_, "new.jpg", 77), "FOREIGN KEY");
  EXPECT_EQ(ReadImages(db_).size(), 2u);
  Execute(path_, "UPDATE images SET name = '../../outside/x.jpg' WHERE image_id = 1");
  EXPECT_ERROR(ReadImages(db_), "leads out of the image folder");
  Execute(path_, "UPDATE cameras SET params = zeroblob(9)");
  EXPECT_ERROR(ReadCameras(db_), "camera 1 has damaged parameters");
  Execute(path_, "UPDATE cameras SET width = -1");
  EXPECT_ERROR(ReadCameras(db_), "impossible size");
  Execute(path_, "UPDATE cameras SET model = 18");
  EXPECT_ERROR(ReadCameras(db_), "unknown camera model 18");
}

TEST_F(DatabaseTest, TransactionsLandTogetherOrNotAtAll) {
  {
    const DatabaseTransaction abandoned(&db_);
    AddImage(&db_, "c.jpg", camera_id_);
    WriteFeatures(&db_, a_, MakeFeatures(3, 9), "inside");
  }
  EXPECT_EQ(ReadImages(db_).size(), 2u);
  EXPECT_EQ(FeaturesFingerprint(db_, a_), "print a");
  DatabaseTransaction transaction(&db_);
  AddImage(&db_, "c.jpg", camera_id_);
  EXPECT_EQ(ReadImages(ColmapDatabase(path_, Mode::kReadOnly)).size(), 2u);
  transaction.Commit();
  EXPECT_EQ(ReadImages(ColmapDatabase(path_, Mode::kReadOnly)).size(), 3u);
}

TEST_F(DatabaseTest, LockedByAnotherProgram) {
  DatabaseTransaction transaction(&db_);
  EXPECT_ERROR(ColmapDatabase(path_, Mode::kReadWrite, Check::kWhole, kShortTimeoutMs),
               "is locked by another");
  EXPECT_EQ(
      ReadImages(ColmapDatabase(path_, Mode::kReadOnly, Check::kWhole, kShortTimeoutMs)).size(),
      2u);
  transaction.Commit();
}

TEST_F(DatabaseTest, ReadOnlyWritesNothing) {
  ColmapDatabase reader(path_, Mode::kReadOnly);
  EXPECT_ERROR(AddImage(&reader, "c.jpg", camera_id_), "cannot be written");
}

TEST_F(DatabaseTest, MovesAndReopens) {
  ColmapDatabase moved(std::move(db_));
  EXPECT_EQ(ReadImages(moved).size(), 2u);
  ColmapDatabase again(path_, Mode::kCreateIfMissing);
  EXPECT_EQ(ReadImages(again).size(), 2u);
}

TEST(ColmapDatabase, SchemaIsThatOfColmap38) {
  const TempDir dir;
  { ColmapDatabase db(dir / "a.db", Mode::kCreateIfMissing); }
  EXPECT_EQ(QueryOne(dir / "a.db", "PRAGMA user_version"), "3800");
  EXPECT_EQ(
      QueryOne(dir / "a.db", "SELECT group_concat(name) FROM pragma_table_info('descriptors')"),
      "image_id,rows,cols,data,type");
  EXPECT_EQ(QueryOne(dir / "a.db",
                     "SELECT count(*) FROM sqlite_master "
                     "WHERE name = 'seapoint_descriptors'"),
            "0");
}

TEST(ColmapDatabase, HostileFiles) {
  const TempDir dir;
  EXPECT_ERROR(ColmapDatabase(dir / "a.db", Mode::kReadOnly), "there is no such database");
  EXPECT_ERROR(ColmapDatabase(dir / "a.db", Mode::kReadWrite), "there is no such database");
  EXPECT_ERROR(ColmapDatabase(dir / "no/a.db", Mode::kCreateIfMissing), "folder does not exist");
  EXPECT_ERROR(ColmapDatabase(dir.Path(), Mode::kCreateIfMissing), "is a folder, not a database");
  EXPECT_ERROR(ColmapDatabase("/proc/a.db", Mode::kCreateIfMissing), "/proc/a.db: ");
  WriteBytes(dir / "empty.db", "");
  EXPECT_ERROR(ColmapDatabase(dir / "empty.db", Mode::kReadOnly), "is an empty file");
  WriteBytes(dir / "text.db", "this is a text of more than sixteen bytes, no database");
  for (const Mode mode : {Mode::kReadOnly, Mode::kReadWrite, Mode::kCreateIfMissing}) {
    EXPECT_ERROR(ColmapDatabase(dir / "text.db", mode), "is not a database");
  }
  EXPECT_EQ(ReadBytes(dir / "text.db").size(), 54u);
  Execute(dir / "other.db", "CREATE TABLE fish(name TEXT)");
  EXPECT_ERROR(ColmapDatabase(dir / "other.db", Mode::kCreateIfMissing), "is no COLMAP database");
  EXPECT_EQ(QueryOne(dir / "other.db", "SELECT count(*) FROM sqlite_master"), "1");
}

TEST(ColmapDatabase, TruncatedAndDamagedFiles) {
  const TempDir dir;
  {
    ColmapDatabase db(dir / "a.db", Mode::kCreateIfMissing);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    for (int i = 0; i < 20; ++i) {
      const uint32_t image_id = AddImage(&db, std::to_string(i) + ".jpg", camera_id);
      WriteFeatures(&db, image_id, MakeFeatures(300, 5), "p");
    }
  }
  const std::string whole = ReadBytes(dir / "a.db");
  for (size_t size = 512; size < whole.size(); size += whole.size() / 20) {
    WriteBytes(dir / "cut.db", whole.substr(0, size));
    EXPECT_ERROR(ColmapDatabase(dir / "cut.db", Mode::kReadWrite), "cut.db: ");
  }
  std::string damaged = whole;
  std::fill_n(damaged.begin() + 4096, 4096, '\x5a');
  WriteBytes(dir / "damaged.db", damaged);
  EXPECT_ERROR(ColmapDatabase(dir / "damaged.db", Mode::kReadOnly), "is damaged");
  const ColmapDatabase unchecked(dir / "damaged.db", Mode::kReadOnly, Check::kNone);
  EXPECT_ERROR(unchecked.CheckWhole(), "is damaged");
}

TEST(ColmapDatabase, KilledAtAnyMomentItResumes) {
  const TempDir dir;
  for (int round = 0; round < 8; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      ColmapDatabase db(dir / "a.db", Mode::kCreateIfMissing);
      const auto cameras = ReadCameras(db);
      const uint32_t camera_id =
          cameras.empty() ? AddCamera(&db, MakeCamera(CameraModel::kPinhole, 500, 640, 480))
                          : cameras.begin()->first;
      for (int i = static_cast<int>(ReadImages(db).size());; ++i) {
        DatabaseTransaction transaction(&db);
        const uint32_t image_id = AddImage(&db, std::to_string(i) + ".jpg", camera_id);
        WriteFeatures(&db, image_id, MakeFeatures(200, static_cast<unsigned>(i)), "p");
        transaction.Commit();
      }
    }
    usleep(static_cast<useconds_t>(20000 + 17000 * round));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child failed by itself";
  }
  const ColmapDatabase db(dir / "a.db", Mode::kReadWrite);
  const auto images = ReadImages(db);
  EXPECT_GT(images.size(), 0u);
  for (size_t i = 0; i < images.size(); ++i) {
    ExpectSameFeatures(ReadFeatures(db, images[i].image_id),
                       MakeFeatures(200, static_cast<unsigned>(i)));
  }
  ExpectSound(dir / "a.db");
}

TEST(ColmapDatabase, FullDiskIsAnErrorAndNothingIsLost) {
  const TempDir dir;
  if (mount("tmpfs", dir.Path().c_str(), "tmpfs", 0, "size=1m") != 0) {
    GTEST_SKIP() << "a small disk can be mounted by root only";
  }
  {
    ColmapDatabase db(dir / "a.db", Mode::kCreateIfMissing);
    const uint32_t camera_id = AddCamera(&db, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    const std::string error = ErrorOf([&] {
      for (int i = 0; i < 1000; ++i) {
        const uint32_t image_id = AddImage(&db, std::to_string(i) + ".jpg", camera_id);
        WriteFeatures(&db, image_id, MakeFeatures(300, 1), "p");
      }
    });
    EXPECT_NE(error.find("disk"), std::string::npos) << error;
    ExpectSameFeatures(ReadFeatures(db, 1), MakeFeatures(300, 1));
  }
  ExpectSound(dir / "a.db");
  umount(dir.Path().c_str());
}

}  // namespace
}  // namespace colmap_seapoint
