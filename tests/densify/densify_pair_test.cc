#include "densify/densify_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/densify/pair_scene.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;

Camera TestCamera(CameraModel model = CameraModel::kOpenCV) {
  return MildCamera(model, 420, 480, 360);
}

// Two pictures 0.3 apart (disparity 63 pixels, parallax 8.5 degrees), turned against each other.
PairScene SceneOf(const World& world, CameraModel model = CameraModel::kOpenCV) {
  return PairScene(world, StandAt(TestCamera(model), {-0.15, 0, 0}, {1, -2, 4}),
                   StandAt(TestCamera(model), {0.15, 0.03, 0.01}, {-2, 1, -3}));
}

const PairScene& FlatScene() {
  static const PairScene scene = SceneOf(FlatWorld(kDepth));
  return scene;
}

double MedianNormalErrorDeg(const PartialCloud& cloud, const Eigen::Vector3d& truth) {
  std::vector<double> errors;
  for (const DensePoint& point : cloud.points) {
    const double cosine = point.normal.cast<double>().dot(truth);
    errors.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI);
  }
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2];
}

TEST(DensifyPairTest, Plane) {
  for (const CameraModel model :
       {CameraModel::kOpenCV, CameraModel::kOpenCVFisheye, CameraModel::kPinhole}) {
    const PairScene scene = SceneOf(FlatWorld(kDepth), model);
    const PartialDensificationOptions options;
    const PairResult result = DensifyPair(scene.Input(options), options, 2);
    EXPECT_EQ(result.failure, "");
    const double gsd = scene.Gsd(kDepth);
    const Accuracy accuracy = MeasureAccuracy(scene, result.cloud, gsd);
    EXPECT_GE(accuracy.half_gsd, 0.965);
    EXPECT_GE(accuracy.one_gsd, 0.997);
    EXPECT_GE(accuracy.two_gsd, 0.9995);
    EXPECT_GE(MeasureCoverage(scene, result.cloud, gsd), 0.985);
    EXPECT_LT(MedianNormalErrorDeg(result.cloud, -Eigen::Vector3d::UnitZ()), 5.5);
  }
}

TEST(DensifyPairTest, EveryCameraModel) {
  for (const CameraModel model : RectifiableCameraModels()) {
    SCOPED_TRACE(FindCameraModel(static_cast<int>(model))->name);
    const PairScene scene = SceneOf(SlantedWorld(kDepth, 10), model);
    const PartialDensificationOptions options;
    const PairResult result = DensifyPair(scene.Input(options), options, 2);
    EXPECT_EQ(result.failure, "");
    const double gsd = scene.Gsd(kDepth);
    EXPECT_GE(MeasureAccuracy(scene, result.cloud, gsd).one_gsd, 0.97);
    EXPECT_GE(MeasureCoverage(scene, result.cloud, gsd), 0.97);
  }
}

// However the camera moved: with the epipole in the picture or near it, turned over, three times
// nearer, around what it looks at. What is left uncovered lies around the epipole, where the rays
// meet at less than two degrees; beside it they meet at little more.
TEST(DensifyPairTest, AnyMotion) {
  struct Motion {
    const char* name;
    Eigen::Vector3d center1, turn1, center2, turn2;
    double one_gsd, two_gsd, coverage;
  };
  const Motion motions[] = {
      {"forward", {0, 0, 0}, {0, 0, 0}, {0.02, 0.01, 0.5}, {1, -2, 2}, 0.9, 0.96, 0.89},
      {"backward", {0, 0, 0}, {0, 0, 0}, {0.02, 0.01, -0.5}, {1, -2, 2}, 0.9, 0.98, 0.88},
      {"forward swim", {0, 0, 0}, {40, 0, 0}, {0, 0.3, 0.3}, {38, 2, 3}, 0.95, 0.99, 0.73},
      {"half turned over", {0, 0, 0}, {0, 0, 0}, {0.1, 0.05, 0.4}, {2, 3, 160}, 0.87, 0.95, 0.84},
      {"three times nearer", {0, 0, 0}, {0, 0, 0}, {0.3, 0.1, 1.3}, {3, -10, 5}, 0.93, 0.98, 0.76},
      {"around", {-0.9, 0, 0}, {0, -24, 0}, {0.9, 0.1, 0.05}, {-2, 26, 5}, 0.999, 0.999, 0.99},
  };
  for (const Motion& motion : motions) {
    SCOPED_TRACE(motion.name);
    const PairScene scene(FlatWorld(kDepth), StandAt(TestCamera(), motion.center1, motion.turn1),
                          StandAt(TestCamera(), motion.center2, motion.turn2));
    const PartialDensificationOptions options;
    const PairResult result = DensifyPair(scene.Input(options), options, 2);
    EXPECT_EQ(result.failure, "");
    const double gsd = scene.Gsd(kDepth);
    const Accuracy accuracy = MeasureAccuracy(scene, result.cloud, gsd);
    EXPECT_GE(accuracy.one_gsd, motion.one_gsd);
    EXPECT_GE(accuracy.two_gsd, motion.two_gsd);
    EXPECT_GE(MeasureCoverage(scene, result.cloud, gsd), motion.coverage);
  }
}

