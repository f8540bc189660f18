#include "colmap_seapoint/compare/compare_clouds.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <random>

#include "tests/compare/brute_force.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// A bumpy, tilted surface of 2 x 1, with some points far off; `offset` moves all of it.
PointVector Surface(int count, unsigned seed, double noise, const Eigen::Vector3d& offset) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
  PointVector points;
  for (int i = 0; i < count; ++i) {
    const double x = 2 * unit(random), y = unit(random);
    const double z = 0.1 * std::sin(9 * x) + noise * normal(random) + (i % 100 == 7 ? 0.6 : 0);
    points.push_back(turn * Eigen::Vector3d(x, y, z) + offset);
  }
  return points;
}

PointVector AsFloats(PointVector points) {
  for (auto& xyz : points) xyz = xyz.cast<float>().cast<double>();
  return points;
}

class CompareCloudsTest : public testing::Test {
 protected:
  void Write(const PointVector& input, const PointVector& reference) {
    WriteDoublePly(dir_ / "a.ply", input);
    WriteDoublePly(dir_ / "b.ply", reference);
  }

  CloudComparison Compare(const CompareOptions& options, const char* input = "a.ply",
                          const char* reference = "b.ply") {
    CompareCallbacks callbacks;
    callbacks.progress = [](const std::string&, int64_t, int64_t) {};
    callbacks.begin = [this](const CompareSetup& setup) { setup_ = setup; };
    differences_.clear();
    callbacks.difference = [this](bool of_input, const PointVector& points,
                                  const std::vector<double>& squared) {
      ASSERT_EQ(points.size(), squared.size());
      for (size_t i = 0; i < points.size(); ++i) {
        const auto& p = points[i];
        differences_.push_back({of_input ? 1.0 : 0.0, p.x(), p.y(), p.z(), squared[i]});
      }
    };
    return CompareClouds(dir_ / input, dir_ / reference, dir_.Path(), options, callbacks);
  }

  TempDir dir_;
  CompareSetup setup_;
  std::vector<std::array<double, 5>> differences_;
};

void ExpectSameWay(const OneWay& a, const OneWay& b) {
  EXPECT_EQ(a.num_points, b.num_points);
  EXPECT_EQ(a.num_beyond, b.num_beyond);
  EXPECT_EQ(a.num_voxels, b.num_voxels);
  EXPECT_EQ(a.num_cells, b.num_cells);
  EXPECT_EQ(a.num_area_cells, b.num_area_cells);
  EXPECT_EQ(a.median, b.median);
  EXPECT_NEAR(a.mean, b.mean, 1e-12);
  EXPECT_NEAR(a.rms, b.rms, 1e-12);
  EXPECT_NEAR(a.area, b.area, 1e-12);
  ASSERT_EQ(a.at.size(), b.at.size());
  for (size_t k = 0; k < a.at.size(); ++k) {
    EXPECT_EQ(a.at[k].num_within, b.at[k].num_within) << k;
    EXPECT_EQ(a.at[k].num_reduced, b.at[k].num_reduced) << k;
    EXPECT_EQ(a.at[k].num_reduced_within, b.at[k].num_reduced_within) << k;
    EXPECT_NEAR(a.at[k].voxel_share, b.at[k].voxel_share, 1e-12) << k;
    EXPECT_NEAR(a.at[k].far_area, b.at[k].far_area, 1e-10) << k;
  }
}

TEST_F(CompareCloudsTest, IsWhatEveryPairOfPointsSays) {
  for (const Eigen::Vector3d& offset :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(500000, 5000000, -30)}) {
    const PointVector a = Surface(1500, 1, 0.01, offset), b = Surface(1100, 2, 0.02, offset);
    Write(a, b);
    // From one tile to tiles that are smaller than the distances.
    for (const double tile_points : {1e9, 300.0, 40.0}) {
      CompareOptions options;
      options.distances = {0.02, 0.05, 0.2};
      options.max_distance = 0.25;
      options.voxel_size = 0.07;
      options.cell_size = 0.031;
      options.area_cell_size = 0.11;
      options.tile_points = tile_points;
      const CloudComparison found = Compare(options);
      const CloudComparison oracle = CompareByBruteForce(a, b, found, setup_.view);
      ExpectSameWay(found.input, oracle.input);
      ExpectSameWay(found.reference, oracle.reference);
      EXPECT_GT(oracle.input.num_beyond, 0u);
      EXPECT_LT(oracle.input.at[0].num_within, oracle.input.at[1].num_within);
    }
  }
}

