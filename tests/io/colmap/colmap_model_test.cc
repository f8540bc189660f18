#include "colmap_seapoint/io/colmap/colmap_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

SparseModel MakeModel() {
  SparseModel model;
  Camera camera = MakeCamera(CameraModel::kOpenCV, 1234.5678901234567, 640, 480);
  camera.camera_id = 3;
  camera.params[4] = -1.0 / 3.0;
  model.cameras[3] = camera;
  for (const uint32_t image_id : {9u, 4u}) {  // not sorted: the order is kept
    PosedImage image;
    image.image_id = image_id;
    image.camera_id = 3;
    image.name = "dive 1/picture " + std::to_string(image_id) + ".jpg";
    image.cam_from_world.rotation = Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3).normalized();
    image.cam_from_world.translation = Eigen::Vector3d(0.1, -1e-17, 12345.678901234567);
    if (image_id == 9) {
      image.points2D = {Eigen::Vector2d(1.0 / 3.0, 2), Eigen::Vector2d(3, 4)};
      image.point3D_ids = {kNoPoint3D, 77};
    }
    model.images.push_back(image);
  }
  SparsePoint point;
  point.xyz = Eigen::Vector3d(M_PI, -M_E, 1e-300);
  point.rgb = {1, 20, 255};
  point.error = 0.7;
  point.track = {{9, 1}};
  model.points3D[77] = point;
  return model;
}

void ExpectSame(const SparseModel& a, const SparseModel& b) {
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (const auto& [camera_id, camera] : a.cameras) {
    const Camera& other = b.cameras.at(camera_id);
    EXPECT_EQ(camera.camera_id, other.camera_id);
    EXPECT_EQ(camera.model, other.model);
    EXPECT_EQ(camera.width, other.width);
    EXPECT_EQ(camera.height, other.height);
    EXPECT_EQ(camera.params, other.params);
  }
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].image_id, b.images[i].image_id);
    EXPECT_EQ(a.images[i].camera_id, b.images[i].camera_id);
    EXPECT_EQ(a.images[i].name, b.images[i].name);
    EXPECT_LT(
        a.images[i].cam_from_world.rotation.angularDistance(b.images[i].cam_from_world.rotation),
        1e-15);
    EXPECT_EQ(a.images[i].cam_from_world.translation, b.images[i].cam_from_world.translation);
    EXPECT_EQ(a.images[i].points2D, b.images[i].points2D);
    EXPECT_EQ(a.images[i].point3D_ids, b.images[i].point3D_ids);
  }
  ASSERT_EQ(a.points3D.size(), b.points3D.size());
  for (const auto& [point3D_id, point] : a.points3D) {
    const SparsePoint& other = b.points3D.at(point3D_id);
    EXPECT_EQ(point.xyz, other.xyz);
    EXPECT_EQ(point.rgb, other.rgb);
    EXPECT_EQ(point.error, other.error);
    ASSERT_EQ(point.track.size(), other.track.size());
    for (size_t i = 0; i < point.track.size(); ++i) {
      EXPECT_EQ(point.track[i].image_id, other.track[i].image_id);
      EXPECT_EQ(point.track[i].point2D_idx, other.track[i].point2D_idx);
    }
  }
}

void Replace(const std::filesystem::path& path, const std::string& from, const std::string& to) {
  std::string text = ReadBytes(path);
  const size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  WriteBytes(path, text.replace(at, from.size(), to));
}

TEST(ColmapModel, BinaryRoundTrip) {
  const TempDir dir;
  EXPECT_FALSE(IsSparseModel(dir.Path()));
  WriteSparseModelBinary(dir / "sparse/0", MakeModel());
  EXPECT_TRUE(IsSparseModel(dir / "sparse/0"));
  ExpectSame(MakeModel(), ReadSparseModel(dir / "sparse/0"));
}

TEST(ColmapModel, TextRoundTripIsExact) {
  const TempDir dir;
  WriteSparseModelText(dir.Path(), MakeModel());
  ExpectSame(MakeModel(), ReadSparseModel(dir.Path()));
}

