// model_scaler, and the scale options of automatic_reconstructor, as a user runs them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr int kNumPictures = 6;
constexpr double kScale = 0.37;  // metres a model unit

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.12g", value);
  return text;
}

Similarity3d Truth() {
  Similarity3d truth;
  truth.scale = kScale;
  // The strip looks along +z: its down. East-north-up then has z against it.
  truth.rotation = Eigen::AngleAxisd(3.14159265358979323846, Eigen::Vector3d::UnitX());
  truth.translation = {30, 40, -12};
  return truth;
}

class ModelScaler : public testing::Test {
 protected:
  void SetUp() override {
    model_ = StripModel(kNumPictures);
    WriteSparseModelBinary(folder_ / "model", model_);
  }

  CliResult Scale(const std::vector<std::string>& more, const std::string& input = "model") const {
    std::vector<std::string> arguments = {"model_scaler", "--input_path",
                                          (folder_ / input).string(), "--output_path",
                                          (folder_ / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments);
  }

  std::string Write(const std::string& name, const std::string& text) const {
    WriteBytes(folder_ / name, text);
    return (folder_ / name).string();
  }

  // Exact marks of a world point in every picture that it falls into.
  std::string Marks(const std::string& name, const Eigen::Vector3d& xyz) const {
    std::string rows;
    for (const PosedImage& image : model_.images) {
      const Camera& camera = model_.cameras.at(image.camera_id);
      const auto pixel = camera.ImgFromCam(image.cam_from_world * xyz);
      if (!pixel || !camera.InImage(*pixel)) continue;
      rows += name + "," + image.name + "," + Number(pixel->x()) + "," + Number(pixel->y()) + "\n";
    }
    return rows;
  }

  // Two targets on the ground, and the bar between them.
  std::vector<std::string> BarArguments(double metres_a_unit = kScale) const {
    const Eigen::Vector3d middle = model_.images[2].cam_from_world.OriginInSource();
    const Eigen::Vector3d a = middle + Eigen::Vector3d(-0.3, 0.1, kStripRange);
    const Eigen::Vector3d b = middle + Eigen::Vector3d(0.4, -0.2, kStripRange);
    return {"--scale_bars_path",
            Write("bars.csv",
                  "name1,name2,length_m\na,b," + Number(metres_a_unit * (b - a).norm()) + "\n"),
            "--targets_path",
            Write("targets.csv", "target,image,x,y\n" + Marks("a", a) + Marks("b", b))};
  }

  std::string PositionsText() const {
    std::string text = "image,x,y,z\n";
    for (const PosedImage& image : model_.images) {
      const Eigen::Vector3d p = Truth() * image.cam_from_world.OriginInSource();
      text += image.name + "," + Number(p.x()) + "," + Number(p.y()) + "," + Number(p.z()) + "\n";
    }
    return text;
  }

  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadBytes(folder_ / "out" / name));
  }

  void ExpectModel(const Similarity3d& new_from_old, double tolerance) const {
    SparseModel expected = model_;
    TransformModel(new_from_old, &expected);
    const SparseModel found = ReadSparseModel(folder_ / "out");
    ASSERT_EQ(found.images.size(), expected.images.size());
    for (size_t i = 0; i < found.images.size(); ++i) {
      EXPECT_EQ(found.images[i].name, expected.images[i].name);
      EXPECT_EQ(found.images[i].points2D, expected.images[i].points2D);
      EXPECT_LT((found.images[i].cam_from_world.OriginInSource() -
                 expected.images[i].cam_from_world.OriginInSource())
                    .norm(),
                tolerance);
    }
    ASSERT_EQ(found.points3D.size(), expected.points3D.size());
    for (const auto& [id, point] : expected.points3D) {
      EXPECT_LT((found.points3D.at(id).xyz - point.xyz).norm(), tolerance);
      EXPECT_EQ(found.points3D.at(id).track.size(), point.track.size());
    }
  }

  TemporaryFolder folder_;
  SparseModel model_;
};