TEST_F(CompareCloudsTest, SpacingAndDefaultsAreThoseOfTheReference) {
  PointVector a = Surface(700, 3, 0.01, {0, 0, 0}), b = Surface(500, 4, 0.01, {0, 0, 0});
  for (int i = 0; i < 100; ++i) b.push_back(b[static_cast<size_t>(i)]);  // no places of their own
  Write(a, b);
  const CloudComparison found = Compare({});
  EXPECT_EQ(found.input.spacing, SpacingByBruteForce(a));
  EXPECT_EQ(found.reference.spacing, SpacingByBruteForce(b));
  const double spacing = found.reference.spacing;
  EXPECT_EQ(found.distances, (std::vector<double>{spacing, 2 * spacing, 4 * spacing}));
  EXPECT_TRUE(found.distances_from_spacing);
  EXPECT_EQ(found.max_distance, 40 * spacing);
  EXPECT_EQ(found.voxel_size, spacing);
  EXPECT_EQ(found.cell_size, spacing);
  EXPECT_EQ(found.area_cell_size, 4 * std::max(spacing, found.input.spacing));
}

TEST_F(CompareCloudsTest, SpacingOfSmallTilesIsTheSame) {
  const PointVector a = Surface(700, 3, 0.01, {0, 0, 0});
  Write(a, a);
  CompareOptions options;
  options.tile_points = 140;  // 16 tiles: all of them are taken
  const CloudComparison found = Compare(options);
  EXPECT_EQ(found.input.num_in_spacing, a.size());
  EXPECT_EQ(found.input.spacing, SpacingByBruteForce(a));
}

TEST_F(CompareCloudsTest, ACloudAgainstItselfIsPerfect) {
  const PointVector a = Surface(2000, 1, 0.01, {3, 2, 1});
  Write(a, a);
  CompareOptions options;
  options.tile_points = 100;
  const CloudComparison found = Compare(options);
  for (const OneWay* way : {&found.input, &found.reference}) {
    EXPECT_EQ(way->mean, 0);
    EXPECT_EQ(way->median, 0);
    EXPECT_EQ(way->rms, 0);
    EXPECT_EQ(way->num_beyond, 0u);
    for (const DistanceShares& at : way->at) {
      EXPECT_EQ(at.num_within, a.size());
      EXPECT_EQ(at.voxel_share, 1);
      EXPECT_EQ(at.num_reduced_within, at.num_reduced);
      EXPECT_EQ(at.far_area, 0);
    }
  }
}

void ExpectIdentical(const OneWay& a, const OneWay& b) {
  ExpectSameWay(a, b);
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.rms, b.rms);
  for (size_t k = 0; k < a.at.size(); ++k) {
    EXPECT_EQ(a.at[k].voxel_share, b.at[k].voxel_share);
    EXPECT_EQ(a.at[k].far_area, b.at[k].far_area);
  }
}

TEST_F(CompareCloudsTest, ExchangingTheCloudsExchangesTheFiguresToTheBit) {
  Write(Surface(2000, 1, 0.01, {0, 0, 0}), Surface(900, 2, 0.03, {0, 0, 0}));
  CompareOptions options;
  options.distances = {0.03, 0.06};
  options.cell_size = 0.02;
  options.tile_points = 150;
  const CloudComparison there = Compare(options);
  const CloudComparison back = Compare(options, "b.ply", "a.ply");
  ExpectIdentical(there.input, back.reference);
  ExpectIdentical(there.reference, back.input);
  EXPECT_NE(there.input.mean, there.reference.mean);
}

TEST_F(CompareCloudsTest, ThreadsChangeNothing) {
  Write(Surface(3000, 1, 0.01, {0, 0, 0}), Surface(2500, 2, 0.03, {0, 0, 0}));
  CompareOptions options;
  options.distances = {0.01, 0.05};
  options.tile_points = 150;
  options.num_threads = 1;
  const CloudComparison one = Compare(options);
  const auto differences = differences_;
  for (const int num_threads : {2, 5}) {
    options.num_threads = num_threads;
    const CloudComparison many = Compare(options);
    ExpectIdentical(one.input, many.input);
    ExpectIdentical(one.reference, many.reference);
    EXPECT_EQ(differences, differences_);
  }
}

TEST_F(CompareCloudsTest, FloatsAreKeptAsTheyAre) {
  const PointVector a = AsFloats(Surface(800, 1, 0.01, {100, 0, 0}));
  const PointVector b = AsFloats(Surface(800, 2, 0.01, {100, 0, 0}));
  WriteFloatPly(dir_ / "a.ply", a);
  WriteFloatPly(dir_ / "b.ply", b);
  CompareOptions options;
  options.distances = {0.03};
  options.tile_points = 200;
  const CloudComparison found = Compare(options);
  EXPECT_TRUE(setup_.input_fits_float);
  const CloudComparison oracle = CompareByBruteForce(a, b, found, setup_.view);
  ExpectSameWay(found.input, oracle.input);
  ExpectSameWay(found.reference, oracle.reference);
}

