// Positions of pictures, from tables and from every shape of database.
#include <cmath>
#include <cstring>
#include <limits>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_priors.h"
#include "colmap_seapoint/io/files/positions_csv.h"
#include "tests/io/test_database.h"
namespace colmap_seapoint {
namespace {

using Mode = ColmapDatabase::Mode;
using System = PositionPrior::System;

class PositionsCsv : public testing::Test {
 protected:
  PicturePositions Read(const std::string& text) {
    WriteBytes(path_, text);
    return ReadPositionsCsv(path_);
  }
  void ExpectError(const std::string& text, const std::string& line, const std::string& finding) {
    const std::string error = ErrorOf([&] { Read(text); });
    EXPECT_NE(error.find(path_.string() + (line.empty() ? "" : ":" + line) + ": "),
              std::string::npos)
        << error;
    EXPECT_NE(error.find(finding), std::string::npos) << error;
  }

  TempDir dir_;
  std::filesystem::path path_ = dir_ / "nav.csv";
};

TEST_F(PositionsCsv, ReadsMetresAndDegrees) {
  const auto metres = Read("image,x,y,z\na.jpg,1,-2.5,3e2\nb/c d.jpg,+4,5,6\n");
  EXPECT_FALSE(metres.is_geographic);
  ASSERT_EQ(metres.positions.size(), 2u);
  EXPECT_EQ(metres.positions.at("a.jpg"), Eigen::Vector3d(1, -2.5, 300));
  EXPECT_EQ(metres.positions.at("b/c d.jpg"), Eigen::Vector3d(4, 5, 6));
  const auto degrees = Read("image,lat,lon,alt\na.jpg,43.1,-5.9,-12\n");
  EXPECT_TRUE(degrees.is_geographic);
  EXPECT_EQ(degrees.positions.at("a.jpg"), Eigen::Vector3d(43.1, -5.9, -12));
}

TEST_F(PositionsCsv, ReadsWhatSpreadsheetsWrite) {
  const auto table = Read(
      "\xef\xbb\xbf# a comment\r\n\r\n Image , X,Y ,z\r\n\"odd, name \"\"1\"\".jpg\", 1 ,2, 3\r\n"
      "# another\r\nb.jpg,4,5,6");
  ASSERT_EQ(table.positions.size(), 2u);
  EXPECT_EQ(table.positions.at("odd, name \"1\".jpg"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.positions.at("b.jpg"), Eigen::Vector3d(4, 5, 6));
}

TEST_F(PositionsCsv, SaysWhatIsWrongAndWhere) {
  ExpectError("", "", "is empty");
  ExpectError("image,x,y,z\n# nothing\n", "", "holds no position");
  ExpectError("a.jpg,1,2,3\n", "1", "header line is 'a.jpg,1,2,3'");
  ExpectError("image,lon,lat,alt\na,1,2,3\n", "1", "header line");
  const std::string metres = "image,x,y,z\na.jpg,1,2,3\n";
  ExpectError(metres + "b.jpg,1,2\n", "3", "3 fields instead of 4");
  ExpectError(metres + "\nb.jpg,1,2,3,4\n", "4", "5 fields instead of 4");
  ExpectError(metres + "b.jpg,1,two,3\n", "3", "'two' is no finite number");
  ExpectError(metres + "b.jpg,1,,3\n", "3", "'' is no finite number");
  ExpectError(metres + "b.jpg,1,nan,3\n", "3", "'nan'");
  ExpectError(metres + "b.jpg,1,2,inf\n", "3", "'inf'");
  ExpectError(metres + "b.jpg,1,2,3m\n", "3", "'3m'");
  ExpectError(metres + ",1,2,3\n", "3", "names no picture");
  ExpectError(metres + "b.jpg,1,2,3\na.jpg,1,2,3\n", "4", "a.jpg has a position already");
  ExpectError("image,lat,lon,alt\na.jpg,91,2,3\n", "2", "no latitude and longitude");
  ExpectError("image,lat,lon,alt\na.jpg,500000,4000000,3\n", "2", "metres");
  EXPECT_ERROR(ReadPositionsCsv(dir_ / "absent.csv"), "absent.csv: there is no such file");
  EXPECT_ERROR(ReadPositionsCsv(dir_.Path()), "cannot be read");
}

std::string Hex(const Eigen::Vector3d& position) {
  std::string text = "x'";
  for (size_t i = 0; i < sizeof(double) * 3; ++i) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x",
                  reinterpret_cast<const unsigned char*>(position.data())[i]);
    text += digits;
  }
  return text + "'";
}

class PositionPriors : public testing::Test {
 protected:
  PositionPriors() : path_(dir_ / "database.db") {
    ColmapDatabase database(path_, Mode::kCreateIfMissing);
    const uint32_t camera = AddCamera(&database, MakeCamera(CameraModel::kPinhole, 500, 640, 480));
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) AddImage(&database, name, camera);
  }
  std::vector<PositionPrior> Read() const {
    return ReadPositionPriors(ColmapDatabase(path_, Mode::kReadOnly));
  }

