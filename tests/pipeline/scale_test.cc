#include "colmap_seapoint/pipeline/scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr double kScale = 0.25;  // metres a model unit

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.12g", value);
  return text;
}

class ScaleModelTest : public StripSurvey {
 protected:
  void SetUp() override {
    model_ = StripModel(5);
    WriteSparseModelBinary(folder_ / "model", model_);
  }

  ModelScalerOptions Options() const {
    ModelScalerOptions options;
    options.input_path = (folder_ / "model").string();
    options.output_path = (folder_ / "out").string();
    return options;
  }
  // With a bar between the first and the last point of the model.
  ModelScalerOptions WithBar(double metres_a_unit = kScale) const {
    const auto first = model_.points3D.begin(), last = std::prev(model_.points3D.end());
    const double length = metres_a_unit * (first->second.xyz - last->second.xyz).norm();
    ModelScalerOptions options = Options();
    options.sources.scale_bars_path = Write(
        "bars.csv", "name1,name2,length_m\npoint:" + std::to_string(first->first) +
                        ",point:" + std::to_string(last->first) + "," + Number(length) + "\n");
    return options;
  }
  // With the places of all pictures, enlarged and moved.
  ModelScalerOptions WithPositions() const {
    std::string text = "image,x,y,z\n";
    for (const PosedImage& image : model_.images) {
      const Eigen::Vector3d p =
          kScale * image.cam_from_world.OriginInSource() + Eigen::Vector3d(10, 20, -5);
      text += image.name + "," + Number(p.x()) + "," + Number(p.y()) + "," + Number(p.z()) + "\n";
    }
    ModelScalerOptions options = Options();
    options.sources.positions_path = Write("positions.csv", text);
    return options;
  }

  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadBytes(folder_ / "out" / name));
  }

  SparseModel model_;
};

TEST_F(ScaleModelTest, ABarGivesMetresInTheModelsFrame) {
  const auto before = ReadTree(folder_ / "model");
  const ScaledModel scaled = ScaleModel(WithBar());
  const SparseModel found = ReadSparseModel(folder_ / "out");
  ASSERT_EQ(found.images.size(), model_.images.size());
  for (size_t i = 0; i < found.images.size(); ++i) {
    EXPECT_LT((found.images[i].cam_from_world.OriginInSource() -
               kScale * model_.images[i].cam_from_world.OriginInSource())
                  .norm(),
              1e-9);
  }
  for (const auto& [id, point] : model_.points3D) {
    EXPECT_LT((found.points3D.at(id).xyz - kScale * point.xyz).norm(), 1e-9) << id;
  }
  EXPECT_EQ(Json("units.json")["units"], "metres");
  EXPECT_EQ(Json("units.json")["frame"], "model");
  EXPECT_NEAR(Json("scale.json")["scale"].get<double>(), kScale, 1e-9);
  EXPECT_EQ(ReadTree(folder_ / "model"), before);
  EXPECT_EQ(scaled.report.command, "model_scaler");
  EXPECT_EQ(scaled.report.units, "metres");
  EXPECT_EQ(scaled.report.images_in, 5);
  EXPECT_EQ(scaled.report.images_used, 5);
  ASSERT_EQ(scaled.report.inputs.size(), 1u);
  EXPECT_EQ(scaled.report.inputs[0].name, (folder_ / "bars.csv").string());
  EXPECT_EQ(Json("run.json")["units"], "metres");
}

TEST_F(ScaleModelTest, SaysItInALineAndInFull) {
  const ScaledModel scaled = ScaleModel(WithBar());
  EXPECT_NE(scaled.text.find("scale: 0.25"), std::string::npos) << scaled.text;
  EXPECT_EQ(scaled.line.find('\n'), std::string::npos) << scaled.line;
  EXPECT_NE(scaled.line.find("0.25"), std::string::npos) << scaled.line;
  const CommandResult result = RunModelScaler(WithBar());
  EXPECT_TRUE(result.is_complete);
  EXPECT_EQ(result.text, scaled.text);
}

TEST_F(ScaleModelTest, PositionsGiveTheirFrame) {
  const ScaledModel scaled = ScaleModel(WithPositions());
  const SparseModel found = ReadSparseModel(folder_ / "out");
  for (size_t i = 0; i < found.images.size(); ++i) {
    const Eigen::Vector3d expected =
        kScale * model_.images[i].cam_from_world.OriginInSource() + Eigen::Vector3d(10, 20, -5);
    EXPECT_LT((found.images[i].cam_from_world.OriginInSource() - expected).norm(), 1e-6);
  }
  EXPECT_EQ(Json("units.json")["frame"], "local");
  EXPECT_EQ(scaled.report.units, "metres");
}

