#include "colmap_seapoint/io/cloud/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "colmap_seapoint/io/cloud/distance_cloud.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

CloudPoint MakePoint(int i) {
  CloudPoint point;
  point.xyz = Eigen::Vector3f(0.1f * static_cast<float>(i), -1.f / 3.f, 1e6f);
  point.normal = Eigen::Vector3f(0, 0, -1);
  point.rgb = {static_cast<uint8_t>(i), 2, 255};
  point.confidence = 1 / (1 + static_cast<float>(i));
  return point;
}

void WriteCloud(const std::filesystem::path& path, int num_points) {
  CloudWriter writer(path);
  const uint32_t image_idxs[] = {7, 9};
  for (int i = 0; i < num_points; ++i) writer.Add(MakePoint(i), image_idxs, 2);
  writer.Finish();
}

TEST(CloudWriter, RoundTrip) {
  const TempDir dir;
  for (const int num_points : {0, 1, 9, 10, 1234}) {
    WriteCloud(dir / "fused.ply", num_points);
    const auto points = ReadCloud(dir / "fused.ply");
    ASSERT_EQ(points.size(), static_cast<size_t>(num_points));
    for (int i = 0; i < num_points; ++i) {
      const CloudPoint& point = points[static_cast<size_t>(i)];
      EXPECT_EQ(point.xyz, MakePoint(i).xyz);
      EXPECT_EQ(point.normal, MakePoint(i).normal);
      EXPECT_EQ(point.rgb, MakePoint(i).rgb);
      EXPECT_EQ(point.confidence, MakePoint(i).confidence);
    }
  }
}

TEST(CloudWriter, WritesColmapsForm) {
  const TempDir dir;
  WriteCloud(dir / "fused.ply", 12);
  const std::string ply = ReadBytes(dir / "fused.ply");
  EXPECT_NE(ply.find("\nelement vertex 12\nproperty float x\n"), std::string::npos);
  EXPECT_NE(ply.find("\nproperty uchar blue\nproperty float confidence\nend_header\n"),
            std::string::npos);
  const std::string end = "end_header\n";
  EXPECT_EQ(ply.size(), ply.find(end) + end.size() + 12 * 31);

  const std::string vis = ReadBytes(dir / "fused.ply.vis");
  ASSERT_EQ(vis.size(), 8u + 12 * 12);
  uint64_t count;
  uint32_t record[3];
  std::memcpy(&count, vis.data(), 8);
  std::memcpy(record, vis.data() + vis.size() - 12, 12);
  EXPECT_EQ(count, 12u);
  EXPECT_EQ(record[0], 2u);
  EXPECT_EQ(record[1], 7u);
  EXPECT_EQ(record[2], 9u);
}

TEST(CloudWriter, SkipsAndCountsWhatIsNotFinite) {
  const TempDir dir;
  CloudWriter writer(dir / "fused.ply");
  CloudPoint point = MakePoint(1);
  writer.Add(point, nullptr, 0);
  point.xyz.y() = std::numeric_limits<float>::quiet_NaN();
  writer.Add(point, nullptr, 0);
  point = MakePoint(1);
  point.normal.x() = std::numeric_limits<float>::infinity();
  writer.Add(point, nullptr, 0);
  writer.Finish();
  EXPECT_EQ(writer.NumPoints(), 1u);
  EXPECT_EQ(writer.NumSkipped(), 2u);
  EXPECT_EQ(ReadCloud(dir / "fused.ply").size(), 1u);
}

TEST(CloudWriter, LeavesNothingWithoutFinish) {
  const TempDir dir;
  {
    CloudWriter writer(dir / "fused.ply");
    writer.Add(MakePoint(1), nullptr, 0);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.Path()));
}