TEST(ColmapModel, PosesAndPointsAlone) {
  const TempDir dir;
  SparseModel expected = MakeModel();
  bool any_dropped = false;
  for (PosedImage& image : expected.images) {
    image.points2D.clear();
    auto& ids = image.point3D_ids;
    const size_t before = ids.size();
    ids.erase(std::remove(ids.begin(), ids.end(), kNoPoint3D), ids.end());
    any_dropped = any_dropped || ids.size() < before;
  }
  ASSERT_TRUE(any_dropped);
  WriteSparseModelBinary(dir / "binary", MakeModel());
  ExpectSame(expected, ReadSparseModel(dir / "binary", ModelContent::kPosesAndPoints));
  WriteSparseModelText(dir / "text", MakeModel());
  ExpectSame(expected, ReadSparseModel(dir / "text", ModelContent::kPosesAndPoints));
}

TEST(ColmapModel, BinaryIsPreferred) {
  const TempDir dir;
  WriteSparseModelBinary(dir.Path(), MakeModel());
  WriteSparseModelText(dir.Path(), SparseModel());
  EXPECT_EQ(ReadSparseModel(dir.Path()).images.size(), 2u);
  WriteBytes(dir / "frames.bin", "whatever newer versions write");
  EXPECT_EQ(ReadSparseModel(dir.Path()).images.size(), 2u);
}

// As COLMAP 3.12 writes them: u64 count; {u32 frame_id, u32 rig_id, 7 f64, u32 count, {i32 sensor
// type, u32 sensor_id, u64 data_id}}. Type 0 is a camera, 1 an inertial sensor.
std::string FramesBinary(const std::vector<std::vector<std::pair<int32_t, uint64_t>>>& frames) {
  std::string bytes;
  const auto put = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  put(static_cast<uint64_t>(frames.size()));
  uint32_t frame_id = 0;
  for (const auto& frame : frames) {
    put(++frame_id);
    put(uint32_t{1});
    for (int i = 0; i < 7; ++i) put(0.5);
    put(static_cast<uint32_t>(frame.size()));
    uint32_t sensor_id = 0;
    for (const auto& [type, data_id] : frame) {
      put(type);
      put(++sensor_id);
      put(data_id);
    }
  }
  return bytes;
}

TEST(ColmapModel, Frames) {
  const TempDir dir;
  WriteSparseModelText(dir.Path(), MakeModel());
  EXPECT_TRUE(ReadFrames(dir.Path(), MakeModel()).empty());
  const std::string pose = " 1 1 0 0 0 0.5 -1e-3 2 ";
  WriteBytes(dir / "frames.txt", "# Frame list\n1" + pose + "3 CAMERA 1 4 CAMERA 2 9 IMU 1 4\n2" +
                                     pose + "2 CAMERA 1 5 CAMERA 2 6\n");
  EXPECT_EQ(ReadFrames(dir.Path(), MakeModel()), (std::vector<Frame>{{4, 9}}));
  WriteBytes(dir / "frames.txt", "1" + pose + "1 CAMERA 1 4\n2" + pose + "1 CAMERA 2 9\n");
  EXPECT_TRUE(ReadFrames(dir.Path(), MakeModel()).empty());
  WriteBytes(dir / "frames.txt", "1" + pose + "2 CAMERA 1 4");
  EXPECT_ERROR(ReadFrames(dir.Path(), MakeModel()), "frames.txt: line 1: the line ends before");
  WriteBytes(dir / "frames.txt", "1" + pose + "2 CAMERA 1 4 CAMERA 2 4");
  EXPECT_ERROR(ReadFrames(dir.Path(), MakeModel()), "image 4 stands in two frames");

  WriteSparseModelBinary(dir.Path(), MakeModel());
  EXPECT_TRUE(ReadFrames(dir.Path(), MakeModel()).empty());  // the text belongs to the text model
  const std::string bytes = FramesBinary({{{0, 9}, {1, 4}, {0, 4}}, {{0, 5}, {0, 6}}});
  WriteBytes(dir / "frames.bin", bytes);
  EXPECT_EQ(ReadFrames(dir.Path(), MakeModel()), (std::vector<Frame>{{9, 4}}));
  for (size_t size = 0; size < bytes.size(); ++size) {
    WriteBytes(dir / "frames.bin", bytes.substr(0, size));
    EXPECT_ERROR(ReadFrames(dir.Path(), MakeModel()), "frames.bin");
  }
  WriteBytes(dir / "frames.bin", bytes + "x");
  EXPECT_ERROR(ReadFrames(dir.Path(), MakeModel()), "bytes follow the last record");
  std::string many = bytes;
  many[8 + 64 + 3] = 127;  // two thousand million pictures in the first frame
  WriteBytes(dir / "frames.bin", many);
  EXPECT_ERROR(ReadFrames(dir.Path(), MakeModel()), "pictures of a frame is more than the file");
}