TEST(DensifyPairTest, SlantedPlane) {
  for (const double angle_deg : {30.0, -30.0}) {
    const PairScene scene = SceneOf(SlantedWorld(kDepth, angle_deg));
    const PartialDensificationOptions options;
    const PairResult result = DensifyPair(scene.Input(options), options, 2);
    EXPECT_EQ(result.failure, "");
    const double gsd = scene.Gsd(kDepth), angle = angle_deg * M_PI / 180;
    const Accuracy accuracy = MeasureAccuracy(scene, result.cloud, gsd);
    EXPECT_GE(accuracy.half_gsd, 0.975);
    EXPECT_GE(accuracy.one_gsd, 0.997);
    EXPECT_GE(accuracy.two_gsd, 0.999);
    EXPECT_GE(MeasureCoverage(scene, result.cloud, gsd), 0.985);
    EXPECT_LT(MedianNormalErrorDeg(result.cloud, {-std::sin(angle), 0, -std::cos(angle)}), 13);
  }
}

// The pictures that see least of the depth, and those that see a slant, in noise: the confidence is
// the share of points within two ground sampling distances (of their own range).
TEST(DensifyPairTest, ConfidenceIsTheShareOnTheSurface) {
  for (const double half_baseline : {0.05, 0.08, 0.15}) {
    PairScene scene(SlantedWorld(kDepth, 40),
                    StandAt(TestCamera(), {-half_baseline, 0, 0}, {1, -2, 4}),
                    StandAt(TestCamera(), {half_baseline, 0.03, 0.01}, {-2, 1, -3}));
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0, 5);
    const auto add_noise = [&](GrayImage* gray) {
      for (uint8_t& value : gray->data) {
        value = static_cast<uint8_t>(std::clamp(value + std::lround(noise(generator)), 1l, 255l));
      }
    };
    add_noise(&scene.picture1.luma);
    add_noise(&scene.luma2);
    PartialDensificationOptions options;
    options.min_confidence = 0;
    const PartialCloud cloud = DensifyPair(scene.Input(options), options, 2).cloud;
    double predicted = 0, measured = 0;
    for (const DensePoint& point : cloud.points) {
      const Eigen::Vector3d xyz = point.xyz.cast<double>();
      predicted += static_cast<double>(point.confidence);
      measured += scene.world.Distance(xyz) < 2 * scene.Gsd((xyz - scene.view1.Center()).norm());
    }
    const auto count = static_cast<double>(cloud.points.size());
    EXPECT_GT(count, 50000);
    EXPECT_NEAR(predicted / count, measured / count, 0.1) << half_baseline;
  }
}

// Points that lie on neither level nor on the wall, near the step: what a correlation window that
// sees both levels leaves behind.
double FringeShare(const PairScene& scene, const PartialCloud& cloud) {
  const double gsd = scene.Gsd(kDepth);
  int num_near = 0, num_fringe = 0;
  for (const DensePoint& point : cloud.points) {
    if (std::abs(point.xyz.x()) > 20 * gsd) continue;
    ++num_near;
    num_fringe += scene.world.Distance(point.xyz.cast<double>()) > 4 * gsd;
  }
  return static_cast<double>(num_fringe) / num_near;
}

