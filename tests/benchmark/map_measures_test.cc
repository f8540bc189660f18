#include "examples/benchmarks/map/map_measures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

// The map that would have no errors, but for heights that are `off` too high; `hole`: a column
// without any; from column `second` on the second picture is the source.
MemoryMap PerfectMap(const SurveyTruth& truth, double off, int hole, int second = 1000) {
  MapGrid grid;
  grid.pixel_size = truth.gsd;
  grid.width = 120;
  grid.height = 100;
  grid.left = -0.5 * grid.width * truth.gsd;
  grid.top = 0.5 * grid.height * truth.gsd;
  MapTile tile;
  tile.relief = FloatImage(grid.width, grid.height, 1, kNoHeight);
  tile.rgba = Image<uint8_t>(grid.width, grid.height, 4, 255);
  tile.source = Image<int32_t>(grid.width, grid.height, 1, 0);
  tile.surface = Image<uint8_t>(grid.width, grid.height, 1, kMeasured);
  for (int i = 0; i < grid.width * grid.height; ++i) {
    const int x = i % grid.width, y = i / grid.width;
    tile.source.At(x, y) = x < second ? 0 : 1;
    if (x == hole) {
      tile.rgba.At(x, y, 3) = 0;
      continue;
    }
    const Eigen::Vector2d place = grid.PlaceOf(x + 0.5, y + 0.5);
    tile.relief.At(x, y) =
        static_cast<float>(truth.surface.Ground().Height(place.x(), place.y()) + off);
  }
  MemoryMap map;
  map.Begin({}, grid);
  map.Take(std::move(tile));
  return map;
}

SurveyTruth SmallTruth() {
  SurveyOptions options;
  options.num_strips = 1;
  options.images_per_strip = 3;
  options.width = 320;
  options.height = 240;
  return MakeSurveyTruth(options);
}

TEST(MapMeasures, ReliefErrorsAreThoseThatWereMade) {
  const SurveyTruth truth = SmallTruth();
  EXPECT_LT(MeasureRelief(truth, PerfectMap(truth, 0, -1)).p95, 0.01);
  const ReliefErrors errors = MeasureRelief(truth, PerfectMap(truth, 2 * truth.gsd, -1));
  EXPECT_NEAR(errors.median, 2, 0.01);
  EXPECT_NEAR(errors.p95, 2, 0.01);
}

TEST(MapMeasures, CoverageMissesTheHole) {
  const SurveyTruth truth = SmallTruth();
  const MemoryMap map = PerfectMap(truth, 0, 60);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 60 * 100; ++i) {  // every 20th is looked at: one in two columns
    const Eigen::Vector2d place = map.Grid().PlaceOf(2 * (i % 60) + 0.5, i / 60 + 0.5);
    const Eigen::Vector3d point(place.x(), place.y(),
                                truth.surface.Ground().Height(place.x(), place.y()));
    points.insert(points.end(), 20, point.cast<float>());
  }
  EXPECT_NEAR(MeasureCoverage(truth, points, map).colored_share, 1 - 1.0 / 60, 1e-9);
}

TEST(MapMeasures, SeamsAreFoundWhereSourcesChange) {
  const SurveyTruth truth = SmallTruth();
  Picture grey;
  grey.luma = GrayImage(320, 240, 1, 128);
  const MapPictureReader read = [&](size_t) { return grey; };
  EXPECT_EQ(MeasureSeams(truth, read, PerfectMap(truth, 0, -1)).num_pairs, 0);
  const SeamSteps steps = MeasureSeams(truth, read, PerfectMap(truth, 0, -1, 70));
  EXPECT_GT(steps.num_pairs, 50);
  EXPECT_EQ(steps.inside, 0);
  EXPECT_EQ(steps.across, 0);
}

}  // namespace
}  // namespace colmap_seapoint
