#include "colmap_seapoint/io/las/export_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// The specification's tables (LAS 1.4 R15), read from the bytes without the writer's own code.
class Las {
 public:
  explicit Las(const std::filesystem::path& path) : bytes_(ReadBytes(path)) {}

  template <typename T>
  T At(size_t offset) const {
    T value{};
    EXPECT_LE(offset + sizeof(T), bytes_.size());
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }
  std::string Text(size_t offset, size_t size) const { return bytes_.substr(offset, size).c_str(); }
  size_t Size() const { return bytes_.size(); }
  size_t Points() const { return At<uint32_t>(96); }
  size_t PointBytes() const { return At<uint16_t>(105); }
  uint64_t NumPoints() const { return At<uint64_t>(247); }
  double Coordinate(uint64_t point, size_t axis) const {
    return At<int32_t>(Points() + point * PointBytes() + 4 * axis) * At<double>(131 + 8 * axis) +
           At<double>(155 + 8 * axis);
  }
  template <typename T>
  T Field(uint64_t point, size_t offset) const {
    return At<T>(Points() + point * PointBytes() + offset);
  }
  // The offset of a record's contents; 0: there is none.
  size_t Record(const std::string& user, uint16_t id, size_t* size) const {
    size_t at = At<uint16_t>(94);
    for (uint32_t k = 0; k < At<uint32_t>(100); ++k) {
      *size = At<uint16_t>(at + 20);
      if (Text(at + 2, 16) == user && At<uint16_t>(at + 18) == id) return at + 54;
      at += 54 + *size;
    }
    EXPECT_EQ(at, Points());
    return 0;
  }

 private:
  std::string bytes_;
};

std::vector<CloudPoint> MakePoints(int count) {
  std::vector<CloudPoint> points;
  for (int i = 0; i < count; ++i) {
    CloudPoint point;
    point.xyz = Eigen::Vector3f(0.37f * static_cast<float>(i % 100), 0.11f * static_cast<float>(i),
                                -3 + 0.001f * static_cast<float>(i * i % 977));
    point.normal = Eigen::Vector3f(0.6f, -0.0f, 0.8f);
    point.rgb = {static_cast<uint8_t>(i), 255, 0};
    point.confidence = 0.25f;
    points.push_back(point);
  }
  return points;
}

void WritePly(const std::filesystem::path& path, const std::vector<CloudPoint>& points) {
  CloudWriter writer(path);
  for (const CloudPoint& point : points) writer.Add(point, nullptr, 0);
  writer.Finish();
}

TEST(ExportCloud, EveryFieldStandsWhereTheSpecificationSays) {
  const TempDir dir;
  const std::vector<CloudPoint> points = MakePoints(300);
  WritePly(dir / "cloud.ply", points);
  CloudExport options;
  options.shift = Eigen::Vector3d(512000, 7654000, -20);
  options.crs = "EPSG:32755";
  EXPECT_EQ(ExportCloud(dir / "cloud.ply", dir / "cloud.las", options), points.size());
  const Las las(dir / "cloud.las");
  EXPECT_EQ(las.Text(0, 4), "LASF");
  EXPECT_EQ(las.Text(26, 32), kLasWords);
  EXPECT_EQ(las.At<uint8_t>(24), 1);
  EXPECT_EQ(las.At<uint8_t>(25), 4);
  EXPECT_EQ(las.At<uint16_t>(6), 16);  // the reference system is well-known text
  EXPECT_EQ(las.At<uint16_t>(94), 375);
  EXPECT_EQ(las.At<uint8_t>(104), 7);
  EXPECT_EQ(las.PointBytes(), 36u + 16u);
  EXPECT_EQ(las.NumPoints(), points.size());
  EXPECT_EQ(las.At<uint64_t>(255), points.size());
  EXPECT_EQ(las.At<uint32_t>(107), 0u);  // the old count, which format 7 leaves empty
  ASSERT_EQ(las.Size(), las.Points() + points.size() * las.PointBytes());
  const double scale = las.At<double>(131);
  EXPECT_GT(scale, 1e-7 * 36);
  EXPECT_LE(scale, 1e-6 * 36);
  for (uint64_t i = 0; i < points.size(); ++i) {
    const CloudPoint& point = points[i];
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<Eigen::Index>(axis);
      const double expected = static_cast<double>(point.xyz[k]) + options.shift[k];
      EXPECT_NEAR(las.Coordinate(i, axis), expected, 0.51 * scale + 2e-9);
      EXPECT_LE(las.Coordinate(i, axis), las.At<double>(179 + 16 * axis) + 1e-9);
      EXPECT_GE(las.Coordinate(i, axis), las.At<double>(187 + 16 * axis) - 1e-9);
      EXPECT_EQ(las.Field<uint16_t>(i, 30 + 2 * axis), 257 * point.rgb[axis]);
      EXPECT_EQ(las.Field<float>(i, 36 + 4 * axis), point.normal[k]);
    }
    EXPECT_EQ(las.Field<uint8_t>(i, 14), 0x11);
    EXPECT_EQ(las.Field<float>(i, 48), 0.25f);
  }
}

