// What model_scaler reads and writes: tables, rigs and frames, clouds, units.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/cloud/transform_cloud.h"
#include "colmap_seapoint/io/colmap/colmap_rigs.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/files/scale_csv.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

Similarity3d SomeSimilarity() {
  Similarity3d similarity;
  similarity.scale = 2.5;
  similarity.rotation = Eigen::AngleAxisd(0.9, Eigen::Vector3d(1, 2, -1).normalized());
  similarity.translation = {10, -20, 5};
  return similarity;
}

class ScaleFiles : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& bytes) {
    WriteBytes(dir_ / name, bytes);
    return dir_ / name;
  }
  TempDir dir_;
};

TEST_F(ScaleFiles, ScaleBars) {
  const auto bars = ReadScaleBarsCsv(Write("bars.csv",
                                           "name1,name2,length_m,sigma_m\n\"a, 1\",b,0.5,0.002\n"
                                           "# another\npoint:12,point:7,1.25,.001\n"));
  ASSERT_EQ(bars.size(), 2u);
  EXPECT_EQ(bars[0].ends[0].name, "a, 1");
  EXPECT_FALSE(bars[0].ends[0].point3D_id);
  EXPECT_EQ(bars[0].sigma, 0.002);
  EXPECT_EQ(bars[1].ends[0].point3D_id, 12u);
  EXPECT_EQ(bars[1].metres, 1.25);
  EXPECT_FALSE(ReadScaleBarsCsv(Write("b.csv", "name1,name2,length_m\na,b,1\n"))[0].sigma);
}

TEST_F(ScaleFiles, BadScaleBarsAreNamedByLine) {
  const std::string header = "name1,name2,length_m\n";
  const auto expect = [&](const std::string& text, const std::string& message) {
    const std::string error = ErrorOf([&] { ReadScaleBarsCsv(Write("bars.csv", text)); });
    EXPECT_NE(error.find(message), std::string::npos) << error;
  };
  expect("a,b,1\n", "bars.csv:1: the header line is 'a,b,1'; begin the file with name1");
  expect("", "holds no scale bar");
  expect(header, "holds no scale bar");
  expect(header + "a,b\n", "bars.csv:2: has 2 fields instead of 3");
  expect(header + "a,b,1\na,,1\n", "bars.csv:3: an end of the bar has no name");
  expect(header + "a,a,1\n", "bars.csv:2: both ends of the bar are a");
  expect(header + "a,b,one\n", "'one' is no finite number");
  expect(header + "a,b,-1\n", "the length '-1' is not positive");
  expect(header + "a,point:x,1\n", "'point:x' names no 3D point");
  expect("name1,name2,length_m,sigma_m\na,b,1,0\n", "the sigma '0' is not positive");
  EXPECT_ERROR(ReadScaleBarsCsv(dir_ / "absent.csv"), "check --scale_bars_path");
}

TEST_F(ScaleFiles, Targets) {
  const auto marks =
      ReadTargetsCsv(Write("t.csv", "target,image,x,y\na,left/1.jpg,10.5,20\na,2.jpg,1,2\n"));
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].image, "left/1.jpg");
  EXPECT_EQ(marks[0].pixel, Eigen::Vector2d(10.5, 20));
  EXPECT_ERROR(ReadTargetsCsv(Write("t.csv", "target,image,x,y\na,1,2,3\na,1,2,4\n")),
               "t.csv:3: a is marked in 1 already");
  EXPECT_ERROR(ReadTargetsCsv(Write("t.csv", "target,image,x,y\na,1,2,nan\n")), "'nan'");
  EXPECT_ERROR(ReadTargetsCsv(Write("t.csv", "target,image,x,y\n,1,2,3\n")), "names no target");
  EXPECT_ERROR(ReadTargetsCsv(Write("t.csv", "image,target,x,y\n")), "header line");
}