TEST_F(CompareCloudsTest, EveryPointHasItsDistance) {
  const PointVector a = Surface(600, 1, 0.01, {0, 0, 0}), b = Surface(500, 2, 0.01, {0, 0, 0});
  Write(a, b);
  CompareOptions options;
  options.distances = {0.03};
  options.max_distance = 0.2;
  options.tile_points = 100;
  Compare(options);
  ASSERT_EQ(differences_.size(), a.size() + b.size());
  for (const auto& [of_input, x, y, z, squared] : differences_) {
    const Eigen::Vector3d xyz(x, y, z);
    double least = kMaxDistances;  // any large number
    for (const auto& other : of_input > 0 ? b : a) {
      least = std::min(least, (xyz - other).norm());
    }
    if (least > 0.2) {
      EXPECT_TRUE(std::isinf(squared));
    } else {
      EXPECT_NEAR(std::sqrt(squared), least, 1e-12);
    }
  }
}

// A lattice whose neighbours lie on either side of every border that a tile can have.
TEST_F(CompareCloudsTest, TileBordersAreNoBorders) {
  PointVector a, b;
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 40; ++y) {
      a.emplace_back(x, y, 0);
      b.emplace_back(x + 0.5, y, 0.25 * (x % 2));
    }
  }
  Write(a, b);
  CompareOptions options;
  options.distances = {0.5, 0.75};
  options.tile_points = 30;
  const CloudComparison found = Compare(options);
  // 0.5 exactly at even x of b, which counts (<= d) for ETH3D and the points.
  EXPECT_EQ(found.reference.at[0].num_within, 800u);
  EXPECT_EQ(found.reference.at[1].num_within, 1600u);
  const CloudComparison oracle = CompareByBruteForce(a, b, found, setup_.view);
  EXPECT_EQ(found.input.at[0].num_within, oracle.input.at[0].num_within);
  EXPECT_EQ(found.input.median, oracle.input.median);
  EXPECT_EQ(found.reference.median, oracle.reference.median);
}

TEST_F(CompareCloudsTest, CloudsThatShareNothing) {
  Write(Surface(300, 1, 0.01, {0, 0, 0}), Surface(300, 2, 0.01, {1000, 0, 0}));
  CompareOptions options;
  options.distances = {0.1};
  options.tile_points = 50;
  const CloudComparison found = Compare(options);
  for (const OneWay* way : {&found.input, &found.reference}) {
    EXPECT_EQ(way->num_beyond, 300u);
    EXPECT_TRUE(std::isnan(way->mean));
    EXPECT_TRUE(std::isinf(way->median));
    EXPECT_EQ(way->at[0].num_within, 0u);
    EXPECT_EQ(way->at[0].voxel_share, 0);
    EXPECT_NEAR(way->at[0].far_area, way->area, 1e-12);
  }
}

TEST_F(CompareCloudsTest, PointsInOnePlace) {
  const PointVector a(5000, Eigen::Vector3d(1, 2, 3)), b(1, Eigen::Vector3d(1, 2, 3.5));
  Write(a, b);
  EXPECT_ERROR(Compare({}), "b.ply: all its points lie in one place");
  CompareOptions options;
  options.distances = {0.25, 0.5};
  const CloudComparison found = Compare(options);
  EXPECT_EQ(found.input.at[0].num_within, 0u);
  EXPECT_EQ(found.input.at[1].num_within, 5000u);
  EXPECT_EQ(found.reference.at[1].num_within, 1u);
  EXPECT_EQ(found.input.mean, 0.5);
  EXPECT_EQ(found.input.at[1].num_reduced, 1u);
  EXPECT_EQ(found.input.at[1].num_reduced_within, 0u);  // not nearer than d
}

TEST_F(CompareCloudsTest, RefusesWhatIsNoCloud) {
  Write({Eigen::Vector3d(0, 0, 0)}, {});
  EXPECT_ERROR(Compare({}), "b.ply: holds no points");
  EXPECT_ERROR(Compare({}, "b.ply", "a.ply"), "b.ply: holds no points");
  EXPECT_ERROR(Compare({}, "a.ply", "c.ply"), "c.ply: cannot be read");
  Write({Eigen::Vector3d(0, 0, 0)}, {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, NAN, 0)});
  EXPECT_ERROR(Compare({}), "b.ply: vertex 1 is not finite");
  for (const auto& entry : std::filesystem::directory_iterator(dir_.Path())) {
    EXPECT_EQ(entry.path().extension(), ".ply") << entry.path();
  }
}

}  // namespace
}  // namespace colmap_seapoint