TEST_F(ModelScaler, ABarBetweenTargetsGivesMetres) {
  const auto before = ReadTree(folder_ / "model");
  const CliResult result = Scale(BarArguments());
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("scale: 0.37"), std::string::npos) << result.Text();
  EXPECT_NE(result.out.find("frame of the mapper"), std::string::npos) << result.Text();
  Similarity3d expected;
  expected.scale = kScale;
  ExpectModel(expected, 1e-8);
  EXPECT_EQ(Json("units.json")["units"], "metres");
  EXPECT_EQ(Json("units.json")["frame"], "model");
  EXPECT_EQ(Json("run.json")["units"], "metres");
  EXPECT_NEAR(Json("scale.json")["scale"].get<double>(), kScale, 1e-8);
  EXPECT_EQ(ReadTree(folder_ / "model"), before);
  EXPECT_FALSE(fs::exists(folder_ / "out/images.txt"));
  // Once more into the same folder; never into a model of somebody else's.
  EXPECT_EQ(Scale(BarArguments()).exit_code, 0);
  fs::remove(folder_ / "out/.colmap_seapoint");
  fs::remove(folder_ / "out/run.json");
  const CliResult refused = Scale(BarArguments());
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.LastErrorLine().find("was not made by"), std::string::npos) << refused.Text();
}

TEST_F(ModelScaler, PointsOfTheModelCanBeABarsEnds) {
  const auto first = model_.points3D.begin(), last = std::prev(model_.points3D.end());
  const double length = (first->second.xyz - last->second.xyz).norm();
  const std::string bars = Write(
      "bars.csv", "name1,name2,length_m\npoint:" + std::to_string(first->first) +
                      ",point:" + std::to_string(last->first) + "," + Number(2 * length) + "\n");
  const CliResult result = Scale({"--scale_bars_path", bars});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NEAR(Json("scale.json")["scale"].get<double>(), 2, 1e-9);
}

TEST_F(ModelScaler, PositionsOnOneLineAreLevelled) {
  // The strip is one straight line. As text, and with a cloud.
  WriteSparseModelText(folder_ / "text", model_);
  {
    CloudWriter writer(folder_ / "fused.ply");
    const uint32_t seen_by[] = {0, 1};
    writer.Add({{1, 0.5f, 2}, {0, 0, -1}, {1, 2, 3}, 0.625f}, seen_by, 2);
    writer.Finish();
  }
  const CliResult result =
      Scale({"--positions_path", Write("nav.csv", PositionsText()), "--cloud_path",
             (folder_ / "fused.ply").string(), "--report_path", (folder_ / "report.csv").string()},
            "text");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("levelled"), std::string::npos) << result.Text();
  ExpectModel(Truth(), 1e-6);
  EXPECT_TRUE(fs::exists(folder_ / "out/images.txt"));
  EXPECT_FALSE(fs::exists(folder_ / "out/images.bin"));
  const auto cloud = ReadCloud(folder_ / "out/fused.ply");
  ASSERT_EQ(cloud.size(), 1u);
  EXPECT_LT((cloud[0].xyz.cast<double>() - Truth() * Eigen::Vector3d(1, 0.5, 2)).norm(), 1e-5);
  EXPECT_EQ(cloud[0].confidence, 0.625f);
  EXPECT_NEAR(cloud[0].normal.z(), 1, 1e-6);
  EXPECT_TRUE(ReadBytes(folder_ / "out/fused.ply.vis") == ReadBytes(folder_ / "fused.ply.vis"));
  const std::string report = ReadBytes(folder_ / "report.csv");
  EXPECT_EQ(std::count(report.begin(), report.end(), '\n'), kNumPictures + 1) << report;
  EXPECT_EQ(Json("units.json")["frame"], "local");
}

