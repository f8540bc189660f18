#include "colmap_seapoint/pipeline/densify_models.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Models WS/sparse/<k> of three pictures each, of one strip.
class DensifyModelsTest : public StripSurvey {
 protected:
  Workspace Space() const { return Workspace(Images().string(), (folder_ / "ws").string()); }

  // `sizes`: pictures of each model; one alone gives no point.
  std::vector<ModelSummary> WriteModels(const std::vector<int>& sizes) const {
    std::vector<ModelSummary> models;
    for (const int size : sizes) {
      ModelSummary model;
      model.name = std::to_string(models.size());
      model.path = Space().sparse / model.name;
      const std::string prefix = "model" + model.name + "_";
      WriteStrip(Images(), size, prefix);
      WriteSparseModelBinary(model.path, StripModel(size, prefix));
      models.push_back(model);
    }
    return models;
  }

  RunReport Densify(std::vector<ModelSummary>* models, const AutomaticReconstructorOptions& options,
                    const std::string& mapper_fingerprint = "mapper") const {
    WorkspaceState state(Space().root);
    ColmapDatabase database = OpenDatabase();  // knows none of the pictures
    RunReport report;
    DensifyModels(options, Space(), mapper_fingerprint, &database, &state, models, &report);
    return report;
  }
  RunReport Densify(std::vector<ModelSummary>* models) const {
    return Densify(models, ReconstructorOptions());
  }

  // What is covered is known where the last pass is to fill what is not.
  AutomaticReconstructorOptions Completed() const {
    AutomaticReconstructorOptions options = ReconstructorOptions();
    options.densification.completion = true;
    return options;
  }

  // Makes a table older than it is; true as long as it was not made anew.
  void Mark(const std::string& model) const {
    fs::last_write_time(Space().dense / model / "pairs.csv", fs::file_time_type());
  }
  bool IsMarked(const std::string& model) const {
    return fs::last_write_time(Space().dense / model / "pairs.csv") == fs::file_time_type();
  }
};

TEST_F(DensifyModelsTest, EveryModelBecomesACloudOfItsOwn) {
  std::vector<ModelSummary> models = WriteModels({3, 3});
  const RunReport report = Densify(&models);
  int64_t num_points = 0, num_pairs = 0;
  for (const ModelSummary& model : models) {
    EXPECT_EQ(model.cloud_path, Space().dense / model.name / "fused.ply");
    EXPECT_EQ(static_cast<int64_t>(ReadCloud(model.cloud_path).size()), model.densification.points);
    EXPECT_EQ(model.densification.images_in, 3);
    num_points += model.densification.points;
    num_pairs += model.densification.pairs;
  }
  EXPECT_GT(num_points, 3000);
  EXPECT_EQ(report.points, num_points);
  EXPECT_EQ(report.pairs, num_pairs);
  EXPECT_TRUE(report.left_out.empty());
  ASSERT_EQ(report.stages.size(), 2u);
  EXPECT_EQ(report.stages[0].name, "partial_densifier 0");
  EXPECT_EQ(report.stages[1].name, "partial_densifier 1");
}

TEST_F(DensifyModelsTest, IsDoneOnce) {
  std::vector<ModelSummary> models = WriteModels({3, 3});
  const RunReport first = Densify(&models);
  Mark("0");
  models = WriteModels({3, 3});
  RunReport second;
  const std::string log = LogOf([&] { second = Densify(&models); });
  EXPECT_NE(log.find("The cloud in " + (Space().dense / "0").string() + " is there already"),
            std::string::npos)
      << log;
  EXPECT_TRUE(IsMarked("0"));
  EXPECT_EQ(second.points, first.points);
  EXPECT_EQ(second.pairs, first.pairs);
  ASSERT_EQ(second.stages.size(), 2u);
  EXPECT_EQ(second.stages[0].name, "partial_densifier 0");
  EXPECT_EQ(second.stages[0].wall_seconds, first.stages[0].wall_seconds);
  EXPECT_EQ(models[1].densification.images_in, 3);
}

TEST_F(DensifyModelsTest, PicturesThatComeInAddToTheCloudThatIsThere) {
  std::vector<ModelSummary> models = WriteModels({4});
  const RunReport first = Densify(&models, Completed());
  const std::string cloud = ReadBytes(models[0].cloud_path);
  const std::string rows = ReadBytes(Space().dense / "0" / "pairs.csv");
  models = WriteModels({7});
  RunReport second;
  const std::string log = LogOf([&] { second = Densify(&models, Completed(), "more pictures"); });
  EXPECT_NE(log.find("The cloud of 4 pictures stays as it is; 3 add theirs"), std::string::npos)
      << log;
  const auto body = [](const std::string& ply) { return ply.substr(ply.find("end_header\n")); };
  const std::string more = ReadBytes(models[0].cloud_path);
  EXPECT_EQ(body(more).compare(0, body(cloud).size(), body(cloud)), 0);
  EXPECT_GT(body(more).size(), body(cloud).size());
  EXPECT_EQ(ReadBytes(Space().dense / "0" / "pairs.csv").compare(0, rows.size(), rows), 0);
  EXPECT_GT(second.pairs, first.pairs);
  EXPECT_EQ(second.points, static_cast<int64_t>(ReadCloud(models[0].cloud_path).size()));
  // As much as from scratch, near enough: nothing twice, nothing lost.
  fs::remove_all(Space().root / "state");
  models = WriteModels({7});
  const RunReport whole = Densify(&models, Completed());
  EXPECT_NEAR(static_cast<double>(second.points), static_cast<double>(whole.points),
              0.05 * static_cast<double>(whole.points));
}

