#include "colmap_seapoint/orthomosaic/orthomosaic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/orthomosaic/ground/no_map.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "tests/orthomosaic/map_world.h"

namespace colmap_seapoint {
namespace {

double NoGain(size_t) { return 1; }
// Neighbours differ by a factor of two.
double EveryOtherDark(size_t i) { return i % 2 == 0 ? 0.9 : 0.45; }

class OrthomosaicTest : public testing::Test {
 protected:
  OrthomosaicSummary Make(const OrthomosaicInputs& inputs, OrthomosaicOptions options = {}) {
    options.num_threads = num_threads_;
    return MakeOrthomosaic(options, inputs, &map_);
  }
  OrthomosaicSummary Make(const MapWorld& world, OrthomosaicOptions options = {}) {
    return Make(world.Inputs(dir_.Path()), options);
  }

  // The upper surface below a place of the map, pixels; the world's z is away from the cameras.
  Eigen::Vector3d TruthAt(const MapWorld& world, double column, double row) const {
    const Rigid3d world_from_map = map_.Frame().map_from_cloud.Inverse();
    const Eigen::Vector2d place = map_.Grid().PlaceOf(column, row);
    return *world.world.Cast(world_from_map * Eigen::Vector3d(place.x(), place.y(), 10),
                             world_from_map.rotation * -Eigen::Vector3d::UnitZ());
  }

  bool HasColor(int x, int y) const { return map_.Whole().rgba.At(x, y, 3) != 0; }