TEST(DensifyPairTest, StepWithOcclusion) {
  for (const int near_sign : {-1, 1}) {
    const PairScene scene = SceneOf(StepWorld(1.7, kDepth, near_sign));
    const PartialDensificationOptions options;
    const PairResult result = DensifyPair(scene.Input(options), options, 2);
    EXPECT_EQ(result.failure, "");
    const double gsd = scene.Gsd(kDepth);
    const Accuracy accuracy = MeasureAccuracy(scene, result.cloud, gsd);
    EXPECT_GE(accuracy.half_gsd, 0.94);
    EXPECT_GE(accuracy.one_gsd, 0.97);
    EXPECT_GE(accuracy.two_gsd, 0.98);
    EXPECT_GE(MeasureCoverage(scene, result.cloud, gsd), 0.98);
    EXPECT_LT(FringeShare(scene, result.cloud), 0.085);
  }
}

TEST(DensifyPairTest, ColorsAreThoseOfTheSurface) {
  const PartialDensificationOptions options;
  const PairResult result = DensifyPair(FlatScene().Input(options), options, 2);
  double sum = 0;
  for (const DensePoint& point : result.cloud.points) {
    const std::array<double, 3> truth = FlatScene().world.ColorAt(point.xyz.cast<double>());
    for (size_t c = 0; c < 3; ++c) sum += std::abs(point.rgb[c] - truth[c]);
  }
  const double mean = sum / 3 / static_cast<double>(result.cloud.points.size());
  EXPECT_LT(mean, 4);
}

// A band across the middle of either picture, and of a further one.
GrayImage BandMask(const Camera& camera) {
  GrayImage mask(camera.width, camera.height, 1, 255);
  for (int y = camera.height / 3; y < camera.height / 2; ++y) {
    std::fill(mask.Row(y), mask.Row(y) + mask.width, uint8_t{0});
  }
  return mask;
}

int NumHidden(const PartialCloud& cloud, const Viewpoint& view, const GrayImage& mask) {
  int num_hidden = 0;
  for (const DensePoint& point : cloud.points) {
    const auto pixel = view.camera.ImgFromCam(view.cam_from_world * point.xyz.cast<double>());
    if (!pixel || !view.camera.InImage(*pixel)) continue;
    const int x = std::min(mask.width - 1, static_cast<int>(pixel->x()));
    const int y = std::min(mask.height - 1, static_cast<int>(pixel->y()));
    num_hidden += mask.At(x, y) == 0;
  }
  return num_hidden;
}

TEST(DensifyPairTest, NoPointWhereEitherPictureIsMasked) {
  for (const int masked : {1, 2, 3}) {  // bit 0: picture 1, bit 1: picture 2
    PairScene scene = SceneOf(FlatWorld(kDepth));
    const GrayImage mask = BandMask(scene.view1.camera);
    const PartialDensificationOptions options;
    const PairResult all = DensifyPair(scene.Input(options), options, 2);
    if (masked & 1) scene.picture1.mask = mask;
    PairInput input = scene.Input(options);
    if (masked & 2) input.mask2 = &mask;
    const PairResult result = DensifyPair(input, options, 2);
    const PairResult alone = DensifyPair(input, options, 1);
    for (const int picture : {1, 2}) {
      const Viewpoint& view = picture == 1 ? scene.view1 : scene.view2;
      EXPECT_GT(NumHidden(all.cloud, view, mask), 10000);
      // A point is a float, and may lie a hair beyond the rim of its pixel: the masks that come
      // from files are a pixel larger (picture_masks.h).
      if (masked & picture) {
        EXPECT_LT(NumHidden(result.cloud, view, mask), 30) << masked;
      }
    }
    // What is not masked is there as before.
    EXPECT_GT(result.cloud.points.size(), 0.6 * static_cast<double>(all.cloud.points.size()));
    EXPECT_GE(MeasureAccuracy(scene, result.cloud, scene.Gsd(kDepth)).two_gsd, 0.999);
    EXPECT_EQ(alone.cloud.points.size(), result.cloud.points.size());
  }
}

TEST(DensifyPairTest, SamplesEveryStepPixels) {
  size_t num_points[5] = {};
  for (const int step : {1, 2, 4}) {
    PartialDensificationOptions options;
    options.step = step;
    const PairResult result = DensifyPair(FlatScene().Input(options), options, 2);
    num_points[step] = result.cloud.points.size();
    const Accuracy accuracy = MeasureAccuracy(FlatScene(), result.cloud, FlatScene().Gsd(kDepth));
    EXPECT_GE(accuracy.one_gsd, 0.9) << step;
    EXPECT_NEAR(static_cast<double>(num_points[1]) / static_cast<double>(num_points[step]),
                step * step, 0.2 * step * step);
  }
}