TEST(ExportCloud, RecordsNameCrsAndExtraBytes) {
  const TempDir dir;
  WritePly(dir / "cloud.ply", MakePoints(5));
  CloudExport options;
  options.crs = "EPSG:32755";
  ExportCloud(dir / "cloud.ply", dir / "cloud.las", options);
  const Las las(dir / "cloud.las");
  size_t size = 0;
  const size_t wkt = las.Record("LASF_Projection", 2112, &size);
  ASSERT_GT(wkt, 0u);
  const std::string text = las.Text(wkt, size);
  EXPECT_EQ(text.size() + 1, size);  // ends with a zero
  EXPECT_EQ(text.substr(0, 31), "PROJCS[\"WGS 84 / UTM zone 55S\",");
  const size_t extra = las.Record("LASF_Spec", 4, &size);
  ASSERT_GT(extra, 0u);
  ASSERT_EQ(size, 4u * 192);
  const char* const names[] = {"NormalX", "NormalY", "NormalZ", "Confidence"};
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(las.At<uint8_t>(extra + 192 * k + 2), 9);  // float
    EXPECT_EQ(las.Text(extra + 192 * k + 4, 32), names[k]);
  }
}

TEST(ExportCloud, ForeignCloudsHaveWhatTheyHave) {
  const TempDir dir;
  WriteBytes(dir / "cloud.ply",
             "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
             "property double z\nend_header\n1 2 3\n1 2 3\n");
  ExportCloud(dir / "cloud.ply", dir / "cloud.las", {});
  const Las las(dir / "cloud.las");
  EXPECT_EQ(las.PointBytes(), 36u);
  EXPECT_EQ(las.At<uint32_t>(100), 0u);  // no record
  EXPECT_EQ(las.Points(), 375u);
  for (size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(las.Coordinate(1, axis), 1.0 + static_cast<double>(axis), 1e-9);
  }
}

TEST(ExportCloud, SizesFromShellsToCoastsKeepTheirDigits) {
  const TempDir dir;
  for (const double size : {1e-4, 0.03, 1.0, 700.0, 9e4}) {
    for (const double away : {0.0, 3.0, -1e6}) {
      WriteBytes(dir / "cloud.ply",
                 "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
                 "property double z\nend_header\n0 0 0\n" +
                     std::to_string(size) + " 0 " + std::to_string(-size / 3) + "\n");
      CloudExport options;
      options.shift.setConstant(away);
      ExportCloud(dir / "cloud.ply", dir / "cloud.las", options);
      const Las las(dir / "cloud.las");
      EXPECT_NEAR(las.Coordinate(1, 0), size + away, 1e-6 * size + 1e-9) << size << " " << away;
      EXPECT_NEAR(las.Coordinate(0, 2), away, 1e-6 * size + 1e-9) << size << " " << away;
    }
  }
}

TEST(ExportCloud, SameBytesEachTime) {
  const TempDir dir;
  WritePly(dir / "cloud.ply", MakePoints(50000));  // more than a buffer
  ExportCloud(dir / "cloud.ply", dir / "a.las", {});
  ExportCloud(dir / "cloud.ply", dir / "b.las", {});
  EXPECT_EQ(ReadBytes(dir / "a.las"), ReadBytes(dir / "b.las"));
  EXPECT_EQ(Las(dir / "a.las").NumPoints(), 50000u);
}

TEST(ExportCloud, LazOrTheReasonWhyNot) {
  const TempDir dir;
  WritePly(dir / "cloud.ply", MakePoints(1000));
  CloudExport options;
  options.packing = LasPacking::kLaz;
  if (!CanWriteLaz()) {
    EXPECT_ERROR(ExportCloud(dir / "cloud.ply", dir / "cloud.laz", options),
                 "give a name that ends in .las");
    EXPECT_FALSE(std::filesystem::exists(dir / "cloud.laz"));
    return;
  }
  ExportCloud(dir / "cloud.ply", dir / "cloud.las", {});
  EXPECT_EQ(ExportCloud(dir / "cloud.ply", dir / "cloud.laz", options), 1000u);
  const Las las(dir / "cloud.las"), laz(dir / "cloud.laz");
  EXPECT_LT(2 * laz.Size(), las.Size());
  EXPECT_EQ(laz.NumPoints(), 1000u);
  EXPECT_EQ(laz.At<uint8_t>(104), 128 + 7);
  for (const size_t field : {131, 155, 179, 187}) {
    EXPECT_EQ(laz.At<double>(field), las.At<double>(field));
  }
}

TEST(ExportCloud, BadInputIsOneLineAndLeavesNothing) {
  const TempDir dir;
  EXPECT_ERROR(ExportCloud(dir / "none.ply", dir / "cloud.las", {}), "none.ply");
  WritePly(dir / "empty.ply", {});
  EXPECT_ERROR(ExportCloud(dir / "empty.ply", dir / "cloud.las", {}), "has no points");
  WritePly(dir / "cloud.ply", MakePoints(3));
  CloudExport options;
  options.crs = "EPSG:1";
  EXPECT_ERROR(ExportCloud(dir / "cloud.ply", dir / "cloud.las", options), "none that PROJ knows");
  EXPECT_ERROR(ExportCloud(dir / "cloud.ply", dir / "none/cloud.las", {}),
               "create the folder first");
  EXPECT_FALSE(std::filesystem::exists(dir / "cloud.las"));
}

}  // namespace
}  // namespace colmap_seapoint