// COLMAP 4.2.1 would go on with the poses that its frames had before.
TEST(ColmapModel, WritingLeavesNoFramesOfOtherPoses) {
  const TempDir dir;
  for (const bool is_binary : {true, false}) {
    const auto names = {"rigs.bin", "frames.bin", "rigs.txt", "frames.txt"};
    for (const char* name : names) WriteBytes(dir / name, "of other poses");
    is_binary ? WriteSparseModelBinary(dir.Path(), MakeModel())
              : WriteSparseModelText(dir.Path(), MakeModel());
    for (const char* name : names) EXPECT_FALSE(std::filesystem::exists(dir / name)) << name;
    EXPECT_EQ(ReadSparseModel(dir.Path()).images.size(), 2u);
  }
  // A folder in the place of one is not removed with all that it holds.
  std::filesystem::create_directories(dir / "frames.bin" / "mine");
  EXPECT_ERROR(WriteSparseModelBinary(dir.Path(), MakeModel()), "frames.bin");
  EXPECT_TRUE(std::filesystem::exists(dir / "frames.bin" / "mine"));
}

TEST(ColmapModel, MissingFiles) {
  const TempDir dir;
  EXPECT_ERROR(ReadSparseModel(dir / "missing"), "there is no such folder");
  EXPECT_ERROR(ReadSparseModel(dir.Path()), "holds no COLMAP model");
  WriteSparseModelBinary(dir.Path(), MakeModel());
  std::filesystem::remove(dir / "images.bin");
  EXPECT_ERROR(ReadSparseModel(dir.Path()), "images.bin: this file of the model is missing");
}

TEST(ColmapModel, EveryTruncationAndAppendixOfBinaryIsAnError) {
  const TempDir dir;
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteSparseModelBinary(dir.Path(), MakeModel());
    const std::string whole = ReadBytes(dir / name);
    for (size_t size = 0; size < whole.size(); ++size) {
      WriteBytes(dir / name, whole.substr(0, size));
      EXPECT_ERROR(ReadSparseModel(dir.Path()), name);
    }
    WriteBytes(dir / name, whole + "x");
    EXPECT_ERROR(ReadSparseModel(dir.Path()), "bytes follow the last record");
  }
}

// Any eight bytes may be a count: none may make the reader crash or reserve gigabytes.
TEST(ColmapModel, CorruptCountsNeverCrash) {
  const TempDir dir;
  int num_errors = 0, num_cases = 0;
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteSparseModelBinary(dir.Path(), MakeModel());
    const std::string whole = ReadBytes(dir / name);
    for (size_t at = 0; at + 8 <= whole.size(); ++at) {
      for (const char value : {'\xff', '\x7f', '\0'}) {
        std::string damaged = whole;
        std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), 8, value);
        WriteBytes(dir / name, damaged);
        ++num_cases;
        try {
          ReadSparseModel(dir.Path());
        } catch (const Error&) {
          ++num_errors;
        }
      }
    }
    WriteBytes(dir / name, std::string(8, '\xff') + whole.substr(8));
    EXPECT_ERROR(ReadSparseModel(dir.Path()), "more than the file can hold");
  }
  EXPECT_GT(num_errors, num_cases / 3);
}