TEST(ReadCloud, AsciiWithExtrasAndCrLf) {
  const TempDir dir;
  WriteBytes(dir / "a.ply",
             "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement camera 2\r\nproperty int id\r\n"
             "element vertex 2\r\nproperty double x\r\nproperty list uchar int around\r\n"
             "property double y\r\nproperty double z\r\nproperty float red\r\n"
             "property float green\r\nproperty float blue\r\nelement face 0\r\n"
             "property list uchar int vertex_indices\r\nend_header\r\n"
             "1\r\n2\r\n0.5 2 8 9 1.5 2.5 0 0.5 1\r\n-1 0 -2 -3e2 1 1 1\r\n");
  const auto points = ReadCloud(dir / "a.ply");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].xyz, Eigen::Vector3f(0.5f, 1.5f, 2.5f));
  EXPECT_EQ(points[0].rgb, (std::array<uint8_t, 3>{0, 128, 255}));
  EXPECT_EQ(points[1].xyz, Eigen::Vector3f(-1, -2, -300));
  EXPECT_EQ(points[1].normal, Eigen::Vector3f(0, 0, 0));
}

TEST(ReadCloud, BinaryWithListsBeforeAndInVertices) {
  const TempDir dir;
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar short v\n"
      "element vertex 1\nproperty uchar q\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n";
  bytes += std::string("\x02\x01\x00\x02\x00", 5) + "q";
  const float xyz[] = {1, 2, 3};
  bytes.append(reinterpret_cast<const char*>(xyz), 12);
  WriteBytes(dir / "a.ply", bytes);
  const auto points = ReadCloud(dir / "a.ply");
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].xyz, Eigen::Vector3f(1, 2, 3));
}

// Turns the bytes of values of the sizes given, record after record.
std::string BigEndian(std::string bytes, const std::vector<size_t>& sizes) {
  for (size_t at = 0; at < bytes.size();) {
    for (const size_t size : sizes) {
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      std::reverse(begin, begin + static_cast<std::ptrdiff_t>(size));
      at += size;
    }
  }
  return bytes;
}

TEST(CloudReader, BigEndianInAnyOrderAndType) {
  const TempDir dir;
  std::string records;
  for (int i = 0; i < 3; ++i) {
    const int16_t z = static_cast<int16_t>(-300 + i);
    const double y = 1e-9 + i;
    const float x = 0.5f + static_cast<float>(i), ny = -1;
    const uint16_t red = 0xffff;
    const int32_t quality = 7;
    records.append(reinterpret_cast<const char*>(&z), 2);
    records.append(reinterpret_cast<const char*>(&red), 2);
    records.append(reinterpret_cast<const char*>(&y), 8);
    records.append(reinterpret_cast<const char*>(&ny), 4);
    records.append(reinterpret_cast<const char*>(&quality), 4);
    records.append(reinterpret_cast<const char*>(&x), 4);
  }
  const std::string fields =
      "element vertex 3\nproperty short z\nproperty ushort red\nproperty double y\n"
      "property float ny\nproperty int quality\nproperty float x\nend_header\n";
  WriteBytes(dir / "little.ply", "ply\nformat binary_little_endian 1.0\n" + fields + records);
  WriteBytes(dir / "big.ply", "ply\nformat binary_big_endian 1.0\n" + fields +
                                  BigEndian(records, {2, 2, 8, 4, 4, 4}));
  for (const char* name : {"little.ply", "big.ply"}) {
    CloudReader reader(dir / name);
    EXPECT_EQ(reader.NumPoints(), 3u);
    EXPECT_FALSE(reader.HasNormals());
    EXPECT_FALSE(reader.HasColors());
    EXPECT_FALSE(reader.FitsFloat());
    CloudVertex vertex;
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(reader.Next(&vertex));
      EXPECT_EQ(vertex.xyz, Eigen::Vector3d(0.5 + i, 1e-9 + i, -300 + i)) << name;
      EXPECT_EQ(vertex.normal, Eigen::Vector3f(0, -1, 0));
      EXPECT_EQ(vertex.rgb, (std::array<uint8_t, 3>{255, 0, 0}));
    }
    EXPECT_FALSE(reader.Next(&vertex));
  }
}

TEST(CloudReader, KeepsWhatAFloatWouldRound) {
  const TempDir dir;
  WriteBytes(dir / "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
             "property double z\nend_header\n500000.123456 5000000.654321 -31.5\n");
  CloudReader reader(dir / "a.ply");
  CloudVertex vertex;
  ASSERT_TRUE(reader.Next(&vertex));
  EXPECT_EQ(vertex.xyz, Eigen::Vector3d(500000.123456, 5000000.654321, -31.5));
}