TEST_F(DensifyModelsTest, ACloudOfPosesThatMovedIsMadeAnew) {
  std::vector<ModelSummary> models = WriteModels({4});
  Densify(&models, Completed());
  models = WriteModels({7});
  SparseModel moved = ReadSparseModel(models[0].path);
  moved.images[1].cam_from_world.translation.x() += 1e-9;
  WriteSparseModelBinary(models[0].path, moved);
  const std::string log = LogOf([&] { Densify(&models, Completed(), "more pictures"); });
  EXPECT_EQ(log.find("stays as it is"), std::string::npos) << log;
}

TEST_F(DensifyModelsTest, IsDoneAgainWhenSomethingChanges) {
  std::vector<ModelSummary> models = WriteModels({3});
  AutomaticReconstructorOptions options = ReconstructorOptions();
  const auto expect_again = [&](const std::string& mapper_fingerprint, const std::string& what) {
    Densify(&models, options, mapper_fingerprint);
    EXPECT_FALSE(IsMarked("0")) << what;
    Mark("0");
    Densify(&models, options, mapper_fingerprint);
    EXPECT_TRUE(IsMarked("0")) << what;
  };
  expect_again("mapper", "nothing was there");
  expect_again("another mapper", "models");
  options.densification.step = 8;
  expect_again("another mapper", "options");
  models[0].scaling_fingerprint = "scaled";
  expect_again("another mapper", "units");
  options.rig = "none";
  expect_again("another mapper", "rig");
  // What makes no difference to a cloud.
  Mark("0");
  options.run.num_threads = 1;
  options.run.random_seed = 5;
  options.quality = "field";
  Densify(&models, options, "another mapper");
  EXPECT_TRUE(IsMarked("0"));
}

TEST_F(DensifyModelsTest, IsDoneAgainWhenAnOutputIsGone) {
  std::vector<ModelSummary> models = WriteModels({3});
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.densification.write_maps = true;
  Densify(&models, options);
  for (const char* output : {"fused.ply", "fused.ply.vis", "pairs.csv", "stereo/fusion.cfg"}) {
    fs::remove(Space().dense / "0" / output);
    Densify(&models, options);
    EXPECT_TRUE(fs::exists(Space().dense / "0" / output)) << output;
  }
}

TEST_F(DensifyModelsTest, AModelWithoutAPointIsLeftOut) {
  std::vector<ModelSummary> models = WriteModels({3, 1});
  for (int i = 0; i < 2; ++i) {  // the second time from the records
    const RunReport report = Densify(&models);
    ASSERT_EQ(NamesOf(report.left_out), std::vector<std::string>{"sparse/1"});
    EXPECT_NE(report.left_out[0].reason.find("dense/1/pairs.csv"), std::string::npos);
    EXPECT_GT(report.points, 0);
    EXPECT_EQ(models[1].densification.points, 0);
    EXPECT_TRUE(fs::exists(Space().dense / "1/pairs.csv"));
    EXPECT_FALSE(fs::exists(Space().dense / "1/fused.ply"));
  }
}

TEST_F(DensifyModelsTest, NoPointInAnyModelIsAnError) {
  std::vector<ModelSummary> models = WriteModels({1, 1});
  const std::string error = ErrorOf([&] { Densify(&models); });
  EXPECT_NE(error.find("no pair of any model gave a point"), std::string::npos) << error;
  EXPECT_NE(error.find("dense/0/pairs.csv"), std::string::npos) << error;
}

TEST_F(DensifyModelsTest, UnreadablePicturesOfAModelAreInTheReport) {
  std::vector<ModelSummary> models = WriteModels({3, 3});
  WriteBytes(Images() / "model1_2.png", "");
  EXPECT_EQ(NamesOf(Densify(&models).left_out)[0], "model1_2.png");
}

TEST_F(DensifyModelsTest, CloudsOfModelsThatAreNotFoundAnyMoreGo) {
  std::vector<ModelSummary> models = WriteModels({3, 3});
  Densify(&models);
  Mark("0");
  models.resize(1);
  Densify(&models);
  EXPECT_TRUE(IsMarked("0"));
  EXPECT_FALSE(fs::exists(Space().dense / "1"));
  EXPECT_FALSE(fs::exists(Space().root / "state/dense_1.json"));
}

}  // namespace
}  // namespace colmap_seapoint