TEST_F(ScaleModelTest, KeepsTheFormAndTakesTheCloudAlong) {
  WriteSparseModelText(folder_ / "text", model_);
  {
    CloudWriter writer(folder_ / "cloud.ply");
    const uint32_t seen_by[] = {0, 1};
    writer.Add({{4, 8, 2}, {0, 0, -1}, {1, 2, 3}}, seen_by, 2);
    writer.Finish();
  }
  ModelScalerOptions options = WithBar();
  options.input_path = (folder_ / "text").string();
  options.cloud_path = (folder_ / "cloud.ply").string();
  options.report_path = (folder_ / "residuals.csv").string();
  ScaleModel(options);
  EXPECT_TRUE(fs::exists(folder_ / "out/images.txt"));
  EXPECT_FALSE(fs::exists(folder_ / "out/images.bin"));
  const auto cloud = ReadCloud(folder_ / "out/cloud.ply");
  ASSERT_EQ(cloud.size(), 1u);
  EXPECT_EQ(cloud[0].xyz, Eigen::Vector3f(1, 2, 0.5f));
  EXPECT_NE(ReadBytes(folder_ / "residuals.csv"), "");
  // Again from the binary model: the text does not stay beside it.
  options.input_path = (folder_ / "model").string();
  ScaleModel(options);
  EXPECT_FALSE(fs::exists(folder_ / "out/images.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out/images.bin"));
}

TEST_F(ScaleModelTest, NeverOverSomebodysModel) {
  WriteSparseModelBinary(folder_ / "out", model_);
  const auto before = ReadTree(folder_ / "out");
  EXPECT_ERROR(ScaleModel(WithBar()), "cameras.bin: was not made by colmap_seapoint");
  EXPECT_EQ(ReadTree(folder_ / "out"), before);
  // Its own it may replace.
  fs::remove_all(folder_ / "out");
  ScaleModel(WithBar());
  ScaleModel(WithBar(2 * kScale));
  EXPECT_NEAR(Json("scale.json")["scale"].get<double>(), 2 * kScale, 1e-9);
}

TEST_F(ScaleModelTest, OptionsThatContradictEachOtherAreUsage) {
  EXPECT_USAGE_ERROR(ScaleModel(Options()), "nothing says how large the model is");
  ModelScalerOptions options = WithBar();
  options.output_path = options.input_path + "/.";
  EXPECT_USAGE_ERROR(RunModelScaler(options), "output_path is the input_path");
  options = WithBar();
  options.cloud_path = (folder_ / "out/cloud.ply").string();
  EXPECT_USAGE_ERROR(ScaleModel(options), "cloud_path lies in output_path");
  options = WithBar();
  options.rig = "left,right";
  EXPECT_USAGE_ERROR(ScaleModel(options), "needs image_path");
  options.rig = "left";
  EXPECT_USAGE_ERROR(ScaleModel(options), "it must be LEFT,RIGHT");
  options = WithBar();
  options.sources.crs = "EPSG:32631";
  EXPECT_USAGE_ERROR(ScaleModel(options), "needs positions_path");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(ScaleModelTest, WhatCannotBeScaledIsAnErrorAndWritesNothing) {
  ModelScalerOptions options = WithPositions();
  Write("positions.csv", "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\n");
  EXPECT_ERROR(ScaleModel(options), "2 pictures of the model have a position; 3 are needed");
  options = WithBar();
  options.sources.scale_bars_path = (folder_ / "absent.csv").string();
  EXPECT_ERROR(ScaleModel(options), "absent.csv");
  options = WithBar();
  options.input_path = (folder_ / "no model").string();
  EXPECT_ERROR(ScaleModel(options), "no model");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(ScaleModelTest, ABarWithoutEndsIsLeftOutByName) {
  ModelScalerOptions options = WithPositions();
  options.sources.scale_bars_path = Write("bars.csv", "name1,name2,length_m\na,b,1\n");
  options.sources.targets_path =
      Write("targets.csv", "target,image,x,y\na,img1.png,9,9\nb,img1.png,50,50\n");
  EXPECT_EQ(NamesOf(ScaleModel(options).report.left_out),
            std::vector<std::string>{"scale bar a - b"});
  EXPECT_FALSE(RunModelScaler(options).is_complete);
}

}  // namespace
}  // namespace colmap_seapoint
