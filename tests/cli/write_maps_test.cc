// PartialDensification.write_maps: a dense workspace that COLMAP fuses.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 5;

bool HasColmap() { return RunProgram("/bin/sh", {"-c", "command -v colmap"}).exit_code == 0; }

class WriteMaps : public testing::Test {
 protected:
  // In sub-folders; in the file in no order; ids far from places.
  void SetUp() override {
    fs::create_directories(folder_ / "images" / "left dir");
    model_ = StripModel(kNumPictures);
    for (int i = 0; i < kNumPictures; ++i) {
      PosedImage& image = model_.images[static_cast<size_t>(i)];
      image.name = (i % 2 == 0 ? "left dir/img" : "img") + std::to_string(i + 1) + ".png";
      WriteImage(folder_ / "images" / image.name, StripPicture(i + 1));
    }
    for (PosedImage& image : model_.images) image.image_id = NewId(image.image_id);
    for (auto& [id, point] : model_.points3D) {
      for (auto& element : point.track) element.image_id = NewId(element.image_id);
    }
    std::swap(model_.images[0], model_.images[3]);
    std::swap(model_.images[1], model_.images[4]);
    WriteSparseModelBinary(folder_ / "model", model_);
  }

  static uint32_t NewId(uint32_t id) { return id < 100 ? 100 + 7 * id % 31 : id; }

  CliResult Densify(const std::string& output, int num_threads = 2, const CliOptions& options = {},
                    bool write_maps = true) const {
    return RunProgram(SEAPOINT_PROGRAM,
                      {"partial_densifier", "--image_path", (folder_ / "images").string(),
                       "--input_path", (folder_ / "model").string(), "--output_path",
                       (folder_ / output).string(), "--num_threads", std::to_string(num_threads),
                       "--PartialDensification.write_maps", write_maps ? "1" : "0"},
                      options);
  }

  // What does not tell of time.
  std::map<std::string, std::string> Files(const std::string& output) const {
    std::map<std::string, std::string> files;
    for (const auto& [name, bytes] : ReadTree(folder_ / output)) {
      if (name != "pairs.csv" && name != "run.json" && !IsLeftover(name)) files[name] = bytes;
    }
    return files;
  }

  // `point` as the `index`th picture of the model in `dir` sees it, in pixels from its border:
  // negative outside.
  static double Inside(const SparseModel& model, uint32_t index, const Eigen::Vector3f& point) {
    const PosedImage& image = model.images.at(index);
    const Camera& camera = model.cameras.at(image.camera_id);
    const auto pixel = camera.ImgFromCam(image.cam_from_world * point.cast<double>());
    if (!pixel) return -1e9;
    return std::min(
        {pixel->x(), pixel->y(), camera.width - pixel->x(), camera.height - pixel->y()});
  }

  // Which pictures see each point, of fused.ply.vis.
  static std::vector<std::vector<uint32_t>> ReadVisibility(const fs::path& path) {
    const std::string bytes = ReadBytes(path);
    size_t at = 0;
    const auto read = [&](void* value, size_t size) {
      ASSERT_LE(at + size, bytes.size());
      std::memcpy(value, bytes.data() + at, size);
      at += size;
    };
    uint64_t count = 0;
    read(&count, sizeof(count));
    std::vector<std::vector<uint32_t>> visibility(count);
    for (auto& seen_by : visibility) {
      uint32_t size = 0;
      read(&size, sizeof(size));
      seen_by.resize(size);
      read(seen_by.data(), size * sizeof(uint32_t));
    }
    EXPECT_EQ(at, bytes.size());
    return visibility;
  }

  TemporaryFolder folder_;
  SparseModel model_;
};

TEST_F(WriteMaps, SameFilesForAnyThreadsAndTheSameCloud) {
  const CliResult result = Densify("one", 1);
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  const auto files = Files("one");
  ASSERT_EQ(Densify("three", 3).exit_code, 0);
  EXPECT_TRUE(Files("three") == files);
  ASSERT_EQ(Densify("without", 2, {}, false).exit_code, 0);
  EXPECT_TRUE(ReadBytes(folder_ / "without" / "fused.ply") == files.at("fused.ply"));

  std::set<std::string> expected = {
      ".colmap_seapoint",  "fused.ply",           "fused.ply.vis",     "sparse/cameras.bin",
      "sparse/images.bin", "sparse/points3D.bin", "stereo/fusion.cfg", "stereo/patch-match.cfg",
      "units.json"};
  for (const PosedImage& image : model_.images) {
    expected.insert("images/" + image.name);
    expected.insert("stereo/depth_maps/" + image.name + ".geometric.bin");
    expected.insert("stereo/normal_maps/" + image.name + ".geometric.bin");
    // A pinhole's picture is undistorted: the same bytes.
    EXPECT_TRUE(files.at("images/" + image.name) == ReadBytes(folder_ / "images" / image.name));
  }
  std::set<std::string> names;
  for (const auto& [name, bytes] : files) names.insert(name);
  EXPECT_EQ(names, expected);
  EXPECT_TRUE(fs::is_directory(folder_ / "one" / "stereo" / "consistency_graphs"));
}

