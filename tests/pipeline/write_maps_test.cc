#include "colmap_seapoint/pipeline/write_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/dense_workspace.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class MapFolders : public testing::Test {
 protected:
  void Check(const std::string& images, const std::string& model, const std::string& output) const {
    CheckMapFolders(folder_ / images, folder_ / model, folder_ / output);
  }
  TemporaryFolder folder_;
};

TEST_F(MapFolders, ApartTheyAreFine) {
  EXPECT_NO_THROW(Check("images", "sparse/0", "dense"));
  EXPECT_NO_THROW(Check("images", "model", "images/../dense"));
  // The pictures' folder beside ours, and names that only begin alike.
  EXPECT_NO_THROW(Check("dense/pictures", "dense/model", "dense"));
  EXPECT_NO_THROW(Check("dense/images2", "dense/sparse2", "dense"));
}

TEST_F(MapFolders, NeverOverThePictures) {
  const std::string message = "would write undistorted pictures over yours";
  EXPECT_ERROR(Check("images", "model", "."), message);
  EXPECT_ERROR(Check("dense/images/", "model", "dense"), message);
  EXPECT_ERROR(Check("dense/images/left", "model", "dense"), message);  // holds them
  EXPECT_ERROR(Check("all", "model", "all/dense"), message);            // is in them
  EXPECT_ERROR(Check("a/../dense/images", "model", "dense/b/.."), message);
}

TEST_F(MapFolders, NeverOverTheModel) {
  const std::string message = "would write the undistorted model over yours";
  EXPECT_ERROR(Check("images", "dense/sparse", "dense"), message);
  EXPECT_ERROR(Check("images", "dense/sparse/0", "dense"), message);
  EXPECT_ERROR(Check("images", "ws", "ws/dense"), message);
}

TEST_F(MapFolders, LinksAreFollowed) {
  fs::create_directories(folder_ / "images");
  fs::create_directories(folder_ / "dense");
  fs::create_directory_symlink(folder_ / "images", folder_ / "dense/images");
  EXPECT_ERROR(Check("images", "model", "dense"), "choose another --output_path");
}

class MapWriterTest : public StripSurvey {
 protected:
  static constexpr int kStep = 2;  // pixels between samples

  void SetUp() override {
    WritePictures(3);
    model_ = StripModel(3);
    options_.step = kStep;
    fs::create_directories(Output());
  }

  fs::path Output() const { return folder_ / "dense"; }

  // What a pair of pictures would give of the ground: a point every kStep pixels of the first.
  PartialCloud Ground(int image_idx1, int image_idx2) const {
    PartialCloud part;
    part.image_idx1 = image_idx1;
    part.image_idx2 = image_idx2;
    const PosedImage& image = model_.images[static_cast<size_t>(image_idx1)];
    const Camera& camera = model_.cameras.at(image.camera_id);
    for (int y = kStep / 2; y < kStripHeight; y += kStep) {
      for (int x = kStep / 2; x < kStripWidth; x += kStep) {
        const auto ray = camera.CamFromImg({x, y});
        const Eigen::Vector3d point(kStripRange * ray->x(), kStripRange * ray->y(), kStripRange);
        part.points.push_back({(image.cam_from_world.Inverse() * point).cast<float>(),
                               Eigen::Vector3f(0, 0, -1),
                               {1, 2, 3},
                               1});
      }
    }
    return part;
  }

  // fused.ply of these parts, of which the writer knows.
  void WriteCloud(const std::vector<PartialCloud>& parts, MapWriter* maps) const {
    CloudWriter cloud(Output() / "fused.ply");
    const uint32_t seen_by[] = {0, 1};
    for (const PartialCloud& part : parts) {
      maps->AddPair(part, cloud.NumPoints());
      for (const DensePoint& point : part.points) {
        cloud.Add({point.xyz, point.normal, point.rgb, point.confidence}, seen_by, 2);
      }
    }
    cloud.Finish();
  }

  RunReport Write(const std::vector<PartialCloud>& parts,
                  const std::vector<LeftOutPicture>& left_out = {}, int num_threads = 1) const {
    MapWriter maps(model_, Images(), PictureMasks(""), Output(), options_, num_threads);
    WriteCloud(parts, &maps);
    RunReport report;
    maps.WriteMaps(left_out, &report);
    return report;
  }

  FloatImage Depth(const std::string& name) const {
    return ReadDenseMap(DepthMapPath(Output(), name));
  }
  // Share of the columns [first, last) that hold the ground's depth; nothing else may be there.
  static double ShareOfGround(const FloatImage& depth, int first, int last) {
    int num_ground = 0;
    for (int y = 0; y < depth.height; ++y) {
      for (int x = first; x < last; ++x) {
        const float value = depth.At(x, y);
        if (value == 0) continue;
        EXPECT_NEAR(value, kStripRange, 1e-4) << x << " " << y;
        ++num_ground;
      }
    }
    return static_cast<double>(num_ground) / ((last - first) * depth.height);
  }

  SparseModel model_;
  PartialDensificationOptions options_;
};

TEST_F(MapWriterTest, APairIsInEveryPictureThatSeesIt) {
  // 30,000 points: more than one block.
  EXPECT_TRUE(Write({Ground(0, 1)}).left_out.empty());
  EXPECT_GT(ShareOfGround(Depth("img1.png"), 0, kStripWidth), 0.98);
  // A neighbour's first column shows what is a step further in.
  for (int k = 1; k <= 2; ++k) {
    const FloatImage depth = Depth("img" + std::to_string(k + 1) + ".png");
    const int seen = kStripWidth - k * kStripStep;
    EXPECT_GT(ShareOfGround(depth, 0, seen - kStep), 0.98) << k;
    EXPECT_EQ(ShareOfGround(depth, seen + kStep, kStripWidth), 0) << k;
  }
  const FloatImage normal = ReadDenseMap(NormalMapPath(Output(), "img2.png"));
  EXPECT_NEAR(normal.At(100, 100, 0), 0, 1e-6);
  EXPECT_NEAR(normal.At(100, 100, 2), -1, 1e-6);
}