  std::string ErrorOf(const OrthomosaicInputs& inputs, const OrthomosaicOptions& options = {}) {
    try {
      Make(inputs, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TempDir dir_;
  MapInMemory map_;
  int num_threads_ = 2;
};

// By how much the map would have to be moved there, in pixels: one step of least squares on the
// brightness of a patch. The table's edge is left out by whoever calls.
double ShiftAt(const ColorImage& map, const FloatImage& truth, int x, int y) {
  constexpr int kHalf = 10;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int v = y - kHalf; v <= y + kHalf; ++v) {
    for (int u = x - kHalf; u <= x + kHalf; ++u) {
      const Eigen::Vector3d row(0.5 * double{truth.At(u + 1, v) - truth.At(u - 1, v)},
                                0.5 * double{truth.At(u, v + 1) - truth.At(u, v - 1)}, 1);
      normal += row * row.transpose();
      right += row * (map.At(u, v) - double{truth.At(u, v)});
    }
  }
  return (normal.ldlt().solve(right)).head<2>().norm();
}

TEST_F(OrthomosaicTest, IsTrueInPlanAndHeightAndMakesNothingUp) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  const OrthomosaicSummary summary = Make(world);
  EXPECT_NEAR(summary.gsd, world.gsd, 0.1 * world.gsd);
  EXPECT_EQ(summary.cell_size, 1);
  EXPECT_EQ(summary.pictures_used.size(), 6u);
  EXPECT_EQ(summary.num_picture_reads, 6u);
  EXPECT_EQ(map_.num_begins, 1);
  FloatImage truth(map_.Grid().width, map_.Grid().height);
  ColorImage red(map_.Grid().width, map_.Grid().height, 1);
  std::vector<double> height_errors;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = 0; x < truth.width; ++x) {
      const Eigen::Vector3d place = TruthAt(world, x + 0.5, y + 0.5);
      truth.At(x, y) = static_cast<float>(world.world.ColorAt(place)[0]);
      red.At(x, y) = map_.Whole().rgba.At(x, y, 0);
      EXPECT_EQ(HasColor(x, y), map_.Whole().source.At(x, y) != kNoSource);
      EXPECT_EQ(map_.Whole().surface.At(x, y) != 0, !std::isnan(map_.Whole().relief.At(x, y)));
      // The cloud ends there: nothing may go on.
      if (place.x() > 0.9 + 2 * world.gsd) {
        EXPECT_EQ(map_.Whole().surface.At(x, y), 0);
      }
      if (map_.Whole().surface.At(x, y) == 0) continue;
      const double height = (map_.Frame().map_from_cloud * place).z();
      height_errors.push_back(std::abs(height - double{map_.Whole().relief.At(x, y)}) / world.gsd);
    }
  }
  std::sort(height_errors.begin(), height_errors.end());
  ASSERT_GT(height_errors.size(), 20000u);
  EXPECT_LT(height_errors[height_errors.size() / 2], 0.05);
  EXPECT_LT(height_errors[height_errors.size() * 97 / 100], 0.4);
  std::vector<double> shifts;
  for (int y = 30; y + 30 < truth.height; y += 12) {
    for (int x = 30; x + 30 < truth.width; x += 12) {
      bool is_whole = true;  // one surface, all of it coloured
      const double depth = TruthAt(world, x, y).z();
      for (int i = 0; i < 9; ++i) {
        const int u = x + 12 * (i % 3 - 1), v = y + 12 * (i / 3 - 1);
        is_whole &= HasColor(u, v) && TruthAt(world, u, v).z() == depth;
      }
      if (is_whole) shifts.push_back(ShiftAt(red, truth, x, y));
    }
  }
  std::sort(shifts.begin(), shifts.end());
  ASSERT_GT(shifts.size(), 100u);
  EXPECT_LT(shifts[shifts.size() * 95 / 100], 0.3);
}

TEST_F(OrthomosaicTest, ColoursWhatTheCloudCoversAndFlagsTheTable) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  const OrthomosaicSummary summary = Make(world);
  uint64_t num_points = 0, num_colored = 0, num_overhang = 0, num_table = 0;
  for (const CloudPoint& point : ReadCloud(world.cloud_path)) {
    const Eigen::Vector3d in_map = map_.Frame().map_from_cloud * point.xyz.cast<double>();
    const Eigen::Vector2d pixel = map_.Grid().PixelOf(in_map.x(), in_map.y());
    if ((TruthAt(world, pixel.x(), pixel.y()) - point.xyz.cast<double>()).norm() > 1e-3) continue;
    ++num_points;
    num_colored += HasColor(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  }
  EXPECT_GE(static_cast<double>(num_colored), 0.99 * static_cast<double>(num_points));
  for (int y = 0; y < map_.Grid().height; ++y) {
    for (int x = 0; x < map_.Grid().width; ++x) {
      const bool is_flagged = (map_.Whole().surface.At(x, y) & kOverhang) != 0;
      const Eigen::Vector3d place = TruthAt(world, x + 0.5, y + 0.5);
      const bool is_table = place.z() < 1.8;
      const double beside = std::max(std::abs(place.x()) - 0.2, std::abs(place.y()) - 0.15);
      num_overhang += is_flagged && is_table;
      num_table += is_table;
      if (beside > 1.5 * world.gsd) {
        EXPECT_FALSE(is_flagged) << x << " " << y;
      }
    }
  }
  // Cameras look below the table's edges only.
  EXPECT_GT(num_overhang, num_table / 10);
  EXPECT_LE(summary.num_overhang_pixels, num_table + 100);
}

// Nowhere may the table's underside, or the ground, be painted twice: what a picture shows beside
// the table's edge is hidden for it where the map shows the ground.
TEST_F(OrthomosaicTest, TheTableCastsNoGhost) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  OrthomosaicOptions options;
  options.balance = false;
  Make(world, options);
  int num_wrong = 0, num_near = 0;
  for (int y = 0; y < map_.Grid().height; ++y) {
    for (int x = 0; x < map_.Grid().width; ++x) {
      const Eigen::Vector3d place = TruthAt(world, x + 0.5, y + 0.5);
      const double beside = std::max(std::abs(place.x()) - 0.2, std::abs(place.y()) - 0.15);
      if (!HasColor(x, y) || beside < 0.016 || beside > 0.15) continue;
      ++num_near;
      num_wrong += std::abs(map_.Whole().rgba.At(x, y, 0) - world.world.ColorAt(place)[0]) > 40;
    }
  }
  ASSERT_GT(num_near, 2000);
  EXPECT_LT(num_wrong, num_near / 50);
}

TEST_F(OrthomosaicTest, SeamsAreNoStepsWhereExposureChanges) {
  const MapWorld world = MakeMapWorld(dir_.Path(), EveryOtherDark);
  const auto steps = [&] {  // at seams, over what the world's own are there
    double across = 0, inside = 0;
    int count = 0;
    for (int y = 0; y < map_.Grid().height; ++y) {
      for (int x = 1; x + 1 < map_.Grid().width; ++x) {
        const int32_t left = map_.Whole().source.At(x - 1, y),
                      right = map_.Whole().source.At(x + 1, y);
        if (left < 0 || right < 0 || left == right) continue;
        const Eigen::Vector3d a = TruthAt(world, x - 0.5, y + 0.5);
        const Eigen::Vector3d b = TruthAt(world, x + 1.5, y + 0.5);
        if (a.z() != b.z()) continue;  // the table's edge
        across += std::abs(map_.Whole().rgba.At(x + 1, y, 1) - map_.Whole().rgba.At(x - 1, y, 1));
        inside += std::abs(world.world.ColorAt(a)[1] - world.world.ColorAt(b)[1]);
        ++count;
      }
    }
    EXPECT_GT(count, 200);
    return across / inside;
  };
  OrthomosaicOptions options;
  Make(world, options);
  EXPECT_LT(steps(), 1.3);
  options.balance = false;
  Make(world, options);
  EXPECT_GT(steps(), 2);  // or the test could not fail
}

