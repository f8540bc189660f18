#include "colmap_seapoint/report/scale_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// Two positions, the second an outlier, and a bar; every number another.
class ScaleReportTest : public testing::Test {
 protected:
  ScaleReportTest() {
    measurements_.position_names = {"a.jpg", "b, \"c\".jpg"};
    measurements_.problem.positions.resize(2);
    measurements_.problem.lengths = {{0.5, 0.01, 1.25, 0.001}};
    measurements_.length_names = {"A - B"};
    measurements_.targets = {{"A", "", 5, 4, 0.75}, {"B", "is marked in 1 pictures", 1, 0, 0}};
    measurements_.units.is_metric = true;
    measurements_.units.frame = "local";
    estimate_.metric_from_model.scale = 2.5;
    estimate_.metric_from_model.translation = {1, 2, 3};
    estimate_.scale_sigma = 0.005;
    estimate_.rotation_sigma_deg = 0.375;
    estimate_.has_frame = true;
    estimate_.position_residuals = {{0.03, -0.04, 0}, {3, 0, -4}};
    estimate_.position_used = {true, false};
    estimate_.position_sigmas = {{0.1, 0.1, 0.2}, {0.1, 0.1, 0.2}};
    estimate_.position_rms = 0.05;
    estimate_.length_residuals = {-0.0125};
    estimate_.length_used = {true};
    estimate_.length_sigmas = {0.002};
    estimate_.length_rms = 0.0125;
    estimate_.warnings = {"mind the gap"};
  }

  TempDir dir_;
  ScaleMeasurements measurements_;
  SimilarityEstimate estimate_;
};

TEST_F(ScaleReportTest, OneLine) {
  EXPECT_EQ(
      ScaleLine(measurements_, estimate_),
      "scale 2.5 +- 0.005; positions 1 of 2, rms 0.050 m (not b, \"c\".jpg: 5 m off); lengths 1 "
      "of 1, rms 0.0125 m");
  estimate_.has_frame = false;
  estimate_.length_used.clear();
  EXPECT_EQ(ScaleLine(measurements_, estimate_), "scale 2.5 +- 0.005");
}

TEST_F(ScaleReportTest, TextForAPerson) {
  EXPECT_EQ(ScaleText(measurements_, estimate_),
            "scale: 2.5 +- 0.005 metres a model unit (0.200 %)\n"
            "frame: " +
                UnitsText(measurements_.units) +
                "\n"
                "rotation: +- 0.38 degrees about its least certain axis\n"
                "positions: 1 of 2 used, rms 0.0500 m\n"
                "  a.jpg  +0.030 -0.040 +0.000 m (0.050)\n"
                "  b, \"c\".jpg  +3.000 +0.000 -4.000 m (5.000)  outlier, not used\n"
                "lengths: 1 of 1 used, rms 0.0125 m\n"
                "  A - B  1.2500 m, residual -0.0125 m (-1.00 %)\n"
                "target A: 4 of 5 marks, rms 0.75 pixels\n"
                "target B: is marked in 1 pictures\n");
  estimate_.is_levelled = true;
  EXPECT_NE(ScaleText(measurements_, estimate_).find("levelled: "), std::string::npos);
}

TEST_F(ScaleReportTest, OfManyPositionsTheLargestResiduals) {
  measurements_.position_names.clear();
  estimate_.position_residuals.clear();
  for (int i = 0; i < 25; ++i) {
    measurements_.position_names.push_back("img" + std::to_string(i));
    estimate_.position_residuals.push_back({0.01 * i, 0, 0});
  }
  estimate_.position_used.assign(25, true);
  const std::string text = ScaleText(measurements_, estimate_);
  EXPECT_NE(text.find("  (the 20 largest residuals)\n  img24  +0.240"), std::string::npos) << text;
  EXPECT_NE(text.find("  img5  +0.050"), std::string::npos) << text;
  EXPECT_EQ(text.find("  img4  "), std::string::npos) << text;
}

TEST_F(ScaleReportTest, Json) {
  WriteScaleJson(dir_ / "scale.json", measurements_, estimate_);
  const auto json = nlohmann::json::parse(ReadBytes(dir_ / "scale.json"));
  EXPECT_EQ(json["scale"], 2.5);
  EXPECT_EQ(json["new_from_old"]["rotation_wxyz"], nlohmann::json({1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(json["new_from_old"]["translation"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(json["warnings"][0], "mind the gap");
  EXPECT_EQ(json["positions"][1]["image"], "b, \"c\".jpg");
  EXPECT_EQ(json["positions"][1]["used"], false);
  EXPECT_EQ(json["positions"][0]["residual_m"], nlohmann::json({0.03, -0.04, 0.0}));
  EXPECT_EQ(json["lengths"][0]["model_length"], 0.5);
  EXPECT_EQ(json["lengths"][0]["sigma_m"], 0.002);
  EXPECT_EQ(json["targets"][0]["rms_pixels"], 0.75);
  EXPECT_EQ(json["targets"][1]["problem"], "is marked in 1 pictures");
}

TEST_F(ScaleReportTest, Csv) {
  WriteScaleCsv(dir_ / "scale.csv", measurements_, estimate_);
  EXPECT_EQ(ReadBytes(dir_ / "scale.csv"),
            "kind,name,used,dx_m,dy_m,dz_m,residual_m,sigma_m,model_length,length_m\n"
            "position,a.jpg,1,0.030000,-0.040000,0.000000,0.050000,0.200000,,\n"
            "position,\"b, \"\"c\"\".jpg\",0,3.000000,0.000000,-4.000000,5.000000,0.200000,,\n"
            "length,A - B,1,,,,-0.012500,0.002000,0.5,1.250000\n");
}

}  // namespace
}  // namespace colmap_seapoint