// The ground lies kStripRange before every camera.
TEST_F(WriteMaps, DepthsAreTheGround) {
  ASSERT_EQ(Densify("dense").exit_code, 0);
  for (const PosedImage& image : model_.images) {
    const FloatImage depth = ReadDenseMap(DepthMapPath(folder_ / "dense", image.name));
    const FloatImage normal = ReadDenseMap(NormalMapPath(folder_ / "dense", image.name));
    ASSERT_EQ(depth.width, kStripWidth);
    ASSERT_EQ(depth.height, kStripHeight);
    ASSERT_EQ(normal.channels, 3);
    int num_seen = 0, num_near = 0, num_upright = 0;
    for (int y = 0; y < depth.height; ++y) {
      for (int x = 0; x < depth.width; ++x) {
        if (depth.At(x, y) == 0) continue;
        ++num_seen;
        num_near += std::abs(depth.At(x, y) - kStripRange) < 0.002 * kStripRange;
        num_upright += normal.At(x, y, 2) < -0.98f;
      }
    }
    // A border of the cloud's outer pictures has no pair.
    EXPECT_GT(num_seen, 0.6 * kStripWidth * kStripHeight) << image.name;
    EXPECT_GT(num_near, 0.99 * num_seen) << image.name;
    EXPECT_GT(num_upright, 0.95 * num_seen) << image.name;
  }
}

// Versions differ in whether .vis counts pictures in images.bin or by id: there it is the same.
TEST_F(WriteMaps, VisibilityIsOfTheModelBeside) {
  ASSERT_EQ(Densify("dense").exit_code, 0);
  const SparseModel sparse = ReadSparseModel(folder_ / "dense" / "sparse");
  ASSERT_EQ(sparse.images.size(), model_.images.size());
  for (size_t i = 1; i < sparse.images.size(); ++i) {
    EXPECT_LT(sparse.images[i - 1].image_id, sparse.images[i].image_id);
  }
  const auto check = [&](const std::string& output, const SparseModel& model) {
    const auto points = ReadCloud(folder_ / output / "fused.ply");
    const auto visibility = ReadVisibility(folder_ / output / "fused.ply.vis");
    ASSERT_EQ(visibility.size(), points.size());
    for (size_t k = 0; k < points.size(); ++k) {
      ASSERT_EQ(visibility[k].size(), 2u);
      for (const uint32_t index : visibility[k]) {
        ASSERT_GT(Inside(model, index, points[k].xyz), -1) << k;
      }
    }
  };
  check("dense", sparse);
  // Without maps there is no model but the one that was given: its own order.
  ASSERT_EQ(Densify("without", 2, {}, false).exit_code, 0);
  check("without", ReadSparseModel(folder_ / "model"));
}

TEST_F(WriteMaps, KilledAndRunAgain) {
  ASSERT_EQ(Densify("whole").exit_code, 0);
  const auto expected = Files("whole");
  const std::string places[] = {"sparse/images.bin", "images/img2.png", "stereo/normal_maps"};
  int num_killed = 0;
  for (const std::string& place : places) {
    CliOptions options;
    options.kill_when = [&](double) {
      const fs::path path = folder_ / "killed" / place;
      return fs::is_directory(path) ? HoldsTemporaryFile(path) : fs::exists(path);
    };
    num_killed += Densify("killed", 2, options).signal_number == SIGKILL;
    const auto left = Files("killed");
    for (const auto& [name, bytes] : left) {
      EXPECT_TRUE(bytes == expected.at(name)) << name;
    }
    const CliResult again = Densify("killed", 1);
    ASSERT_EQ(again.exit_code, 0) << again.Text();
    EXPECT_TRUE(Files("killed") == expected) << place;
    EXPECT_FALSE(HoldsTemporaryFile(folder_ / "killed")) << place;
    fs::remove_all(folder_ / "killed");
  }
  EXPECT_GE(num_killed, 2);
}