TEST_F(ScaleFiles, PositionsWithDepthAndSigmas) {
  auto table = ReadPositionsCsv(Write("p.csv", "image,lat,lon,depth\na,43,5,12.5\n"));
  EXPECT_TRUE(table.is_geographic);
  EXPECT_EQ(table.positions.at("a"), Eigen::Vector3d(43, 5, -12.5));
  EXPECT_TRUE(table.sigmas.empty());
  table = ReadPositionsCsv(Write("p.csv", "image,x,y,z,sigma\na,1,2,3,0.5\n"));
  EXPECT_EQ(table.sigmas.at("a"), Eigen::Vector3d(0.5, 0.5, 0.5));
  table = ReadPositionsCsv(Write("p.csv", "image,lat,lon,alt,sigma_xy,sigma_z\na,1,2,3,2,0.1\n"));
  EXPECT_EQ(table.sigmas.at("a"), Eigen::Vector3d(2, 2, 0.1));
  EXPECT_ERROR(ReadPositionsCsv(Write("p.csv", "image,x,y,z,sigma\na,1,2,3,0\n")),
               "p.csv:2: the sigma '0' is not positive");
  EXPECT_ERROR(ReadPositionsCsv(Write("p.csv", "image,x,y,z,sigma\na,1,2,3\n")),
               "4 fields instead of 5");
  EXPECT_ERROR(ReadPositionsCsv(dir_ / "absent.csv", "--positions_path"), "check --positions_path");
}

template <typename T>
void Put(std::string* bytes, T value) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void PutPose(std::string* bytes, const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  for (const double v : {q.w(), q.x(), q.y(), q.z()}) Put(bytes, v);
  for (const double v : pose.translation) Put(bytes, v);
}

Rigid3d Pose(double angle, const Eigen::Vector3d& translation) {
  Rigid3d pose;
  pose.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d(0, 1, 1).normalized());
  pose.translation = translation;
  return pose;
}

// One rig of three sensors, the last without a pose; one frame of two pictures.
class Rigs : public ScaleFiles {
 protected:
  const Rigid3d sensor_from_rig_ = Pose(0.2, {0.5, 0.1, 0});
  const Rigid3d rig_from_world_ = Pose(-1.1, {3, 2, 1});

  std::string RigsBytes(const Rigid3d& sensor_from_rig) const {
    std::string bytes;
    Put<uint64_t>(&bytes, 1);
    Put<uint32_t>(&bytes, 7);
    Put<uint32_t>(&bytes, 3);
    for (const uint32_t sensor : {1u, 2u, 9u}) {
      Put<int32_t>(&bytes, sensor == 9 ? 1 : 0);
      Put<uint32_t>(&bytes, sensor);
      if (sensor == 1) continue;
      Put<uint8_t>(&bytes, sensor == 2);
      if (sensor == 2) PutPose(&bytes, sensor_from_rig);
    }
    return bytes;
  }
  static std::string FramesBytes(const Rigid3d& rig_from_world) {
    std::string bytes;
    Put<uint64_t>(&bytes, 1);
    Put<uint32_t>(&bytes, 4);
    Put<uint32_t>(&bytes, 7);
    PutPose(&bytes, rig_from_world);
    Put<uint32_t>(&bytes, 2);
    for (const uint32_t sensor : {1u, 2u}) {
      Put<int32_t>(&bytes, 0);
      Put<uint32_t>(&bytes, sensor);
      Put<uint64_t>(&bytes, 30 + sensor);
    }
    return bytes;
  }
  void WriteBinaryModel() {
    for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) Write(name, "");
  }
};

TEST_F(Rigs, BinaryFilesFollow) {
  WriteBinaryModel();
  Write("rigs.bin", RigsBytes(sensor_from_rig_));
  Write("frames.bin", FramesBytes(rig_from_world_));
  std::filesystem::create_directories(dir_ / "out");
  TransformRigFiles(dir_.Path(), dir_ / "out", SomeSimilarity());
  Rigid3d scaled = sensor_from_rig_;
  scaled.translation *= SomeSimilarity().scale;
  EXPECT_EQ(ReadBytes(dir_ / "out/rigs.bin"), RigsBytes(scaled));
  EXPECT_EQ(ReadBytes(dir_ / "out/frames.bin"),
            FramesBytes(TransformedPose(rig_from_world_, SomeSimilarity())));
  // The camera that the two files give together is where the model's own picture goes.
  const Rigid3d before = sensor_from_rig_ * rig_from_world_;
  const Rigid3d after = scaled * TransformedPose(rig_from_world_, SomeSimilarity());
  EXPECT_LT((after.OriginInSource() - SomeSimilarity() * before.OriginInSource()).norm(), 1e-12);
}