TEST(CloudReader, FloatsAreKnownToFit) {
  const TempDir dir;
  WriteCloud(dir / "fused.ply", 2);
  const CloudReader reader(dir / "fused.ply");
  EXPECT_TRUE(reader.FitsFloat());
  EXPECT_TRUE(reader.HasNormals());
  EXPECT_TRUE(reader.HasColors());
}

TEST(DistanceCloud, IsReadAsACloud) {
  const TempDir dir;
  for (const bool as_float : {true, false}) {
    std::filesystem::remove(dir / "d.ply");
    DistanceCloudWriter writer(dir / "d.ply", 2, as_float, "red from 3 on");
    writer.Add({500000.123, 2, 3}, {1, 2, 3}, 0.5);
    writer.Add({4, 5, 6}, {7, 8, 9}, 1.5);
    EXPECT_FALSE(std::filesystem::exists(dir / "d.ply"));
    writer.Finish();
    CloudReader reader(dir / "d.ply");
    CloudVertex vertex;
    ASSERT_TRUE(reader.Next(&vertex));
    EXPECT_EQ(vertex.xyz.x(), as_float ? 500000.125 : 500000.123);
    EXPECT_EQ(vertex.rgb, (std::array<uint8_t, 3>{1, 2, 3}));
    ASSERT_TRUE(reader.Next(&vertex));
    EXPECT_FALSE(reader.Next(&vertex));
    const std::string bytes = ReadBytes(dir / "d.ply");
    float distance;
    std::memcpy(&distance, bytes.data() + bytes.size() - 4, 4);
    EXPECT_EQ(distance, 1.5f);
    EXPECT_NE(bytes.find("\nproperty float distance\nend_header\n"), std::string::npos);
  }
}

TEST(ReadCloud, EveryTruncationIsAnError) {
  const TempDir dir;
  WriteCloud(dir / "fused.ply", 3);
  const std::string whole = ReadBytes(dir / "fused.ply");
  for (size_t size = 0; size < whole.size(); ++size) {
    WriteBytes(dir / "cut.ply", whole.substr(0, size));
    EXPECT_ERROR(ReadCloud(dir / "cut.ply"), "cut.ply: ");
  }
}

TEST(ReadCloud, HostileHeaders) {
  const TempDir dir;
  const std::string vertex = "\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string start = "ply\nformat binary_little_endian 1.0\n";
  const std::pair<std::string, const char*> cases[] = {
      {"not a ply\n", "is not a PLY file"},
      {start + "element vertex 999999999999" + vertex + "end_header\nxxxx", "is truncated"},
      {start + "element vertex -1" + vertex + "end_header\n", "line 3"},
      {start + "element vertex 99999999999999999999999" + vertex + "end_header\n", "line 3"},
      {start + "element vertex 1\nproperty float x\nend_header\nxxxx", "no property y"},
      {start + "element vertex 1\nproperty quad x\n", "line 4"},
      {start + "property float x\n", "line 3"},
      {start + "end_header\n", "no element 'vertex'"},
      {"ply\nformat binary_middle_endian 1.0\n", "line 2"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
       "property double z\nend_header\n1 1e300 2\n",
       "vertex 0 is too far away"},
      {"ply\nelement vertex 0" + vertex + "end_header\n", "names no format"},
      {"ply\n" + std::string(100000, 'x'), "does not end"},
      {"ply\nformat ascii 1.0\nelement vertex 1" + vertex + "end_header\n1 2 zebra\n",
       "is no number"},
      {"ply\nformat ascii 1.0\nelement vertex 1" + vertex + "end_header\n1 nan 2\n",
       "vertex 0 is not finite"}};
  for (const auto& [bytes, part] : cases) {
    WriteBytes(dir / "a.ply", bytes);
    EXPECT_ERROR(ReadCloud(dir / "a.ply"), part);
  }
  EXPECT_ERROR(ReadCloud(dir / "missing.ply"), "missing.ply: cannot be read");
  EXPECT_ERROR(ReadCloud(dir.Path()), "cannot be read");
}

}  // namespace
}  // namespace colmap_seapoint