TEST_F(OrthomosaicTest, AnyNumberOfThreadsGivesTheSameBytes) {
  const MapWorld world = MakeMapWorld(dir_.Path(), EveryOtherDark);
  OrthomosaicOptions options;
  options.pixel_size = 0.0018;  // several tiles
  options.picture_bytes = 1;    // nothing is kept
  num_threads_ = 1;
  Make(world, options);
  const MapTile one = map_.Whole();
  EXPECT_GT(map_.Grid().NumTiles(), 2);
  for (const int num_threads : {2, 5}) {
    num_threads_ = num_threads;
    Make(world, options);
    EXPECT_EQ(map_.Whole().rgba.data, one.rgba.data);
    EXPECT_EQ(map_.Whole().source.data, one.source.data);
    EXPECT_EQ(map_.Whole().surface.data, one.surface.data);
    EXPECT_EQ(std::memcmp(map_.Whole().relief.data.data(), one.relief.data.data(),
                          one.relief.data.size() * sizeof(float)),
              0);
  }
}

TEST_F(OrthomosaicTest, TilesDoNotShow) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  OrthomosaicOptions options;
  options.balance = false;
  options.pixel_size = 0.0018;
  Make(world, options);
  double at_border = 0, elsewhere = 0;
  int num_at_border = 0, num_elsewhere = 0;
  for (int y = 0; y < map_.Grid().height; ++y) {
    for (int x = 1; x < map_.Grid().width; ++x) {
      if (!HasColor(x, y) || !HasColor(x - 1, y)) continue;
      const int step = std::abs(map_.Whole().rgba.At(x, y, 0) - map_.Whole().rgba.At(x - 1, y, 0));
      (x % map_.Grid().tile_size == 0 ? at_border : elsewhere) += step;
      ++(x % map_.Grid().tile_size == 0 ? num_at_border : num_elsewhere);
    }
  }
  ASSERT_GT(num_at_border, 100);
  EXPECT_LT(at_border / num_at_border, 1.4 * elsewhere / num_elsewhere);
}

TEST_F(OrthomosaicTest, MasksAndUnreadablePicturesGiveNoColour) {
  MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  world.pictures[1] = Picture();                        // unreadable
  world.pictures[2].luma = GrayImage(200, 70, 1, 128);  // another shape
  world.pictures[4].mask = GrayImage(200, 150, 1, 255);
  for (int y = 0; y < 60; ++y) std::fill_n(world.pictures[4].mask.Row(y), 200, uint8_t{0});
  const OrthomosaicSummary summary = Make(world);
  EXPECT_EQ(summary.pictures_unread, (std::vector<size_t>{1, 2}));
  EXPECT_EQ(summary.pictures_used, (std::vector<size_t>{0, 3, 4, 5}));
  EXPECT_LT(summary.num_colored_pixels, summary.num_surface_pixels);
  const std::vector<Viewpoint> viewpoints = world.Viewpoints();
  int num_of_masked = 0;
  for (int y = 0; y < map_.Grid().height; ++y) {
    for (int x = 0; x < map_.Grid().width; ++x) {
      EXPECT_EQ(HasColor(x, y), map_.Whole().surface.At(x, y) != 0 &&
                                    (map_.Whole().surface.At(x, y) & kUncolored) == 0);
      if (map_.Whole().source.At(x, y) != 4) continue;
      const auto pixel = PixelOf(world.world, viewpoints[4], TruthAt(world, x + 0.5, y + 0.5));
      if (!pixel) continue;
      ++num_of_masked;
      EXPECT_GT(pixel->y(), 58);
    }
  }
  EXPECT_GT(num_of_masked, 500);
}

