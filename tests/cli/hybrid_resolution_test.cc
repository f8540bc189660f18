// Poses from reduced pictures, the dense cloud from full ones (paper 4): partial_densifier with
// pictures of another resolution than the model's cameras.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 5;

ColorImage Halved(const ColorImage& picture) {
  ColorImage half(picture.width / 2, picture.height / 2, 3);
  for (int y = 0; y < half.height; ++y) {
    const uint8_t* above = picture.Row(2 * y);
    const uint8_t* below = picture.Row(2 * y + 1);
    for (int i = 0; i < 3 * half.width; ++i) {
      const int at = 6 * (i / 3) + i % 3;
      const int sum = above[at] + above[at + 3] + below[at] + below[at + 3];
      half.Row(y)[i] = static_cast<uint8_t>((sum + 2) / 4);
    }
  }
  return half;
}

class HybridResolution : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "full", kNumPictures);
    fs::create_directories(folder_ / "half");
    for (const auto& entry : fs::directory_iterator(folder_ / "full")) {
      WriteImage(folder_ / "half" / entry.path().filename().string(),
                 Halved(ReadColorImage(entry.path())));
    }
    const SparseModel full = StripModel(kNumPictures);
    WriteSparseModelText(folder_ / "full model", full);
    SparseModel half = full;
    Camera& camera = half.cameras[1];
    camera.width /= 2;
    camera.height /= 2;
    for (double& param : camera.params) param /= 2;  // PINHOLE: fx, fy, cx, cy
    for (PosedImage& image : half.images) {
      for (Eigen::Vector2d& point : image.points2D) point /= 2;
    }
    WriteSparseModelText(folder_ / "half model", half);
  }

  CliResult Densify(const std::string& images, const std::string& model, const std::string& output,
                    const std::string& database = "") const {
    std::vector<std::string> arguments = {
        "partial_densifier",        "--image_path",  (folder_ / images).string(), "--input_path",
        (folder_ / model).string(), "--output_path", (folder_ / output).string()};
    if (!database.empty()) {
      arguments.insert(arguments.end(), {"--database_path", (folder_ / database).string()});
    }
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }

  // The ground is flat: the share of points within half a pixel of it, `reduction` times as large.
  double ShareOnGround(const std::string& output, double reduction = 1) const {
    const std::vector<CloudPoint> cloud = ReadCloud(folder_ / output / "fused.ply");
    const double gsd = kStripRange / (1.2 * kStripWidth);
    int64_t near = 0;
    for (const CloudPoint& point : cloud) {
      near += std::abs(point.xyz.z() - kStripRange) < 0.5 * reduction * gsd;
    }
    return static_cast<double>(near) / static_cast<double>(cloud.size());
  }

  TemporaryFolder folder_;
};

TEST_F(HybridResolution, FullPicturesOfAHalvedModelGiveTheFullCloud) {
  ASSERT_EQ(Densify("full", "full model", "from full").exit_code, 0);
  const CliResult result = Densify("full", "half model", "from half");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("5 pictures are of another resolution"), std::string::npos)
      << result.Text();
  // Factors of two are exact: nothing differs.
  for (const char* name : {"fused.ply", "fused.ply.vis"}) {
    EXPECT_EQ(ReadBytes(folder_ / "from half" / name), ReadBytes(folder_ / "from full" / name));
  }
}

TEST_F(HybridResolution, ReducedPicturesOfAFullModel) {
  ASSERT_EQ(Densify("half", "half model", "from half").exit_code, 0);
  ASSERT_EQ(Densify("half", "full model", "from full").exit_code, 0);
  EXPECT_EQ(ReadBytes(folder_ / "from half" / "fused.ply"),
            ReadBytes(folder_ / "from full" / "fused.ply"));
}

TEST_F(HybridResolution, SeaPointsOfReducedPicturesAreScaled) {
  const std::string database = (folder_ / "half.db").string();
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"feature_extractor", "--database_path", database,
                                              "--image_path", (folder_ / "half").string()},
                                             {"sequential_matcher", "--database_path", database}}) {
    const CliResult result = RunProgram(SEAPOINT_PROGRAM, command);
    ASSERT_EQ(result.exit_code, 0) << result.Text();
  }
  // Without triangulated points all seeds are SeaPoints.
  SparseModel model = ReadSparseModel(folder_ / "half model");
  model.points3D.clear();
  for (PosedImage& image : model.images) {
    image.points2D.clear();
    image.point3D_ids.clear();
  }
  // Two pictures that share triangulated points are needed for a pair: three points will do.
  for (uint64_t id = 1; id <= 3; ++id) {
    SparsePoint point;
    point.xyz = {0.1 + 0.2 * static_cast<double>(id), 0.1 * static_cast<double>(id) - 0.2,
                 kStripRange};
    for (PosedImage& image : model.images) {
      point.track.push_back({image.image_id, static_cast<uint32_t>(id - 1)});
      image.points2D.emplace_back(1, 1);
      image.point3D_ids.push_back(id);
    }
    model.points3D[id] = point;
  }
  WriteSparseModelText(folder_ / "poses", model);
  const CliResult result = Densify("full", "poses", "dense", "half.db");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(result.err.find("found again"), std::string::npos) << result.Text();
  EXPECT_GT(ShareOnGround("dense"), 0.99);
  const auto report = nlohmann::json::parse(ReadBytes(folder_ / "dense" / "run.json"));
  EXPECT_EQ(report["images_used"], kNumPictures);
}

TEST_F(HybridResolution, SomePicturesReducedAndSomeOfOtherProportions) {
  fs::copy(folder_ / "full", folder_ / "mixed");
  WriteImage(folder_ / "mixed" / "img2.png", Halved(StripPicture(2)));
  ColorImage cut(kStripWidth, kStripHeight - 1, 3);
  const ColorImage whole = StripPicture(5);
  std::copy(whole.data.begin(), whole.data.begin() + static_cast<long>(cut.data.size()),
            cut.data.begin());
  WriteImage(folder_ / "mixed" / "img5.png", cut);
  const CliResult result = Densify("mixed", "full model", "dense");
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.err.find("1 pictures are of another resolution"), std::string::npos)
      << result.Text();
  EXPECT_GT(ShareOnGround("dense", 2), 0.99);
  const auto report = nlohmann::json::parse(ReadBytes(folder_ / "dense" / "run.json"));
  ASSERT_EQ(report["left_out"].size(), 1u) << result.Text();
  EXPECT_EQ(report["left_out"][0]["name"], "img5.png");
  EXPECT_EQ(report["left_out"][0]["reason"],
            "is 400x299 but its camera in the model is 400x300, of other proportions");
  EXPECT_EQ(report["images_used"], kNumPictures - 1);
}

}  // namespace
}  // namespace colmap_seapoint