TEST_F(WriteMaps, NeverOverTheOriginals) {
  const auto before = ReadTree(folder_.Path());
  // WS/images are the originals.
  CliResult result = Densify(".");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("choose another --output_path"), std::string::npos)
      << result.Text();
  // By way of a link.
  fs::create_directories(folder_ / "linked");
  fs::create_directory_symlink(folder_ / "images", folder_ / "linked" / "images");
  EXPECT_EQ(Densify("linked").exit_code, 1);
  fs::remove_all(folder_ / "linked");
  // WS/sparse is the model.
  fs::create_directories(folder_ / "ws" / "sparse");
  fs::rename(folder_ / "model", folder_ / "ws" / "sparse" / "0");
  fs::create_directory_symlink(folder_ / "ws" / "sparse" / "0", folder_ / "model");
  EXPECT_EQ(Densify("ws").exit_code, 1);
  fs::remove(folder_ / "model");
  fs::rename(folder_ / "ws" / "sparse" / "0", folder_ / "model");
  fs::remove_all(folder_ / "ws");
  EXPECT_TRUE(ReadTree(folder_.Path()) == before);
}

TEST_F(WriteMaps, NamesThatLeadOutAreRefused) {
  model_.images[2].name = "../../outside.png";
  WriteSparseModelBinary(folder_ / "model", model_);
  const CliResult result = Densify("deep/dense");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("outside.png"), std::string::npos) << result.Text();
  EXPECT_FALSE(fs::exists(folder_ / "outside.png"));
  EXPECT_FALSE(fs::exists(folder_ / "deep" / "outside.png"));
}

// A picture that has gone bad is named and left out; the others are fused.
TEST_F(WriteMaps, UnreadablePicture) {
  WriteBytes(folder_ / "images" / "img4.png", "");
  const CliResult result = Densify("dense");
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  const std::string list = ReadBytes(folder_ / "dense" / "stereo" / "fusion.cfg");
  EXPECT_EQ(list.find("img4.png"), std::string::npos) << list;
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), kNumPictures - 1);
}

TEST_F(WriteMaps, ColmapFusesThem) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap on PATH";
  ASSERT_EQ(Densify("dense").exit_code, 0);
  CliOptions options;
  options.environment["QT_QPA_PLATFORM"] = "offscreen";
  const std::string cloud = (folder_ / "colmap.ply").string();
  const CliResult result =
      RunProgram("/usr/bin/env",
                 {"colmap", "stereo_fusion", "--workspace_path", (folder_ / "dense").string(),
                  "--output_path", cloud, "--StereoFusion.min_num_pixels", "2"},
                 options);
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  const auto ours = ReadCloud(folder_ / "dense" / "fused.ply");
  const auto theirs = ReadCloud(cloud);
  // Squares of 4 x 4 pixels that hold points, which are compared for both.
  const double side = 4 * kStripRange / (1.2 * kStripWidth);
  const auto squares = [&](const std::vector<CloudPoint>& points) {
    std::set<std::pair<int, int>> filled;
    for (const CloudPoint& point : points) {
      filled.insert({static_cast<int>(std::floor(point.xyz.x() / side)),
                     static_cast<int>(std::floor(point.xyz.y() / side))});
    }
    return filled;
  };
  const auto in_ours = squares(ours), in_theirs = squares(theirs);
  std::vector<std::pair<int, int>> common;
  std::set_intersection(in_ours.begin(), in_ours.end(), in_theirs.begin(), in_theirs.end(),
                        std::back_inserter(common));
  EXPECT_GT(common.size(), 0.97 * static_cast<double>(in_ours.size()));
  EXPECT_GT(common.size(), 0.97 * static_cast<double>(in_theirs.size()));
  int64_t num_near = 0;
  for (const CloudPoint& point : theirs) {
    num_near += std::abs(point.xyz.z() - kStripRange) < 0.002 * kStripRange;
  }
  EXPECT_GT(num_near, 0.99 * static_cast<double>(theirs.size()));
  // COLMAP read the same pictures in the same order.
  const SparseModel sparse = ReadSparseModel(folder_ / "dense" / "sparse");
  const auto visibility = ReadVisibility(cloud + ".vis");
  ASSERT_EQ(visibility.size(), theirs.size());
  for (size_t k = 0; k < theirs.size(); ++k) {
    for (const uint32_t index : visibility[k]) {
      ASSERT_GT(Inside(sparse, index, theirs[k].xyz), -2) << k;
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
