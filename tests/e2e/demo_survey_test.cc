// From pictures to a scored cloud, as scripts/demo.sh does it, with one thread and with two.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

CliOptions WithinMinutes(double minutes) {
  CliOptions options;
  options.timeout_seconds = 60 * minutes;
  return options;
}

CliResult Reconstruct(const fs::path& pictures, const fs::path& workspace, int num_threads) {
  return RunProgram(
      SEAPOINT_PROGRAM,
      {"automatic_reconstructor", "--image_path", pictures.string(), "--workspace_path",
       workspace.string(), "--num_threads", std::to_string(num_threads)},
      WithinMinutes(3));
}

TEST(DemoSurvey, ReconstructedThroughTheRealMapper) {
  const TemporaryFolder folder;
  const fs::path survey = folder / "survey";
  ASSERT_EQ(
      RunProgram(DEMO_SURVEY, {"generate", "--output_path", survey.string()}, WithinMinutes(3))
          .exit_code,
      0);
  const fs::path workspace = folder / "one_thread";
  const CliResult run = Reconstruct(survey / "images", workspace, 1);
  ASSERT_EQ(run.exit_code, 0) << run.Text();

  const fs::path score_path = folder / "score.json";
  const CliResult scored =
      RunProgram(DEMO_SURVEY,
                 {"score", "--survey_path", survey.string(), "--input_path",
                  (workspace / "sparse/0").string(), "--cloud_path",
                  (workspace / "dense/0/fused.ply").string(), "--output_path", score_path.string()},
                 WithinMinutes(2));
  ASSERT_EQ(scored.exit_code, 0) << scored.Text();
  const auto score = nlohmann::json::parse(std::ifstream(score_path));
  EXPECT_EQ(score["num_registered"], score["num_images"]);
  EXPECT_GE(score["share_within_4gsd"], 0.95);
  EXPECT_GE(score["coverage_4gsd"], 0.90);
  EXPECT_LE(score["centre_rms_mm"], 2.0);
  EXPECT_LE(score["redundancy"], 1.5);

  const fs::path other = folder / "two_threads";
  ASSERT_EQ(Reconstruct(survey / "images", other, 2).exit_code, 0);
  for (const char* name : {"sparse/0/cameras.bin", "sparse/0/images.bin", "sparse/0/points3D.bin",
                           "dense/0/fused.ply", "dense/0/fused.ply.vis", "map/0/orthomosaic.tif",
                           "map/0/dem.tif", "map/0/source.tif", "map/0/hillshade.png"}) {
    EXPECT_TRUE(ReadBytes(workspace / name) == ReadBytes(other / name)) << name;
  }
}

// Hybrid resolution (paper 4): the exact model of pictures reduced to 0.4, one side rounded, and
// the full pictures, against the full model.
TEST(DemoSurvey, DenseInFullFromAModelOfReducedPictures) {
  const TemporaryFolder folder;
  const fs::path survey = folder / "survey";
  ASSERT_EQ(RunProgram(DEMO_SURVEY,
                       {"generate", "--output_path", survey.string(), "--num_strips", "1",
                        "--images_per_strip", "4", "--width", "680", "--height", "512"},
                       WithinMinutes(3))
                .exit_code,
            0);
  SparseModel model = ReadSparseModel(survey / "truth/sparse");
  const Eigen::Vector2d scale(272.0 / 680, 205.0 / 512);
  Camera& camera = model.cameras.at(1);
  ASSERT_EQ(camera.model, CameraModel::kOpenCV);
  camera.width = 272;
  camera.height = 205;
  for (size_t i = 0; i < 4; ++i) camera.params[i] *= scale[static_cast<int>(i % 2)];
  for (PosedImage& image : model.images) {
    for (Eigen::Vector2d& point : image.points2D) point = point.cwiseProduct(scale);
  }
  WriteSparseModelText(folder / "reduced", model);

  std::map<std::string, nlohmann::json> scores;
  for (const fs::path& input : {survey / "truth/sparse", folder / "reduced"}) {
    const fs::path dense = folder / ("dense of " + input.filename().string());
    const CliResult run =
        RunProgram(SEAPOINT_PROGRAM,
                   {"partial_densifier", "--image_path", (survey / "images").string(),
                    "--input_path", input.string(), "--output_path", dense.string()},
                   WithinMinutes(2));
    ASSERT_EQ(run.exit_code, 0) << run.Text();
    const fs::path json = folder / "score.json";
    const CliResult scored =
        RunProgram(DEMO_SURVEY,
                   {"score", "--survey_path", survey.string(), "--input_path",
                    (survey / "truth/sparse").string(), "--truth_poses", "1", "--cloud_path",
                    (dense / "fused.ply").string(), "--output_path", json.string()},
                   WithinMinutes(2));
    ASSERT_EQ(scored.exit_code, 0) << scored.Text();
    scores[input.filename().string()] = nlohmann::json::parse(std::ifstream(json));
  }
  for (const char* share :
       {"share_within_1gsd", "share_within_2gsd", "share_within_4gsd", "coverage_4gsd"}) {
    EXPECT_NEAR(scores["reduced"][share].get<double>(), scores["sparse"][share].get<double>(),
                0.002)
        << share;
  }
  EXPECT_GT(scores["reduced"]["share_within_2gsd"], 0.95);
}

}  // namespace
}  // namespace colmap_seapoint