TEST_F(OrthomosaicTest, PicturesOfOtherResolutionsFit) {
  MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  for (Picture& picture : world.pictures) picture = HalvedPicture(picture);
  Make(world);
  double error = 0;
  int count = 0;
  for (int y = 0; y < map_.Grid().height; y += 3) {
    for (int x = 0; x < map_.Grid().width; x += 3) {
      const Eigen::Vector3d place = TruthAt(world, x + 0.5, y + 0.5);
      if (!HasColor(x, y) || place.head<2>().norm() < 0.5) continue;
      error += std::abs(map_.Whole().rgba.At(x, y, 0) - world.world.ColorAt(place)[0]);
      ++count;
    }
  }
  EXPECT_LT(error / count, 12);
}

TEST_F(OrthomosaicTest, ACoarseMapMeansThePixels) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  OrthomosaicOptions options;
  options.pixel_size = 0.032;  // four times the GSD
  const OrthomosaicSummary summary = Make(world, options);
  EXPECT_EQ(summary.grid.pixel_size, 0.032);
  EXPECT_GT(summary.num_colored_pixels, 1000u);
}

TEST_F(OrthomosaicTest, OddInputsEndInOneLine) {
  MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  const OrthomosaicInputs inputs = world.Inputs(dir_.Path());
  OrthomosaicOptions options;
  options.pixel_size = 1e-6;
  EXPECT_NE(ErrorOf(inputs, options).find("give a pixel size of"), std::string::npos);
  OrthomosaicInputs elsewhere = inputs;
  elsewhere.temporary_folder = dir_.Path() / "not there";
  EXPECT_NE(ErrorOf(elsewhere).find("not there"), std::string::npos);

  CloudWriter far(dir_.Path() / "far.ply");
  for (int i = 0; i < 1000; ++i) {
    CloudPoint point;
    point.xyz = {1000.0f + 0.01f * static_cast<float>(i % 30), 0.01f * static_cast<float>(i / 30),
                 2};
    far.Add(point, nullptr, 0);
  }
  far.Finish();
  OrthomosaicInputs apart = inputs;
  apart.cloud_path = dir_.Path() / "far.ply";
  EXPECT_NE(ErrorOf(apart).find("different frames"), std::string::npos);

  CloudWriter none(dir_.Path() / "none.ply");
  none.Finish();
  OrthomosaicInputs empty = inputs;
  empty.cloud_path = dir_.Path() / "none.ply";
  EXPECT_NE(ErrorOf(empty).find("holds no points"), std::string::npos);
  empty.cloud_path = dir_.Path() / "missing.ply";
  EXPECT_NE(ErrorOf(empty), "");

  const SparseModel no_model;
  const OrthomosaicInputs bare = {no_model, world.cloud_path, std::nullopt, world.Reader(),
                                  dir_.Path()};
  EXPECT_NE(ErrorOf(bare), "");
}

TEST_F(OrthomosaicTest, AFullDiskReachesTheCaller) {
  struct FullSink : MapTileSink {
    void Begin(const MapFrame&, const MapGrid&) override {}
    void Take(MapTile&&) override { throw Error("map.tif", "no space left", "free some"); }
  };
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  FullSink sink;
  EXPECT_THROW(MakeOrthomosaic({}, world.Inputs(dir_.Path()), &sink), Error);
}

TEST_F(OrthomosaicTest, PosesThatAreNoNumbersGiveNoColour) {
  MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  world.model.images[0].cam_from_world.translation.x() = std::numeric_limits<double>::quiet_NaN();
  world.model.images[5].cam_from_world.translation.z() = std::numeric_limits<double>::infinity();
  const OrthomosaicSummary summary = Make(world);
  EXPECT_EQ(summary.pictures_used, (std::vector<size_t>{1, 2, 3, 4}));
}

// Every other camera is farther away. What the water adds and takes depends on the range alone.
struct TestWater {
  Light attenuation = {0.5f, 0.2f, 0.1f}, veil = {0.05f, 0.12f, 0.2f};

  ColorImage Through(const World& world, const Viewpoint& viewpoint) const {
    ColorImage picture = TakePicture(world, viewpoint);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const auto place = SurfaceAt(world, viewpoint, {x + 0.5, y + 0.5});
        const auto range = static_cast<float>((*place - viewpoint.Center()).norm());
        for (int c = 0; c < 3; ++c) {
          const auto k = static_cast<size_t>(c);
          const float left = std::exp(-attenuation[k] * range);
          uint8_t& value = picture.At(x, y, c);
          value = ScreenOf(left * LightOf(value) + (1 - left) * veil[k]);
        }
      }
    }
    return picture;
  }
};