TEST(DensifyPairTest, SameBytesWithAnyNumberOfThreads) {
  const PairScene scene = SceneOf(StepWorld(1.7, kDepth, 1));
  const PartialDensificationOptions options;
  const PairInput input = scene.Input(options);
  const PairResult one = DensifyPair(input, options, 1);
  for (const int num_threads : {2, 5}) {
    const PairResult many = DensifyPair(input, options, num_threads);
    ASSERT_EQ(many.cloud.points.size(), one.cloud.points.size());
    for (size_t i = 0; i < one.cloud.points.size(); ++i) {
      const DensePoint &a = one.cloud.points[i], &b = many.cloud.points[i];
      ASSERT_TRUE(a.xyz == b.xyz && a.normal == b.normal && a.rgb == b.rgb &&
                  a.confidence == b.confidence)
          << i;
    }
    EXPECT_EQ(many.filled, one.filled);
    EXPECT_EQ(many.num_failed_seeds, one.num_failed_seeds);
    ASSERT_EQ(many.footprint.patches.size(), one.footprint.patches.size());
  }
}

TEST(DensifyPairTest, FilledAndFootprintTellWhatIsThere) {
  const PartialDensificationOptions options;
  const PairInput input = FlatScene().Input(options);
  const PairResult result = DensifyPair(input, options, 2);
  ASSERT_EQ(result.filled.size(), input.known.grid.Size());
  const double samples_per_cell =
      input.known.grid.cell * input.known.grid.cell;  // a sample a pixel
  double num_expected = 0;
  for (const float share : result.filled) {
    EXPECT_TRUE(share >= 0 && share <= 1);
    num_expected += share * samples_per_cell;
  }
  // Rectified pixels are not exactly as dense as those of a lens with distortion.
  EXPECT_NEAR(num_expected / static_cast<double>(result.cloud.points.size()), 1, 0.15);
  EXPECT_GT(result.footprint.patches.size(), 0.7 * static_cast<double>(input.known.grid.Size()));
  const double gsd = FlatScene().Gsd(kDepth);
  for (const SurfacePatch& patch : result.footprint.patches) {
    EXPECT_NEAR(patch.center.z(), kDepth, 2 * gsd);
    EXPECT_NEAR(patch.size, input.known.grid.cell * gsd, 0.35 * input.known.grid.cell * gsd);
    EXPECT_LE((patch.center - result.footprint.center).norm(), result.footprint.radius);
  }
  EXPECT_EQ(result.num_seeds, 300);
  EXPECT_LT(result.num_failed_seeds, 25);
}

// Points of the cloud in each cell of picture 1; those within a node of a cell's edge apart, since
// what is open and what is not is told apart by nodes.
std::vector<int> PointsOfCells(const PairScene& scene, const PairInput& input,
                               const PartialCloud& cloud) {
  std::vector<int> count(input.known.grid.Size(), 0);
  for (const DensePoint& point : cloud.points) {
    const auto pixel =
        scene.view1.camera.ImgFromCam(scene.view1.cam_from_world * point.xyz.cast<double>());
    const double x = std::fmod(pixel->x(), input.known.grid.cell);
    const double y = std::fmod(pixel->y(), input.known.grid.cell);
    const double edge = std::min(std::min(x, y), input.known.grid.cell - std::max(x, y));
    if (edge > kMinNodeStep) ++count[input.known.grid.IndexOf(pixel->x(), pixel->y())];
  }
  return count;
}

double RangeAt(const PairScene& scene, const Eigen::Vector2d& pixel) {
  return (*SurfaceAt(scene.world, scene.view1, pixel) - scene.view1.Center()).norm();
}

TEST(DensifyPairTest, ClosedCellsStayEmptyAndTheOthersDoNot) {
  const PartialDensificationOptions options;
  PairInput input = FlatScene().Input(options);
  input.known.grid = CellGrid(480, 360, 20);
  const std::vector<int> before =
      PointsOfCells(FlatScene(), input, DensifyPair(input, options, 2).cloud);
  input.known.closed.assign(input.known.grid.Size(), 0);
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    const Eigen::Vector2d center = input.known.grid.Center(cell);
    input.known.closed[cell] = center.x() < 240 || (center.x() > 330 && center.y() < 100);
  }
  const PairResult result = DensifyPair(input, options, 2);
  EXPECT_LT(result.num_seeds, 200);
  const std::vector<int> after = PointsOfCells(FlatScene(), input, result.cloud);
  int num_open_before = 0, num_open_after = 0;
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    if (input.known.closed[cell]) {
      EXPECT_EQ(after[cell], 0);
    } else {
      num_open_before += before[cell];
      num_open_after += after[cell];
    }
  }
  EXPECT_GT(num_open_after, 0.97 * num_open_before);
}

