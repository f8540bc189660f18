#include "colmap_seapoint/io/colmap/dense_workspace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "colmap_seapoint/io/cloud/cloud_ranges.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

FloatImage SomeMap(int channels) {
  FloatImage map(3, 2, channels);
  for (size_t i = 0; i < map.data.size(); ++i) map.data[i] = 0.5f + static_cast<float>(i);
  return map;
}

TEST(DenseMap, BytesAreColmaps) {
  const TempDir dir;
  WriteDenseMap(dir / "n.bin", SomeMap(2));
  std::string expected = "3&2&2&";
  // One channel after the other, each row by row.
  for (const float value :
       {0.5f, 2.5f, 4.5f, 6.5f, 8.5f, 10.5f, 1.5f, 3.5f, 5.5f, 7.5f, 9.5f, 11.5f}) {
    expected.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  EXPECT_EQ(ReadBytes(dir / "n.bin"), expected);
}

TEST(DenseMap, RoundTrip) {
  const TempDir dir;
  for (const int channels : {1, 3}) {
    const FloatImage map = SomeMap(channels);
    WriteDenseMap(dir / "m.bin", map);
    const FloatImage found = ReadDenseMap(dir / "m.bin");
    EXPECT_EQ(found.width, map.width);
    EXPECT_EQ(found.height, map.height);
    EXPECT_EQ(found.channels, channels);
    EXPECT_EQ(found.data, map.data);
  }
}

TEST(DenseMap, DamagedFiles) {
  const TempDir dir;
  WriteDenseMap(dir / "m.bin", SomeMap(1));
  const std::string whole = ReadBytes(dir / "m.bin");
  for (size_t size = 0; size < whole.size(); ++size) {
    WriteBytes(dir / "cut.bin", whole.substr(0, size));
    EXPECT_ERROR(ReadDenseMap(dir / "cut.bin"), "cut.bin: ");
  }
  for (const std::string& bytes :
       {whole + "x", std::string("0&2&1&"), std::string("-3&2&1&"), std::string("3&2&9&"),
        std::string("99999999999&1&1&"), std::string("1048576&1048576&1&"), std::string("&&&")}) {
    WriteBytes(dir / "bad.bin", bytes);
    EXPECT_ERROR(ReadDenseMap(dir / "bad.bin"), "bad.bin: ");
  }
  EXPECT_ERROR(ReadDenseMap(dir / "none.bin"), "cannot be read");
}

TEST(DenseWorkspace, FoldersAndLists) {
  const TempDir dir;
  const std::vector<std::string> names = {"a.jpg", "left/b c.png"};
  CreateDenseWorkspaceFolders(dir.Path(), names);
  for (const std::string folder : {"images/left", "stereo/depth_maps/left",
                                   "stereo/normal_maps/left", "stereo/consistency_graphs"}) {
    EXPECT_TRUE(fs::is_directory(dir / folder)) << folder;
  }
  WriteStereoConfigs(dir.Path(), names);
  EXPECT_EQ(ReadBytes(dir / "stereo/fusion.cfg"), "a.jpg\nleft/b c.png\n");
  EXPECT_EQ(ReadBytes(dir / "stereo/patch-match.cfg"),
            "a.jpg\n__auto__, 20\nleft/b c.png\n__auto__, 20\n");
  EXPECT_EQ(DepthMapPath("w", "left/b.png"), "w/stereo/depth_maps/left/b.png.geometric.bin");
  EXPECT_EQ(NormalMapPath("w", "b.png"), "w/stereo/normal_maps/b.png.geometric.bin");
  RemoveStereoConfigs(dir.Path());
  EXPECT_FALSE(fs::exists(dir / "stereo/fusion.cfg"));
}

TEST(CloudRanges, ReadsAnyPart) {
  const TempDir dir;
  {
    CloudWriter writer(dir / "fused.ply");
    for (uint8_t i = 0; i < 100; ++i) {
      const auto x = static_cast<float>(i);
      writer.Add({{x, 2 * x, -x}, {0, 0, 1}, {i, 1, 2}, x / 128}, nullptr, 0);
    }
    writer.Finish();
  }
  const std::vector<CloudPoint> all = ReadCloud(dir / "fused.ply");
  const CloudRanges cloud(dir / "fused.ply");
  ASSERT_EQ(cloud.NumPoints(), 100u);
  for (const auto& [first, count] :
       std::vector<std::pair<uint64_t, uint64_t>>{{0, 100}, {99, 1}, {37, 20}, {100, 0}}) {
    const std::vector<CloudPoint> part = cloud.Read(first, count);
    ASSERT_EQ(part.size(), count);
    for (size_t i = 0; i < count; ++i) {
      EXPECT_EQ(part[i].xyz, all[first + i].xyz);
      EXPECT_EQ(part[i].normal, all[first + i].normal);
      EXPECT_EQ(part[i].rgb, all[first + i].rgb);
      EXPECT_EQ(part[i].confidence, static_cast<float>(first + i) / 128);
    }
  }
  const std::string bytes = ReadBytes(dir / "fused.ply");
  WriteBytes(dir / "cut.ply", bytes.substr(0, bytes.size() - 1));
  EXPECT_ERROR(CloudRanges(dir / "cut.ply"), "is no cloud of this program");
  WriteBytes(dir / "ascii.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nend_header\n1 2 3\n");
  EXPECT_ERROR(CloudRanges(dir / "ascii.ply"), "is no cloud of this program");
}

// A steep plane before two turned cameras, both maps exact. `shift`: the place in a pixel that its
// depth is taken at. Mean distance of what COLMAP fuses from the plane, in pixels there.
double FusedError(const TempDir& dir, double shift) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.8, 0.3, -1).normalized();
  const double offset = -3;  // normal . x = offset: about 3 before the cameras
  SparseModel model;
  Camera camera = MakeCamera(CameraModel::kPinhole, 80, 64, 48);
  camera.camera_id = 1;
  model.cameras[1] = camera;
  std::vector<std::string> names;
  for (uint32_t id = 1; id <= 2; ++id) {
    PosedImage image;
    image.image_id = id;
    image.camera_id = 1;
    image.name = "view" + std::to_string(id) + ".png";
    image.cam_from_world.translation = {id == 1 ? 0.0 : -0.05, 0, 0};
    names.push_back(image.name);
    model.images.push_back(image);
  }
  for (uint64_t k = 1; k <= 20; ++k) {
    SparsePoint point;
    point.xyz = {0.02 * static_cast<double>(k), 0, 3};
    for (PosedImage& image : model.images) {
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(*camera.ImgFromCam(image.cam_from_world * point.xyz));
      image.point3D_ids.push_back(k);
    }
    model.points3D[k] = point;
  }
  WriteSparseModelBinary(dir / "sparse", model);
  CreateDenseWorkspaceFolders(dir.Path(), names);
  WriteStereoConfigs(dir.Path(), names);
  for (const PosedImage& image : model.images) {
    WriteImage(UndistortedImagePath(dir.Path(), image.name), ColorImage(64, 48, 3, 100));
    FloatImage depth(64, 48), normals(64, 48, 3);
    const double offset_in_cam = offset + normal.dot(image.cam_from_world.translation);
    for (int r = 0; r < 48; ++r) {
      for (int c = 0; c < 64; ++c) {
        const auto ray = camera.CamFromImg({c + shift, r + shift});
        depth.At(c, r) = static_cast<float>(offset_in_cam / normal.dot(ray->homogeneous()));
        for (int k = 0; k < 3; ++k) normals.At(c, r, k) = static_cast<float>(normal[k]);
      }
    }
    WriteDenseMap(DepthMapPath(dir.Path(), image.name), depth);
    WriteDenseMap(NormalMapPath(dir.Path(), image.name), normals);
  }
  const std::string cloud = (dir / "x.ply").string();
  EXPECT_EQ(RunColmap("stereo_fusion --workspace_path " + dir.Path().string() + " --output_path " +
                      cloud + " --StereoFusion.min_num_pixels 2"),
            0);
  const std::vector<CloudPoint> points = ReadCloud(cloud);
  EXPECT_GT(points.size(), 500u);
  double sum = 0;
  for (const CloudPoint& point : points) {
    sum += std::abs(normal.dot(point.xyz.cast<double>()) - offset) / (3.0 / 80);
    EXPECT_GT(point.normal.cast<double>().dot(normal), 0.999);
  }
  return sum / static_cast<double>(points.size());
}

// What densify/maps/view_maps.h says of COLMAP: depths belong to the corners of the pixels.
TEST(DenseWorkspace, ColmapTakesDepthsAtTheCornersOfPixels) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap on PATH";
  const TempDir corner, center;
  EXPECT_LT(FusedError(corner, 0), 1e-3);
  EXPECT_GT(FusedError(center, 0.5), 0.05);
}

}  // namespace
}  // namespace colmap_seapoint
