// COLMAP's documented way with known poses: images.txt with poses alone and an empty points3D.txt.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

constexpr int kNumPictures = 5;

class ModelWithoutPoints : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", kNumPictures);
    SparseModel model = StripModel(kNumPictures);
    WriteSparseModelText(folder_ / "with points", model);
    model.points3D.clear();
    for (PosedImage& image : model.images) {
      image.points2D.clear();
      image.point3D_ids.clear();
    }
    WriteSparseModelText(folder_ / "text", model);
    WriteSparseModelBinary(folder_ / "binary", model);
  }

  CliResult Run(const std::string& command, const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = {command};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return RunProgram(SEAPOINT_PROGRAM, all);
  }
  CliResult Densify(const std::string& model, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--image_path",  (folder_ / "images").string(),
                                          "--input_path",  (folder_ / model).string(),
                                          "--output_path", (folder_ / ("dense " + model)).string(),
                                          "--num_threads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Run("partial_densifier", arguments);
  }
  double NumPoints(const std::string& model) const {
    return nlohmann::json::parse(ReadBytes(folder_ / ("dense " + model) / "run.json"))["points"];
  }

  TemporaryFolder folder_;
};

TEST_F(ModelWithoutPoints, GivesTheCloudThatPointsGive) {
  ASSERT_EQ(Densify("with points").exit_code, 0);
  const CliResult result = Densify("text");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.Text().find("were triangulated from matches"), std::string::npos);
  EXPECT_GT(NumPoints("text"), 0.97 * NumPoints("with points"));
  EXPECT_LT(NumPoints("text"), 1.03 * NumPoints("with points"));
  ASSERT_EQ(Densify("binary", {"--PartialDensification.write_maps", "1"}).exit_code, 0);
  EXPECT_EQ(ReadBytes(folder_ / "dense binary" / "fused.ply"),
            ReadBytes(folder_ / "dense text" / "fused.ply"));
}

TEST_F(ModelWithoutPoints, WithTheMatchesOfADatabase) {
  const std::string database = (folder_ / "database.db").string();
  ASSERT_EQ(Run("feature_extractor", {"--database_path", database, "--image_path",
                                      (folder_ / "images").string(), "--num_threads", "2"})
                .exit_code,
            0);
  ASSERT_EQ(
      Run("sequential_matcher", {"--database_path", database, "--num_threads", "2"}).exit_code, 0);
  ASSERT_EQ(Densify("with points", {"--database_path", database}).exit_code, 0);
  const CliResult result = Densify("text", {"--database_path", database});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_GT(NumPoints("text"), 0.97 * NumPoints("with points"));
}

}  // namespace
}  // namespace colmap_seapoint