TEST(DensifyPairTest, CoveredCellsAtTheirDepthStayEmpty) {
  const PartialDensificationOptions options;
  PairInput input = FlatScene().Input(options);
  input.known.grid = CellGrid(480, 360, 20);
  input.known.covered_range.assign(input.known.grid.Size(), 0);
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    const Eigen::Vector2d center = input.known.grid.Center(cell);
    if (center.x() < 240) {
      input.known.covered_range[cell] = static_cast<float>(RangeAt(FlatScene(), center));
    }
  }
  const std::vector<int> count =
      PointsOfCells(FlatScene(), input, DensifyPair(input, options, 2).cloud);
  int num_open = 0;
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    if (input.known.covered_range[cell] > 0) {
      EXPECT_EQ(count[cell], 0);
    } else {
      num_open += count[cell];
    }
  }
  EXPECT_GT(num_open, 25000);
}

// A plane that was reconstructed before, and a table top above it that was not there, or was not
// seen: at `table_x`. Returns the share of the table's pixels, seen twice, that have points.
double TableCoverage(double table_x, const PartialDensificationOptions& options) {
  const NoiseTexture texture(42, 0.16, 4);
  const Rectangle ground = {{0, 0, kDepth}, {50, 0, 0}, {0, 50, 0}};
  const Rectangle table = {{table_x, 0, 1.5}, {0.15, 0, 0}, {0, 0.15, 0}};
  const PairScene scene = SceneOf(World({ground, table}, texture));
  PairInput input = scene.Input(options, 600);
  input.known.covered_range.assign(input.known.grid.Size(), 0);
  for (size_t cell = 0; cell < input.known.grid.Size(); ++cell) {
    const Eigen::Vector2d center = input.known.grid.Center(cell);
    if (center.x() > 300) continue;
    const auto on_ground = SurfaceAt(World({ground}, texture), scene.view1, center);
    input.known.covered_range[cell] =
        static_cast<float>((*on_ground - scene.view1.Center()).norm());
  }
  const PairResult result = DensifyPair(input, options, 2);
  int64_t num_on_table = 0;
  for (const DensePoint& point : result.cloud.points) {
    if (std::abs(point.xyz.z() - 1.5) > 3 * scene.Gsd(1.5)) continue;
    num_on_table += std::abs(point.xyz.x() - table_x) < 0.15 && std::abs(point.xyz.y()) < 0.15;
  }
  return static_cast<double>(num_on_table) * std::pow(scene.Gsd(1.5) / 0.3, 2);
}

TEST(DensifyPairTest, NewObjectInFrontOfACoveredPlaceIsReconstructed) {
  const PartialDensificationOptions options;
  const double beside = TableCoverage(0.05, options), far = TableCoverage(-0.4, options);
  EXPECT_GT(beside, 0.75);
  EXPECT_GT(far, 0.75);
}

// A table before a background that the pictures see at little parallax (4.3 and 2.1 degrees) or, at
// 30 times the range, at hardly any. Whatever is matched across the table's edge must not float far
// from either, nor may the background scatter along its rays.
TEST(DensifyPairTest, FarBackgroundLeavesNoFloaters) {
  struct Limit {
    double min_confidence, worst;  // own ground sampling distances; 98 where everything is written
  };
  for (const double far_depth : {4.0, 8.0, 30 * kDepth}) {
    const Rectangle table = {{0, 0, kDepth}, {0.5, 0, 0}, {0, 0.4, 0}};
    const Rectangle background = {{0, 0, far_depth}, {500, 0, 0}, {0, 500, 0}};
    const PairScene scene = SceneOf(World({table, background}, NoiseTexture(42, 0.16, 4)));
    PartialDensificationOptions options;
    for (const Limit& limit : {Limit{0.6, 60}, Limit{0.9, 20}}) {
      options.min_confidence = limit.min_confidence;
      size_t num_on_table = 0;
      for (const DensePoint& point :
           DensifyPair(scene.Input(options, 600), options, 2).cloud.points) {
        const Eigen::Vector3d xyz = point.xyz.cast<double>();
        const double range = (xyz - scene.view1.Center()).norm(), gsd = scene.Gsd(range);
        num_on_table += std::abs(xyz.z() - kDepth) < 2 * gsd;
        EXPECT_LT(scene.world.Distance(xyz), limit.worst * gsd);
        EXPECT_TRUE(far_depth < 10 || range < 1.5 * kDepth) << range;
        EXPECT_GE(point.confidence, static_cast<float>(limit.min_confidence));
      }
      EXPECT_GT(num_on_table, 31500u);
    }
  }
}