TEST_F(ModelScaler, LatitudeAndDepthBecomeEastNorthUp) {
  // 10 km of latitude are 0.09 degrees: the strip, along a meridian.
  std::string text = "image,lat,lon,depth\n";
  for (int i = 0; i < kNumPictures; ++i) {
    text +=
        model_.images[static_cast<size_t>(i)].name + "," + Number(43.1 + 1e-5 * i) + ",5.9,12\n";
  }
  CliResult result = Scale({"--positions_path", Write("nav.csv", text)});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Json("units.json")["frame"], "east-north-up");
  const SparseModel enu = ReadSparseModel(folder_ / "out");
  const Eigen::Vector3d along = enu.images.back().cam_from_world.OriginInSource() -
                                enu.images.front().cam_from_world.OriginInSource();
  EXPECT_NEAR(along.y(), 1.11109 * (kNumPictures - 1), 2e-3);  // north
  EXPECT_NEAR(along.x(), 0, 1e-4);
  EXPECT_NEAR(enu.images[0].cam_from_world.OriginInSource().z(), -12, 1e-4);
  // Cameras look down.
  EXPECT_LT((enu.images[0].cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ()).z(),
            -0.999);
  result = Scale({"--positions_path", Write("nav.csv", text), "--crs", "EPSG:32631"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  const auto units = Json("units.json");
  EXPECT_EQ(units["frame"], "projected");
  EXPECT_EQ(units["crs"], "EPSG:32631");
  EXPECT_NEAR(units["offset"][1].get<double>(), 4774000, 3000);
  const SparseModel projected = ReadSparseModel(folder_ / "out");
  EXPECT_LT(projected.images[0].cam_from_world.OriginInSource().norm(), 200);
  EXPECT_NE(result.out.find("EPSG:32631; add "), std::string::npos) << result.Text();
}

TEST_F(ModelScaler, RigSpacingFromTheFramesOfAModel) {
  // Simultaneous pictures: 1 and 2, 3 and 4, 5 and 6, of two cameras.
  model_.cameras[2] = model_.cameras[1];
  model_.cameras[2].camera_id = 2;
  std::string frames;
  for (int k = 0; k < kNumPictures / 2; ++k) {
    model_.images[static_cast<size_t>(2 * k + 1)].camera_id = 2;
    frames += std::to_string(k + 1) + " 1 1 0 0 0 0 0 0 2 CAMERA 1 " + std::to_string(2 * k + 1) +
              " CAMERA 2 " + std::to_string(2 * k + 2) + "\n";
  }
  WriteSparseModelText(folder_ / "rig", model_);
  Write("rig/frames.txt", frames);
  Write("rig/rigs.txt", "1 2 CAMERA 1 CAMERA 2 1 1 0 0 0 -0.5 0 0\n");
  const double spacing = (model_.images[0].cam_from_world.OriginInSource() -
                          model_.images[1].cam_from_world.OriginInSource())
                             .norm();
  const CliResult result = Scale({"--rig_spacing", Number(2 * spacing)}, "rig");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NEAR(Json("scale.json")["scale"].get<double>(), 2, 1e-9);
  EXPECT_NE(result.out.find("rig (3 frames)"), std::string::npos) << result.Text();
  EXPECT_EQ(ReadBytes(folder_ / "out/rigs.txt"), "1 2 CAMERA 1 CAMERA 2 1 1 0 0 0 -1 0 0\n");
  EXPECT_TRUE(fs::exists(folder_ / "out/frames.txt"));
  // Into the same folder, a model without a rig: the old rig does not stay.
  ASSERT_EQ(Scale(BarArguments()).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out/rigs.txt"));
  const CliResult none = Scale({"--rig_spacing", "0.2"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.LastErrorLine().find("no two pictures that a rig took"), std::string::npos);
}

TEST_F(ModelScaler, WrongUsage) {
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const CliResult result = Scale(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(message), std::string::npos) << result.Text();
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  expect({}, "nothing says how large the model is");
  expect({"--targets_path", "t.csv"}, "needs scale_bars_path");
  expect({"--rig_spacing", "1", "--crs", "EPSG:32631"}, "needs positions_path");
  expect({"--rig_spacing", "1", "--rig", "left,right"}, "needs image_path");
  expect({"--rig_spacing", "-1"}, "rig_spacing");
  const CliResult same = RunProgram(
      SEAPOINT_PROGRAM, {"model_scaler", "--input_path", (folder_ / "model").string(),
                         "--output_path", (folder_ / "model/").string(), "--rig_spacing", "1"});
  EXPECT_EQ(same.exit_code, 2) << same.Text();
  EXPECT_NE(same.LastErrorLine().find("output_path is the input_path"), std::string::npos);
}

TEST_F(ModelScaler, BadTablesAreNamedWithLineAndRemedy) {
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const CliResult result = Scale(arguments);
    EXPECT_EQ(result.exit_code, 1) << result.Text();
    EXPECT_NE(result.LastErrorLine().find(message), std::string::npos) << result.Text();
    EXPECT_FALSE(fs::exists(folder_ / "out/images.bin"));
  };
  const std::string bar = Write("b.csv", "name1,name2,length_m\na,b,1\n");
  expect({"--scale_bars_path", bar}, "b.csv:2: 'a' is no target; give --targets_path");
  expect({"--scale_bars_path", Write("p.csv", "name1,name2,length_m\npoint:999999,point:1,1\n")},
         "p.csv:2: the model has no 3D point 999999");
  expect({"--scale_bars_path", bar, "--targets_path",
          Write("t.csv", "target,image,x,y\na," + model_.images[0].name + ",5000,10\n")},
         "t.csv:2: the mark lies outside");
  expect({"--scale_bars_path", bar, "--targets_path",
          Write("t.csv", "target,image,x,y\na,nowhere.png,5,10\nb,nowhere.png,1,1\n")},
         "no bar has two ends in the model");
  expect({"--positions_path", Write("n.csv", "image,x,y,z\nother.png,1,2,3\n")},
         "none of its pictures is in the model");
  expect({"--positions_path", Write("n.csv", "image,x,y,z\n" + model_.images[0].name + ",1,2,3\n")},
         "1 pictures of the model have a position; 3 are needed");
  expect({"--positions_path", Write("n.csv", PositionsText()), "--crs", "EPSG:4326"},
         "is no projected reference system");
}

TEST_F(ModelScaler, ABarWithoutMarksIsLeftOutByName) {
  std::vector<std::string> arguments = BarArguments();
  Write("bars.csv", ReadBytes(folder_ / "bars.csv") + "a,c,0.5\n");
  Write("targets.csv",
        ReadBytes(folder_ / "targets.csv") + "c," + model_.images[0].name + ",9,9\n");
  const CliResult result = Scale(arguments);
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  ASSERT_EQ(Json("run.json")["left_out"].size(), 1u);
  EXPECT_EQ(Json("run.json")["left_out"][0]["name"], "scale bar a - c");
}

class ScaledReconstruction : public ModelScaler {
 protected:
  CliResult Reconstruct(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--workspace_path",
                                          (folder_ / "ws").string(),
                                          "--colmap_path",
                                          FAKE_COLMAP,
                                          "--PartialDensification.completion",
                                          "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    CliOptions options;
    options.environment["FAKE_COLMAP_MODE"] = mode_;
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }
  nlohmann::json At(const std::string& name) const {
    return nlohmann::json::parse(ReadBytes(folder_ / "ws" / name));
  }
  std::string mode_ = "model";
};

TEST_F(ScaledReconstruction, UnitsAreSaidEverywhere) {
  WriteStrip(folder_ / "images", kNumPictures);
  CliResult result = Reconstruct({});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("units arbitrary"), std::string::npos) << result.Text();
  EXPECT_EQ(At("report/run.json")["units"], "arbitrary");
  EXPECT_EQ(At("dense/0/run.json")["units"], "arbitrary");
  EXPECT_EQ(At("dense/0/units.json")["units"], "arbitrary");
  EXPECT_FALSE(fs::exists(folder_ / "ws/sparse_scaled"));
  const auto unscaled = ReadCloud(folder_ / "ws/dense/0/fused.ply");

  const std::vector<std::string> positions = {"--positions_path",
                                              Write("nav.csv", PositionsText())};
  result = Reconstruct(positions);
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.out.find("metres, local (scale "), std::string::npos) << result.Text();
  EXPECT_EQ(At("report/run.json")["units"], "metres");
  EXPECT_EQ(At("dense/0/units.json")["units"], "metres");
  EXPECT_NE(result.err.find("are there already"), std::string::npos);  // the mapper's models
  const SparseModel scaled = ReadSparseModel(folder_ / "ws/sparse_scaled/0");
  for (const PosedImage& image : scaled.images) {
    for (const PosedImage& exact : model_.images) {
      if (exact.name != image.name) continue;
      const Eigen::Vector3d expected = Truth() * exact.cam_from_world.OriginInSource();
      EXPECT_LT((image.cam_from_world.OriginInSource() - expected).norm(), 0.02);
    }
  }
  const auto cloud = ReadCloud(folder_ / "ws/dense/0/fused.ply");
  EXPECT_NEAR(static_cast<double>(cloud.size()) / static_cast<double>(unscaled.size()), 1, 0.02);
  double height = 0;
  for (const CloudPoint& point : cloud) height += point.xyz.z() / static_cast<double>(cloud.size());
  EXPECT_NEAR(height, -12 - kScale * kStripRange, 0.02);

  // The same again changes nothing; other positions do; without them all is as before.
  const std::string before = ReadBytes(folder_ / "ws/dense/0/fused.ply");
  result = Reconstruct(positions);
  EXPECT_NE(result.err.find("The scaled model"), std::string::npos) << result.Text();
  EXPECT_NE(result.out.find("metres, local (scale "), std::string::npos) << result.Text();
  EXPECT_TRUE(ReadBytes(folder_ / "ws/dense/0/fused.ply") == before);
  ASSERT_EQ(Reconstruct({}).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "ws/sparse_scaled"));
  EXPECT_EQ(ReadCloud(folder_ / "ws/dense/0/fused.ply").size(), unscaled.size());
  EXPECT_EQ(At("dense/0/units.json")["units"], "arbitrary");
}