TEST_F(MapWriterTest, PairsAddUp) {
  PartialCloud first = Ground(0, 1), second = Ground(2, 1);
  Write({first, second});
  EXPECT_GT(ShareOfGround(Depth("img2.png"), 0, kStripWidth), 0.98);
  EXPECT_GT(ShareOfGround(Depth("img3.png"), 0, kStripWidth), 0.98);
}

TEST_F(MapWriterTest, PointsThatAreNotFiniteAreNotCounted) {
  Write({Ground(2, 1), Ground(0, 1)});
  const auto expected = ReadTree(Output() / "stereo");
  // In the last pair: if they counted, its last block would end behind the cloud.
  PartialCloud first = Ground(0, 1);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const size_t at : {0u, 8191u, 20000u}) {
    DensePoint point = first.points[at];
    (at == 0 ? point.normal.x() : point.xyz.z()) = kNaN;
    first.points.insert(first.points.begin() + static_cast<std::ptrdiff_t>(at), point);
  }
  PartialCloud nothing;
  nothing.image_idx1 = 0;
  nothing.image_idx2 = 1;
  nothing.points = {first.points[0]};
  Write({nothing, Ground(2, 1), first});
  EXPECT_TRUE(ReadTree(Output() / "stereo") == expected);
}

TEST_F(MapWriterTest, TheSameFilesForAnyNumberOfThreads) {
  Write({Ground(0, 1), Ground(1, 2)}, {}, 1);
  const auto expected = ReadTree(Output());
  fs::remove_all(Output() / "stereo");
  Write({Ground(0, 1), Ground(1, 2)}, {}, 3);
  EXPECT_TRUE(ReadTree(Output()) == expected);
}

TEST_F(MapWriterTest, PicturesThatAreLeftOutAreNotFused) {
  // One that densification could not read; one that went bad since; one of another size.
  WriteBytes(Images() / "img2.png", "");
  const RunReport report = Write({Ground(0, 1)}, {{2, "could not be read"}});
  EXPECT_EQ(NamesOf(report.left_out), std::vector<std::string>{"img2.png"});
  const std::string list = ReadBytes(Output() / "stereo/fusion.cfg");
  EXPECT_EQ(list, "img1.png\n");
  EXPECT_FALSE(fs::exists(DepthMapPath(Output(), "img3.png")));
  WriteImage(Images() / "img2.png", ColorImage(8, 8, 3, 50));
  const RunReport again = Write({Ground(0, 1)}, {{2, "could not be read"}});
  ASSERT_EQ(NamesOf(again.left_out), std::vector<std::string>{"img2.png"});
  EXPECT_EQ(again.left_out[0].reason, "is of another size than its camera");
}

TEST_F(MapWriterTest, APinholesPictureIsCopied) {
  Write({Ground(0, 1)});
  EXPECT_TRUE(ReadBytes(Output() / "images/img1.png") == ReadBytes(Images() / "img1.png"));
}

TEST_F(MapWriterTest, ALensIsTakenOutOfPicturesAndModel) {
  Camera camera =
      MakeCamera(CameraModel::kSimpleRadial, 1.2 * kStripWidth, kStripWidth, kStripHeight);
  camera.camera_id = 1;
  camera.params.back() = -0.1;
  model_.cameras[1] = camera;
  GrayImage gray(kStripWidth, kStripHeight, 1, 100);
  for (int x = 0; x < kStripWidth; ++x) gray.At(x, 150) = 200;
  WriteImage(Images() / "img1.png", gray);
  const MapWriter maps(model_, Images(), PictureMasks(""), Output(), options_, 1);
  maps.WriteModel(model_);
  const SparseModel undistorted = ReadSparseModel(Output() / "sparse");
  const Camera& pinhole = undistorted.cameras.at(1);
  EXPECT_EQ(pinhole.model, CameraModel::kPinhole);
  EXPECT_EQ(pinhole.FocalX(), camera.FocalX());
  ASSERT_EQ(undistorted.images.size(), 3u);
  EXPECT_EQ(undistorted.images[1].name, "img2.png");
  Write({Ground(0, 1)});
  for (const char* name : {"img1.png", "img2.png"}) {
    const ImageInfo info = ReadImageInfo(Output() / "images" / name);
    EXPECT_EQ(info.width, pinhole.width) << name;
    EXPECT_EQ(info.height, pinhole.height) << name;
  }
  // Grey stays grey: one channel, a third of the bytes; colour stays colour.
  const std::string png = ReadBytes(Output() / "images/img1.png");
  ASSERT_GT(png.size(), 26u);
  EXPECT_EQ(png[25], 0);  // PNG's colour type: 0 grey, 2 red green blue
  EXPECT_EQ(ReadBytes(Output() / "images/img2.png")[25], 2);
  const ColorImage picture = ReadColorImage(Output() / "images/img1.png");
  EXPECT_EQ(picture.At(picture.width / 2, 5), 100);
  EXPECT_TRUE(std::any_of(picture.data.begin(), picture.data.end(),
                          [](uint8_t value) { return value > 150; }));
}

}  // namespace
}  // namespace colmap_seapoint