TEST_F(Rigs, TextFilesFollow) {
  Write("rigs.txt", "# comment\n7 3 CAMERA 1 CAMERA 2 1 1 0 0 0 0.5 0.1 -0.25 IMU 9 0\n");
  Write("frames.txt", "4 7 1 0 0 0 3 2 1 2 CAMERA 1 31 CAMERA 2 32\n");
  std::filesystem::create_directories(dir_ / "out");
  Similarity3d similarity;
  similarity.scale = 2;
  similarity.translation = {1, 1, 1};
  TransformRigFiles(dir_.Path(), dir_ / "out", similarity);
  EXPECT_EQ(ReadBytes(dir_ / "out/rigs.txt"),
            "# comment\n7 3 CAMERA 1 CAMERA 2 1 1 0 0 0 1 0.20000000000000001 -0.5 IMU 9 0\n");
  EXPECT_EQ(ReadBytes(dir_ / "out/frames.txt"), "4 7 1 0 0 0 5 3 1 2 CAMERA 1 31 CAMERA 2 32\n");
}

TEST_F(Rigs, DamagedFilesAreRefused) {
  WriteBinaryModel();
  Write("frames.bin", FramesBytes(rig_from_world_).substr(0, 60));
  EXPECT_ERROR(TransformRigFiles(dir_.Path(), dir_ / "out", SomeSimilarity()),
               "frames.bin: byte 16: the file ends");
  Write("frames.bin", FramesBytes(rig_from_world_) + "x");
  EXPECT_ERROR(TransformRigFiles(dir_.Path(), dir_ / "out", SomeSimilarity()), "bytes follow");
  std::filesystem::remove(dir_ / "cameras.bin");
  Write("frames.txt", "4 7 1 0 0 zero 3 2 1\n");
  EXPECT_ERROR(TransformRigFiles(dir_.Path(), dir_ / "out", SomeSimilarity()),
               "frames.txt: line 1: 'zero' is no number");
}

TEST_F(ScaleFiles, CloudAndNormals) {
  const auto path = dir_ / "fused.ply";
  const uint32_t seen_by[] = {0, 3};
  {
    CloudWriter writer(path);
    for (int i = 0; i < 50000; ++i) {  // more than one buffer
      const float x = static_cast<float>(i) * 1e-3f;
      writer.Add({{x, 2 * x, 1 - x}, {0.6f, 0, 0.8f}, {1, 2, 3}}, seen_by, 2);
    }
    writer.Add({{1, 2, 3}, {0, 0, 0}, {4, 5, 6}}, seen_by, 1);  // without a normal
    writer.Finish();
  }
  const Similarity3d similarity = SomeSimilarity();
  EXPECT_EQ(TransformCloud(path, dir_ / "out.ply", similarity), 50001u);
  const auto before = ReadCloud(path), after = ReadCloud(dir_ / "out.ply");
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector3f expected = (similarity * before[i].xyz.cast<double>()).cast<float>();
    ASSERT_EQ(after[i].xyz, expected) << i;
    ASSERT_EQ(after[i].rgb, before[i].rgb);
  }
  EXPECT_NEAR(after[7].normal.norm(), 1, 1e-6);
  EXPECT_LT(
      (after[7].normal.cast<double>() - similarity.rotation * Eigen::Vector3d(0.6, 0, 0.8)).norm(),
      1e-6);
  EXPECT_EQ(after.back().normal, Eigen::Vector3f::Zero());
  EXPECT_EQ(ReadBytes(dir_ / "out.ply.vis"), ReadBytes(dir_ / "fused.ply.vis"));
}