TEST_F(ScaledReconstruction, TwoModelsAndABarInOneOfThem) {
  WriteStrip(folder_ / "images", kNumPictures);
  mode_ = "two_models";
  // Seen by pictures of the first half only.
  const Eigen::Vector3d left = model_.images[0].cam_from_world.OriginInSource();
  const Eigen::Vector3d a = left + Eigen::Vector3d(-0.1, 0.2, kStripRange);
  const Eigen::Vector3d b = left + Eigen::Vector3d(0, -0.3, kStripRange);
  std::vector<std::string> arguments = {
      "--join_models",
      "0",
      "--scale_bars_path",
      Write("bars.csv",
            "name1,name2,length_m,sigma_m\na,b," + Number(kScale * (b - a).norm()) + ",0.02\n"),
      "--targets_path",
      Write("targets.csv", "target,image,x,y\n" + Marks("a", a) + Marks("b", b))};
  CliResult result = Reconstruct(arguments);
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_EQ(At("report/run.json")["units"], "metres and arbitrary, see summary.txt");
  ASSERT_EQ(At("report/run.json")["left_out"].size(), 1u);
  EXPECT_EQ(At("report/run.json")["left_out"][0]["name"], "scale of sparse/1");
  EXPECT_EQ(At("dense/0/units.json")["units"], "metres");
  EXPECT_EQ(At("dense/1/units.json")["units"], "arbitrary");
  // With positions both are scaled, and the bar is not missed in the second.
  arguments.insert(arguments.end(), {"--positions_path", Write("nav.csv", PositionsText())});
  result = Reconstruct(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(At("report/run.json")["left_out"].size(), 0u);
  EXPECT_EQ(At("report/run.json")["units"], "metres");
  EXPECT_EQ(At("dense/1/units.json")["units"], "metres");
}

TEST_F(ScaledReconstruction, BadTablesAreSeenBeforeTheWork) {
  WriteStrip(folder_ / "images", kNumPictures);
  CliResult result = Reconstruct({"--positions_path", Write("nav.csv", "image,x,y,z\na,1,2\n")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.LastErrorLine().find("nav.csv:2: has 3 fields"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "ws/database.db"));
  EXPECT_EQ(Reconstruct({"--targets_path", "t.csv"}).exit_code, 2);
}

}  // namespace
}  // namespace colmap_seapoint
