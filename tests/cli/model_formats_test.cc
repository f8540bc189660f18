// The forms that a model comes in: binary and text, with and without the rigs and frames of COLMAP
// 3.12 and later, several side by side.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 4;

template <typename Value>
void Put(Value value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void PutPose(const Rigid3d& pose, std::string* bytes) {
  const Eigen::Quaterniond& q = pose.rotation;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) Put(value, bytes);
  for (const double value : pose.translation) Put(value, bytes);
}

// One rig with one camera; u64 count; {u32 rig_id, u32 sensors, {i32 type, u32 sensor_id}}.
std::string RigsBinary() {
  std::string bytes;
  Put(uint64_t{1}, &bytes);
  Put(uint32_t{1}, &bytes);
  Put(uint32_t{1}, &bytes);
  Put(int32_t{0}, &bytes);
  Put(uint32_t{1}, &bytes);
  return bytes;
}

// A frame for every image: u64 count; {u32 frame_id, u32 rig_id, 7 f64, u32 count, {i32 type, u32
// sensor_id, u64 data_id}}.
std::string FramesBinary(const SparseModel& model) {
  std::string bytes;
  Put(uint64_t{model.images.size()}, &bytes);
  for (const PosedImage& image : model.images) {
    Put(image.image_id, &bytes);
    Put(uint32_t{1}, &bytes);
    PutPose(image.cam_from_world, &bytes);
    Put(uint32_t{1}, &bytes);
    Put(int32_t{0}, &bytes);
    Put(image.camera_id, &bytes);
    Put(uint64_t{image.image_id}, &bytes);
  }
  return bytes;
}

std::string FramesText(const SparseModel& model) {
  std::string text =
      "# Frame list with one line of data per frame:\n"
      "#   FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, TX, TY, TZ], NUM_DATA_IDS, "
      "DATA_IDS[]\n";
  for (const PosedImage& image : model.images) {
    text += std::to_string(image.image_id) + " 1 1 0 0 0 " +
            std::to_string(image.cam_from_world.translation.x()) + " 0 0 1 CAMERA " +
            std::to_string(image.camera_id) + " " + std::to_string(image.image_id) + "\n";
  }
  return text;
}

class ModelFormats : public testing::Test {
 protected:
  void SetUp() override { WriteStrip(folder_ / "images", kNumPictures); }

  CliResult Densify(const std::string& input, const std::string& output) const {
    return RunProgram(
        SEAPOINT_PROGRAM,
        {"partial_densifier", "--image_path", (folder_ / "images").string(), "--input_path",
         (folder_ / input).string(), "--output_path", (folder_ / output).string()});
  }

  std::string Cloud(const std::string& output) const {
    return ReadBytes(folder_ / output / "fused.ply");
  }

  TemporaryFolder folder_;
  const SparseModel model_ = StripModel(kNumPictures);
};

TEST_F(ModelFormats, AllGiveTheSameCloud) {
  WriteSparseModelBinary(folder_ / "bin", model_);
  WriteSparseModelText(folder_ / "txt", model_);
  WriteSparseModelBinary(folder_ / "bin_frames", model_);
  WriteBytes(folder_ / "bin_frames/rigs.bin", RigsBinary());
  WriteBytes(folder_ / "bin_frames/frames.bin", FramesBinary(model_));
  WriteSparseModelText(folder_ / "txt_frames", model_);
  WriteBytes(folder_ / "txt_frames/rigs.txt", "# Rig calib list\n1 1 CAMERA 1\n");
  WriteBytes(folder_ / "txt_frames/frames.txt", FramesText(model_));
  for (const std::string form : {"bin", "txt", "bin_frames", "txt_frames"}) {
    const CliResult result = Densify(form, "dense_" + form);
    ASSERT_EQ(result.exit_code, 0) << form << "\n" << result.Text();
    EXPECT_EQ(result.err.find("warning"), std::string::npos) << form << "\n" << result.Text();
    EXPECT_TRUE(Cloud("dense_" + form) == Cloud("dense_bin")) << form;
  }
}

TEST_F(ModelFormats, SeveralSideBySide) {
  WriteSparseModelBinary(folder_ / "sparse/0", model_);
  WriteSparseModelText(folder_ / "sparse/1", model_);
  WriteBytes(folder_ / "sparse/project.ini", "[Mapper]\n");
  CliResult result = Densify("sparse", "dense");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  ASSERT_EQ(Densify("sparse/0", "alone").exit_code, 0);
  for (const std::string name : {"dense/0", "dense/1"}) {
    EXPECT_TRUE(Cloud(name) == Cloud("alone")) << name;
    EXPECT_TRUE(fs::exists(folder_ / name / "run.json"));
  }
  EXPECT_FALSE(fs::exists(folder_ / "dense/fused.ply"));

  // One that gives nothing is named, and the others are made all the same.
  SparseModel lonely = model_;
  lonely.images.resize(1);
  for (auto& [id, point] : lonely.points3D) {
    point.track.erase(std::remove_if(point.track.begin(), point.track.end(),
                                     [&](const auto& element) {
                                       return element.image_id != lonely.images[0].image_id;
                                     }),
                      point.track.end());
  }
  WriteSparseModelBinary(folder_ / "sparse/0", lonely);
  fs::remove_all(folder_ / "dense");
  result = Densify("sparse", "dense");
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.err.find("sparse/0 is left out: no pair"), std::string::npos) << result.Text();
  EXPECT_TRUE(Cloud("dense/1") == Cloud("alone"));
  fs::remove_all(folder_ / "sparse/1");
  result = Densify("sparse", "dense");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("no pair of any of its models"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