MapWorld WorldUnderWater(const std::filesystem::path& folder, const TestWater& water) {
  MapWorld world = MakeMapWorld(folder, NoGain);
  for (size_t i = 0; i < world.pictures.size(); ++i) {
    PosedImage& image = world.model.images[i];
    if (i % 2 == 1) image.cam_from_world.translation.z() += 0.8;
    const Viewpoint viewpoint = {world.model.cameras[1], image.cam_from_world};
    world.pictures[i] = PictureOf(water.Through(world.world, viewpoint));
  }
  return world;
}

TEST_F(OrthomosaicTest, TheWaterIsTakenOut) {
  const TestWater water;
  const MapWorld world = WorldUnderWater(dir_.Path(), water);
  // By what factor the map is brighter than the surface, as a logarithm: how far its values lie
  // from their mean. The mean itself is the white balance's.
  const auto spread = [&] {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      std::vector<double> logs;
      for (int y = 0; y < map_.Grid().height; y += 3) {
        for (int x = 0; x < map_.Grid().width; x += 3) {
          if (!HasColor(x, y)) continue;
          const auto truth = world.world.ColorAt(TruthAt(world, x + 0.5, y + 0.5));
          const auto value = static_cast<float>(truth[static_cast<size_t>(c)]);
          const auto shown = static_cast<float>(map_.Whole().rgba.At(x, y, c));
          if (value < 60 || shown < 5 || shown > 250) continue;
          logs.push_back(std::log(double{LightOf(shown)}) - std::log(double{LightOf(value)}));
        }
      }
      EXPECT_GT(logs.size(), 500u);
      double mean = 0;
      for (const double log : logs) mean += log / static_cast<double>(logs.size());
      for (const double log : logs) sum += std::abs(log - mean) / static_cast<double>(logs.size());
    }
    return sum / 3;
  };
  const OrthomosaicSummary raw = Make(world);
  EXPECT_FALSE(raw.water.has_value());
  const double raw_spread = spread();
  OrthomosaicOptions options;
  options.restore = true;
  const OrthomosaicSummary restored = Make(world, options);
  ASSERT_TRUE(restored.water.has_value());
  ASSERT_TRUE(restored.water->IsDetermined()) << WaterText(*restored.water);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(restored.water->attenuation[c], double{water.attenuation[static_cast<size_t>(c)]},
                0.08);
  }
  EXPECT_LT(spread(), 0.5 * raw_spread);
}

// Whoever asks for colours without the water where nothing tells of it gets them as they are.
TEST_F(OrthomosaicTest, WaterThatIsNotKnownChangesNothing) {
  MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  for (size_t i = 1; i < world.pictures.size(); ++i) world.pictures[i] = Picture();
  Make(world);
  const MapTile raw = map_.Whole();
  OrthomosaicOptions options;
  options.restore = true;
  const OrthomosaicSummary summary = Make(world, options);
  EXPECT_FALSE(summary.water->IsDetermined());
  EXPECT_EQ(map_.Whole().rgba.data, raw.rgba.data);
}

TEST_F(OrthomosaicTest, ProgressRunsFromNothingToAll) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  OrthomosaicInputs inputs = world.Inputs(dir_.Path());
  std::vector<double> shares = {0};
  inputs.progress = [&](double share) {
    EXPECT_GE(share, shares.back());
    shares.push_back(share);
  };
  Make(inputs);
  EXPECT_GT(shares.size(), 7u);
  EXPECT_NEAR(shares.back(), 1, 1e-12);
}

TEST_F(OrthomosaicTest, NoSurfaceIsAMapLessAndNoFault) {
  const MapWorld world = MakeMapWorld(dir_.Path(), NoGain);
  CloudWriter sparse(dir_.Path() / "sparse.ply");
  for (int i = 0; i < 6; ++i) {
    CloudPoint point;
    point.xyz = {0.4f * static_cast<float>(i % 3 - 1), 0.4f * static_cast<float>(i / 3), 2};
    sparse.Add(point, nullptr, 0);
  }
  sparse.Finish();
  OrthomosaicInputs inputs = world.Inputs(dir_.Path());
  inputs.cloud_path = dir_.Path() / "sparse.ply";
  EXPECT_THROW(Make(inputs), NoMap);
}

}  // namespace
}  // namespace colmap_seapoint