TEST(ColmapModel, InconsistentModels) {
  const TempDir dir;
  const auto expect = [&](const std::function<void(SparseModel*)>& change, const char* part) {
    SparseModel model = MakeModel();
    change(&model);
    WriteSparseModelBinary(dir.Path(), model);
    EXPECT_ERROR(ReadSparseModel(dir.Path()), part);
  };
  expect([](SparseModel* m) { m->images[0].camera_id = 8; }, "camera 8, which does not exist");
  expect([](SparseModel* m) { m->images[0].point3D_ids[0] = 5; }, "point 5, which does not exist");
  expect([](SparseModel* m) { m->points3D[77].track[0].image_id = 1; }, "which does not exist");
  expect([](SparseModel* m) { m->points3D[77].track[0].point2D_idx = 2; }, "which does not exist");
  expect([](SparseModel* m) { m->images[1].image_id = 9; }, "stands there twice");
  expect([](SparseModel* m) { m->images[1].name = m->images[0].name; }, "the same name");
  expect([](SparseModel* m) { m->images[0].name = "../outside.jpg"; }, "out of the image folder");
  expect([](SparseModel* m) { m->images[0].name = "/etc/passwd"; }, "out of the image folder");
  expect([](SparseModel* m) { m->images[0].name = ""; }, "out of the image folder");
  expect([](SparseModel* m) { m->images[0].cam_from_world.translation.x() = NAN; }, "not finite");
  expect([](SparseModel* m) { m->images[0].cam_from_world.rotation.coeffs().setZero(); },
         "no rotation");
  expect([](SparseModel* m) { m->images[0].cam_from_world.rotation.coeffs().setConstant(1e300); },
         "no rotation");
  expect([](SparseModel* m) { m->images[0].points2D[0].x() = INFINITY; }, "not finite");
  expect([](SparseModel* m) { m->points3D[77].xyz.z() = NAN; }, "point 77 is not finite");
  expect([](SparseModel* m) { m->cameras[3].params[2] = NAN; }, "not finite");
  expect([](SparseModel* m) { m->cameras[3].params[0] = 0; }, "focal length");
  expect([](SparseModel* m) { m->cameras[3].width = 0; }, "impossible size");
  expect([](SparseModel* m) { m->cameras[3].model = static_cast<CameraModel>(42); },
         "unknown camera model 42");
}

TEST(ColmapModel, HostileText) {
  const TempDir dir;
  const auto expect = [&](const char* file, const char* from, const char* to, const char* part) {
    WriteSparseModelText(dir.Path(), MakeModel());
    Replace(dir / file, from, to);
    EXPECT_ERROR(ReadSparseModel(dir.Path()), part);
  };
  expect("cameras.txt", "640", "64O", "line 4: '64O' is no legal value of WIDTH");
  expect("cameras.txt", "640", "-640", "is no legal value of WIDTH");
  expect("cameras.txt", "OPENCV", "OPENCVX", "unknown camera model 'OPENCVX'");
  expect("cameras.txt", "OPENCV", "PINHOLE", "has 8 parameters, but PINHOLE has 4");
  expect("cameras.txt", "1234.5", "nan", "is no legal value of PARAMS");
  expect("images.txt", "9 0", "9 0,", "line 5: ");
  expect("images.txt", "dive 1/picture 9.jpg", "../x.jpg", "out of the image folder");
  expect("images.txt", "dive 1/picture 9.jpg", "", "line 5: ");
  expect("images.txt", " -1 3", " -7 3", "line 6: POINT3D_ID -7 is negative");
  expect("images.txt", " 77\n", "\n", "line 6: the line ends before POINT3D_ID");
  expect("points3D.txt", " 255 ", " 256 ", "line 4: '256' is no legal value of R, G, B");
  expect("points3D.txt", " 9 1\n", " 9\n", "the line ends before TRACK[]");
}

TEST(ColmapModel, TextWithoutTheLastEmptyLine) {
  const TempDir dir;
  WriteSparseModelText(dir.Path(), MakeModel());
  std::string images = ReadBytes(dir / "images.txt");
  while (images.back() == '\n') images.pop_back();
  WriteBytes(dir / "images.txt", images);
  ExpectSame(MakeModel(), ReadSparseModel(dir.Path()));
}

}  // namespace
}  // namespace colmap_seapoint