TEST_F(ScaleFiles, AsciiCloudKeepsItsOtherProperties) {
  const auto path = Write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\n"
                          "property double y\nproperty double z\nproperty int class\n"
                          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                          "1 2 3 42\n0 0 0 -7\n3 0 1 1\n");
  Similarity3d similarity;
  similarity.scale = 2;
  similarity.translation = {1, 0, 0};
  TransformCloud(path, dir_ / "out.ply", similarity);
  const std::string text = ReadBytes(dir_ / "out.ply");
  EXPECT_NE(text.find("end_header\n3 4 6 42\n1 0 0 -7\n3 0 1 1\n"), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out.ply.vis"));
}

TEST_F(ScaleFiles, BadCloudsAreRefusedAndLeaveNothing) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  EXPECT_ERROR(TransformCloud(Write("a.ply", header + "12345"), dir_ / "out.ply", SomeSimilarity()),
               "is truncated");
  EXPECT_ERROR(TransformCloud(Write("c.ply",
                                    "ply\nformat binary_big_endian 1.0\nelement vertex 0\n"
                                    "property float x\nproperty float y\n"
                                    "property float z\nend_header\n"),
                              dir_ / "out.ply", SomeSimilarity()),
               "is big-endian");
  for (const char* position : {"2e15 0 0", "nan 0 0", "0 0 -inf"}) {
    const std::string cloud =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
        "property double z\nend_header\n" +
        std::string(position) + "\n";
    EXPECT_ERROR(TransformCloud(Write("far.ply", cloud), dir_ / "out.ply", Similarity3d()),
                 "a point lies farther than 1e15 from the origin, or is not finite");
  }
  EXPECT_ERROR(TransformCloud(dir_ / "absent.ply", dir_ / "out.ply", SomeSimilarity()),
               "cannot be read");
  EXPECT_ERROR(TransformCloud(Write("b.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 1\n"
                                    "property int x\nproperty int y\nproperty int z\n"
                                    "end_header\n1 2 3\n"),
                              dir_ / "out.ply", SomeSimilarity()),
               "neither float nor double");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out.ply"));
}

TEST_F(ScaleFiles, Units) {
  EXPECT_FALSE(ReadModelUnits(dir_.Path()));
  EXPECT_EQ(UnitsText(std::nullopt), "units arbitrary");
  EXPECT_EQ(UnitsWord(ModelUnits()), "arbitrary");
  ModelUnits units;
  units.is_metric = true;
  units.frame = "east-north-up";
  units.origin = GeoPosition{43.1, 5.9, -100};
  units.offset = {0, 100, 0};
  units.scale_sigma_relative = 0.001;
  WriteModelUnits(dir_.Path(), units);
  const auto read = ReadModelUnits(dir_.Path());
  ASSERT_TRUE(read && read->origin);
  EXPECT_EQ(UnitsText(read), UnitsText(units));
  EXPECT_EQ(UnitsText(read),
            "metres, east-north-up of latitude 43.1000000, longitude 5.9000000; add 0 100 0");
  EXPECT_EQ(read->origin->altitude_m, -100);
  EXPECT_EQ(read->scale_sigma_relative, 0.001);
  Write("units.json", "{\"units\": 3}");
  EXPECT_ERROR(ReadModelUnits(dir_.Path()), "units.json: is no description of units");
}

TEST(MapProjection, Utm) {
  const MapProjection utm("EPSG:32755");
  EXPECT_EQ(utm.Name(), "WGS 84 / UTM zone 55S");
  // On the central meridian, the easting is 500 km exactly; on the equator the northing 10,000.
  const Eigen::Vector3d place = utm.FromGeographic({0, 147, -8});
  EXPECT_LT((place - Eigen::Vector3d(500000, 10000000, -8)).norm(), 1e-3);
  // A degree of longitude on the equator, by the series of the projection (scale 0.9996).
  EXPECT_NEAR(utm.FromGeographic({0, 148, 0}).x(), 500000 + 0.9996 * 111325.2, 2);
}

TEST(MapProjection, WhatIsNoMetricSystem) {
  EXPECT_ERROR(MapProjection("EPSG:4326"), "is no projected reference system");
  EXPECT_ERROR(MapProjection("EPSG:2263"), "not in metres");  // New York, US feet
  EXPECT_ERROR(MapProjection("nonsense"), "PROJ does not know it");
}

}  // namespace
}  // namespace colmap_seapoint
