#include "examples/benchmarks/densify/measure_densify.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {
namespace {

// A small survey on disk, made once: one strip of six pictures, 80 % forward overlap.
class MeasureDensifyTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = std::filesystem::temp_directory_path() /
           ("measure_densify_test_" + std::to_string(getpid()));
    SurveyOptions options;
    options.width = 480;
    options.height = 360;
    options.num_strips = 1;
    options.images_per_strip = 6;
    options.forward_overlap = 0.8;
    options.turbidity = 0;
    options.num_threads = 2;
    const SurveyTruth truth = MakeSurveyTruth(options);
    WriteSurveyTruth(dir_, options, truth);
    std::filesystem::create_directories(dir_ / "images");
    RenderSurvey(options, truth, [](const PosedImage& image, ColorImage&& picture) {
      WriteImage(dir_ / "images" / image.name, picture);
    });
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(dir_); }

  static DensifySet Set() {
    DensifySet set;
    set.name = "small";
    set.survey_path = dir_;
    return set;
  }

  static std::filesystem::path dir_;
};

std::filesystem::path MeasureDensifyTest::dir_;

TEST_F(MeasureDensifyTest, PartialIsMeasuredAgainstComplete) {
  DensifyMeasureOptions options;
  options.set = Set();
  options.variants = {"complete", "sequential"};
  options.num_threads = 2;
  options.debug_path = dir_ / "debug";
  const std::vector<DensifyRow> rows = MeasureDensify(options);
  ASSERT_EQ(rows.size(), 2u);
  const DensifyRow& complete = rows[0];
  const DensifyRow& partial = rows[1];
  for (const DensifyRow& row : rows) {
    EXPECT_EQ(row.set, "small");
    EXPECT_EQ(row.pictures, 6);
    EXPECT_DOUBLE_EQ(row.megapixels, 6 * 480 * 360 * 1e-6);
    EXPECT_GT(row.cpu, 0);
    EXPECT_GT(row.seapoint_cpu, 0);
    EXPECT_GT(row.match_cpu, 0);
    EXPECT_GE(row.pairs, 2);
    EXPECT_EQ(row.completion_pairs, 0);
    EXPECT_GT(row.coverage_4gsd, 0.6);
    EXPECT_GT(row.within_4gsd, 0.95);
    EXPECT_GT(row.true_new_later, 0.2);
    EXPECT_LT(row.true_new_later, 0.8);
    EXPECT_LT(row.true_new_later, row.true_new_share);  // the first pair is all new
  }
  EXPECT_LT(partial.points, 0.9 * complete.points);
  EXPECT_LT(partial.layers, complete.layers);
  EXPECT_EQ(partial.same_pairs, 1);
  EXPECT_GT(partial.kept_cover, 0.9);
  EXPECT_LT(partial.seeds_kept, 0.9);
  EXPECT_GT(partial.seeds_kept, 0.1);
  EXPECT_TRUE(std::isnan(complete.kept_cover));
  for (const char* name : {"complete.ply", "sequential_pairs.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(options.debug_path / name)) << name;
  }
}

TEST_F(MeasureDensifyTest, HeldOutPointsAreInTheCloud) {
  HoldOutOptions options;
  options.set = Set();
  options.num_threads = 2;
  const HoldOutRow row = MeasureHoldOut(options);
  EXPECT_EQ(row.held, std::floor(row.points / 5));
  EXPECT_GT(row.eligible, 0.5 * row.held);
  EXPECT_GT(row.passed, 0.9);
  EXPECT_LT(row.median_gsd, 1.5);
}

TEST_F(MeasureDensifyTest, MissingPicturesAndModelsAreNamed) {
  DensifyMeasureOptions options;
  options.set = Set();
  options.variants = {"complete"};
  options.set.image_path = dir_ / "truth";
  EXPECT_THROW(MeasureDensify(options), Error);
  options.set = Set();
  options.set.input_path = dir_ / "images";
  EXPECT_THROW(MeasureDensify(options), Error);
}

}  // namespace
}  // namespace colmap_seapoint