  TempDir dir_;
  std::filesystem::path path_;
};

TEST_F(PositionPriors, OfColmap38) {
  EXPECT_TRUE(Read().empty());
  Execute(path_,
          "UPDATE images SET prior_tx = 43.5, prior_ty = 5, prior_tz = -2 WHERE image_id = 2");
  Execute(path_, "UPDATE images SET prior_tx = 43.5, prior_ty = 5 WHERE image_id = 3");
  const auto priors = Read();
  ASSERT_EQ(priors.size(), 1u);
  EXPECT_EQ(priors[0].image_id, 2u);
  EXPECT_EQ(priors[0].position, Eigen::Vector3d(43.5, 5, -2));
  EXPECT_EQ(priors[0].system, System::kUnknown);
}

TEST_F(PositionPriors, OfColmap310) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Execute(path_,
          "CREATE TABLE pose_priors(image_id INTEGER PRIMARY KEY NOT NULL, position BLOB, "
          "coordinate_system INTEGER NOT NULL, position_covariance BLOB);"
          "INSERT INTO pose_priors VALUES(1, " +
              Hex({1, 2, 3}) +
              ", 1, NULL);"
              "INSERT INTO pose_priors VALUES(2, " +
              Hex({nan, nan, nan}) +
              ", -1, NULL);"
              "INSERT INTO pose_priors VALUES(3, NULL, 0, NULL);"
              // The table wins over what an older COLMAP left in images.
              "UPDATE images SET prior_tx = 9, prior_ty = 9, prior_tz = 9 WHERE image_id = 1");
  const auto priors = Read();
  ASSERT_EQ(priors.size(), 1u);
  EXPECT_EQ(priors[0].image_id, 1u);
  EXPECT_EQ(priors[0].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(priors[0].system, System::kCartesian);
  Execute(path_, "UPDATE pose_priors SET position = x'00' WHERE image_id = 2");
  EXPECT_ERROR(Read(), "the pose prior of image 2 is damaged");
}

TEST_F(PositionPriors, OfColmap4) {
  Execute(path_,
          "CREATE TABLE pose_priors(pose_prior_id INTEGER PRIMARY KEY NOT NULL, corr_data_id "
          "INTEGER NOT NULL, corr_sensor_id INTEGER NOT NULL, corr_sensor_type INTEGER NOT NULL, "
          "position BLOB, position_covariance BLOB, gravity BLOB, coordinate_system INTEGER NOT "
          "NULL);"
          "INSERT INTO pose_priors VALUES(7, 3, 1, 0, " +
              Hex({43, 5, 0}) +
              ", NULL, NULL, 0);"
              "INSERT INTO pose_priors VALUES(8, 2, 1, 1, " +
              Hex({4, 4, 4}) + ", NULL, NULL, 1)");
  const auto priors = Read();
  ASSERT_EQ(priors.size(), 1u) << "sensor type 1 is no camera";
  EXPECT_EQ(priors[0].image_id, 3u);
  EXPECT_EQ(priors[0].system, System::kGeographic);
}

}  // namespace
}  // namespace colmap_seapoint