TEST(DensifyPairTest, WrongSeedsAreNotUsed) {
  const PartialDensificationOptions options;
  PairInput input = FlatScene().Input(options, 100);
  for (PixelPair& seed : input.seeds) seed.pixel2.y() += 5;  // off the epipolar line
  EXPECT_EQ(DensifyPair(input, options, 1).failure, "too few seeds in areas that are new");
  input = FlatScene().Input(options, 100);
  for (PixelPair& seed : input.seeds) seed.pixel2.x() += 25;  // on it, but wrong: no correlation
  const PairResult wrong = DensifyPair(input, options, 1);
  EXPECT_GT(wrong.num_seeds, 80);
  EXPECT_GT(wrong.num_failed_seeds, 0.8 * wrong.num_seeds);
  EXPECT_LT(wrong.cloud.points.size(), 8000u);  // of 160 000: chance correlations
  input = FlatScene().Input(options, 100);
  for (PixelPair& seed : input.seeds) std::swap(seed.pixel1, seed.pixel2);  // behind the cameras
  EXPECT_NE(DensifyPair(input, options, 1).failure, "");
}

TEST(DensifyPairTest, NothingToDoIsAStatus) {
  const PartialDensificationOptions options;
  PairInput input = FlatScene().Input(options);
  input.known.closed.assign(input.known.grid.Size(), 1);
  EXPECT_EQ(DensifyPair(input, options, 1).failure, "too few seeds in areas that are new");
  input = FlatScene().Input(options);
  input.view2 = input.view1;
  EXPECT_EQ(DensifyPair(input, options, 1).failure, "the cameras coincide");
  input = FlatScene().Input(options);
  input.seeds.clear();
  EXPECT_NE(DensifyPair(input, options, 1).failure, "");
}

// Paper 2.6: growth ends at the limit.
TEST(DensifyPairTest, ExpansionIsLimited) {
  PartialDensificationOptions options;
  PairInput input = FlatScene().Input(options, 6);
  options.max_expansion = 20.0 / 480;
  for (const DensePoint& point : DensifyPair(input, options, 2).cloud.points) {
    const auto pixel = FlatScene().view1.camera.ImgFromCam(FlatScene().view1.cam_from_world *
                                                           point.xyz.cast<double>());
    double nearest = 1e9;
    for (const PixelPair& seed : input.seeds) {
      nearest = std::min(nearest, (seed.pixel1 - *pixel).lpNorm<1>());
    }
    EXPECT_LT(nearest, 30);  // rectification turns the picture: 20 steps along other axes
  }
}

TEST(DensifyPairTest, StepAndCells) {
  PartialDensificationOptions options;
  EXPECT_EQ(SampleStep(MakeCamera(CameraModel::kPinhole, 900, 480, 360), options.step), 1);
  EXPECT_EQ(SampleStep(MakeCamera(CameraModel::kPinhole, 900, 4000, 3000), options.step), 4);
  options.step = 3;
  const Camera camera = MakeCamera(CameraModel::kPinhole, 900, 100, 50);
  EXPECT_EQ(SampleStep(camera, options.step), 3);
  const CellGrid cells = CellsOf(camera, options.step);
  EXPECT_EQ(cells.cell, 12);
  EXPECT_EQ(cells.width, 9);
  EXPECT_EQ(cells.height, 5);
  EXPECT_EQ(cells.IndexOf(0, 0), 0u);
  EXPECT_EQ(cells.IndexOf(99.9, 49.9), 44u);
  EXPECT_EQ(cells.IndexOf(1000, -5), 8u);
  EXPECT_EQ(cells.Center(10), Eigen::Vector2d(18, 18));
}

}  // namespace
}  // namespace colmap_seapoint
