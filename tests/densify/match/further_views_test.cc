#include "densify/match/further_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "colmap_seapoint/base/parallel.h"
#include "tests/synthetic/world.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2;
constexpr int kWidth = 220, kHeight = 160;
constexpr int kRim = 12;           // pixels: no patch reaches beyond a picture from inside
constexpr double kScatter = 0.2;   // of the pair's own disparities, pixels
constexpr double kPixelNoise = 3;  // grey values, in each picture its own

// Grey value of a surface point.
using Texture = std::function<double(const Eigen::Vector3d& point)>;
// Whether a sample is looked at.
using Choice = std::function<bool(int a, int b)>;

Texture Mottled(uint32_t seed) {
  const NoiseTexture noise(seed, 0.12, 4);
  return [noise](const Eigen::Vector3d& point) { return 127 + 100 * noise.At(point); };
}

Viewpoint Stand(const Eigen::Vector3d& center, const Eigen::Vector3d& turn_deg = {0, 0, 0}) {
  return StandAt(MildCamera(CameraModel::kOpenCV, 400, kWidth, kHeight), center, turn_deg);
}

// A disparity of 40 pixels and a parallax of 5.7 degrees; the third one looks from above, too.
const Viewpoint kFirst = Stand({-0.1, 0, 0}, {1, -1, 2});
const Viewpoint kSecond = Stand({0.1, 0.01, 0.01}, {-1, 1, -2});
const Viewpoint kThird = Stand({0.02, 0.12, -0.02}, {2, 0, 3});

// A plane through the middle of what the pair sees, turned about the y axis.
World Slanted() { return SlantedWorld(kDepth, 20); }

// The mean of 2 x 2 rays a pixel, and noise.
GrayImage Shoot(const World& world, const Texture& texture, const Viewpoint& viewpoint,
                double noise, uint32_t seed) {
  GrayImage picture(viewpoint.camera.width, viewpoint.camera.height);
  ParallelFor(2, picture.height, [&](int64_t row) {
    std::mt19937 generator(seed + static_cast<uint32_t>(row));
    std::normal_distribution<double> of_pixel(0, 1);
    for (int x = 0; x < picture.width; ++x) {
      double gray = noise * of_pixel(generator);
      for (int ray = 0; ray < 4; ++ray) {
        const Eigen::Vector2d pixel(x + 0.25 + 0.5 * (ray % 2),
                                    static_cast<double>(row) + 0.25 + 0.5 * (ray / 2));
        const auto point = SurfaceAt(world, viewpoint, pixel);
        gray += point ? texture(*point) / 4 : 0;
      }
      picture.At(x, static_cast<int>(row)) =
          static_cast<uint8_t>(std::clamp(std::lround(gray), 1l, 255l));
    }
  });
  return picture;
}

// A further picture.
struct Taken {
  Taken(const World& world, const Texture& texture, const Viewpoint& viewpoint,
        double noise = kPixelNoise)
      : view{2, viewpoint.camera, viewpoint.cam_from_world},
        luma(Shoot(world, texture, viewpoint, noise, 2000)) {}
  operator FurtherView() const { return {view, &luma}; }

  View view;
  GrayImage luma;
};

bool Shows(const Viewpoint& viewpoint, const Eigen::Vector3d& point) {
  const auto pixel = viewpoint.camera.ImgFromCam(viewpoint.cam_from_world * point);
  return pixel && pixel->x() > kRim && pixel->y() > kRim && pixel->x() < kWidth - kRim &&
         pixel->y() < kHeight - kRim;
}

// What a pair has measured of an exact surface, and what further pictures make of it.
class PairOnSurface {
 public:
  PairOnSurface(const World& world, const Texture& texture, const Viewpoint& view1 = kFirst,
                const Viewpoint& view2 = kSecond, double noise = kPixelNoise)
      : geometry(*MakePairGeometry(view1.camera, view1.cam_from_world, view2.camera,
                                   view2.cam_from_world)),
        world_(world) {
    const RectWindow window = WindowOfPicture(geometry, false);
    BlockMask blocks(window);
    blocks.Want(0, 0, window.width, window.height);
    picture1_ = RectMap(geometry, false, window, 2)
                    .Rectify(Shoot(world, texture, view1, noise, 1000), blocks, 2);
    measured.grid = SampleGrid(window, 2);
    measured.disparity.assign(measured.grid.Size(), 0);
    measured.score.assign(measured.grid.Size(), 0.9f);
    measured.deviation.assign(measured.grid.Size(), static_cast<float>(kScatter));
    truth.assign(measured.grid.Size(), 0);
    std::mt19937 generator(4);
    std::normal_distribution<double> scatter(0, kScatter);
    size_t sample = 0;
    for (int b = 0; b < measured.grid.height; ++b) {
      for (int a = 0; a < measured.grid.width; ++a, ++sample) {
        truth[sample] = TrueDisparity(a, b, view1, view2);
        if (truth[sample] == 0) continue;
        measured.disparity[sample] = static_cast<float>(truth[sample] + scatter(generator));
      }
    }
  }

  // Of the surface, at a sample of picture 1.
  std::optional<Eigen::Vector3d> PointAt(int a, int b) const {
    return world_.Cast(geometry.center1, geometry.world_from_rect * RayAt(a, b));
  }

  // The surface is fitted to the pair's samples, as MatchSurface does.
  PartialDisparity With(const std::vector<FurtherView>& further, int num_threads = 2) const {
    PartialDisparity result = measured;
    MeasureInFurtherViews(geometry, picture1_, FitSurface(measured, 2, 0.75f, 2), further,
                          num_threads, &result);
    return result;
  }

  const PairGeometry geometry;
  PartialDisparity measured;  // by the pair alone, off the truth by kScatter
  std::vector<double> truth;  // disparity; 0 where the pair does not show the surface

 private:
  Eigen::Vector3d RayAt(int a, int b) const {
    return geometry.RayAt(measured.grid.RectX(a), measured.grid.RectY(b));
  }

  double TrueDisparity(int a, int b, const Viewpoint& view1, const Viewpoint& view2) const {
    const auto point = PointAt(a, b);
    if (!point || !Shows(view1, *point) || !Shows(view2, *point)) return 0;
    const double x = measured.grid.RectX(a), y = measured.grid.RectY(b);
    const double disparity = geometry.DisparityAtRange(x, y, (*point - geometry.center1).norm());
    return geometry.SineOfParallax(x, y, disparity) < kMinSineOfParallax ? 0 : disparity;
  }

  const World world_;
  RectPicture picture1_;
};

const PairOnSurface& SlantedPair() {
  static const PairOnSurface pair(Slanted(), Mottled(42));
  return pair;
}

Choice ShownBy(const PairOnSurface& pair, const Viewpoint& viewpoint) {
  return [&pair, &viewpoint](int a, int b) { return Shows(viewpoint, *pair.PointAt(a, b)); };
}

// Of the samples chosen where the pair shows the surface.
struct Tally {
  double count = 0;
  double sharper = 0, same = 0, unsure = 0;  // shares: deviation less, all equal, four times
  // Root mean squares, of the sharper ones: errors of the pair alone, then; deviations then.
  double before = 0, after = 0, claimed = 0;
};

Tally Compare(const PairOnSurface& pair, const PartialDisparity& result, const Choice& choice) {
  Tally tally;
  double num_sharper = 0;
  for (int b = 0; b < result.grid.height; ++b) {
    for (int a = 0; a < result.grid.width; ++a) {
      const auto i = static_cast<size_t>(b * result.grid.width + a);
      if (pair.truth[i] == 0 || !choice(a, b)) continue;
      ++tally.count;
      const double deviation = static_cast<double>(result.deviation[i]);
      const double before = static_cast<double>(pair.measured.disparity[i]) - pair.truth[i];
      const double after = static_cast<double>(result.disparity[i]) - pair.truth[i];
      tally.same += result.deviation[i] == pair.measured.deviation[i] && before == after;
      tally.unsure += result.deviation[i] == 4 * pair.measured.deviation[i] && before == after;
      if (result.deviation[i] >= pair.measured.deviation[i]) continue;
      ++num_sharper;
      tally.before += before * before;
      tally.after += after * after;
      tally.claimed += deviation * deviation;
    }
  }
  tally.sharper = num_sharper / tally.count;
  for (double* share : {&tally.same, &tally.unsure}) *share /= tally.count;
  for (double* squares : {&tally.before, &tally.after, &tally.claimed}) {
    *squares = std::sqrt(*squares / num_sharper);
  }
  return tally;
}

void ExpectSame(const PartialDisparity& one, const PartialDisparity& other) {
  EXPECT_EQ(one.disparity, other.disparity);
  EXPECT_EQ(one.deviation, other.deviation);
  EXPECT_EQ(one.score, other.score);
}

// Wherever it stands, however it is rolled, at 0.6 to 1.5 times the range: the error falls, the
// farther it stands from picture 1, and is what the deviations say. None is doubted.
TEST(FurtherViewsTest, SharpensWhereverItStands) {
  struct Third {
    const char* name;
    Viewpoint view;
    double error;  // of the pair's
  };
  const Third thirds[] = {
      {"between the two", Stand({0, 0, 0}, {1, -1, 2}), 0.6},
      {"beyond picture 2", Stand({0.2, 0, 0}, {1, 1, 2}), 0.25},
      {"above", kThird, 0.4},
      {"rolled", Stand({0.02, 0.15, -0.02}, {2, 0, 90}), 0.4},
      {"upside down", Stand({0.02, 0.15, -0.02}, {2, 0, 180}), 0.4},
      {"nearer", Stand({0, 0.05, 0.7}, {2, 0, 3}), 0.5},
      {"farther", Stand({0.1, 0.15, -1}, {2, 0, 3}), 0.5},
  };
  for (const Third& third : thirds) {
    SCOPED_TRACE(third.name);
    const Taken taken(Slanted(), Mottled(42), third.view);
    const Tally tally =
        Compare(SlantedPair(), SlantedPair().With({taken}), ShownBy(SlantedPair(), third.view));
    EXPECT_GT(tally.count, 1500);
    EXPECT_GT(tally.sharper, 0.998);
    EXPECT_LT(tally.unsure, 0.001);
    EXPECT_LT(tally.after, third.error * tally.before);
    EXPECT_GT(tally.claimed, 0.75 * tally.after);
    EXPECT_LT(tally.claimed, 1.15 * tally.after);
  }
}

// The cameras swim ahead, and the map magnifies around the epipole in the pictures, where
// neighbouring pixels of a patch share their noise; what is drawn at more than twice the further
// picture's size is left alone.
TEST(FurtherViewsTest, SharpensOnMercatorsMap) {
  const PairOnSurface pair(Slanted(), Mottled(42), Stand({0, 0, 0}),
                           Stand({0.02, 0.01, 0.5}, {1, -2, 2}));
  ASSERT_EQ(pair.geometry.surface, RectSurface::kMercator);
  for (const Viewpoint& view :
       {Stand({0.1, 0.1, 0.25}, {1, 1, 2}), Stand({0, 0, 0.25}, {1, 1, 2})}) {
    const Taken taken(Slanted(), Mottled(42), view);
    const Tally tally = Compare(pair, pair.With({taken}), [&](int a, int b) {
      return pair.geometry.Magnification(pair.measured.grid.RectX(a)) < 1.7 &&
             Shows(view, *pair.PointAt(a, b));
    });
    EXPECT_GT(tally.count, 1500);
    EXPECT_GT(tally.sharper, 0.95);
    EXPECT_LT(tally.unsure, 0.002);
    EXPECT_LT(tally.after, tally.before);
    EXPECT_GT(tally.claimed, 0.6 * tally.after);
  }
}

TEST(FurtherViewsTest, TwoSharpenMoreThanEither) {
  const Viewpoint other = Stand({0.1, -0.1, 0}, {-2, 1, 0});
  const Taken taken1(Slanted(), Mottled(42), kThird), taken2(Slanted(), Mottled(42), other);
  const Choice shown_by_both = [&](int a, int b) {
    const Eigen::Vector3d point = *SlantedPair().PointAt(a, b);
    return Shows(kThird, point) && Shows(other, point);
  };
  const auto error = [&](const std::vector<FurtherView>& further) {
    return Compare(SlantedPair(), SlantedPair().With(further), shown_by_both).after;
  };
  const double of_both = error({taken1, taken2});
  EXPECT_LT(of_both, 0.9 * error({taken1}));
  EXPECT_LT(of_both, 0.9 * error({taken2}));
}

// Half a pixel off everywhere: what remains of it is the pair's share in the mean, which follows
// from the deviation before and after.
TEST(FurtherViewsTest, AWrongDisparityMovesByItsWeight) {
  PairOnSurface pair(Slanted(), Mottled(42), kFirst, kSecond, 0);
  for (size_t i = 0; i < pair.truth.size(); ++i) {
    if (pair.truth[i] > 0) pair.measured.disparity[i] = static_cast<float>(pair.truth[i] + 0.5);
  }
  const Taken taken(Slanted(), Mottled(42), kThird, 0);
  for (const float own : {0.05f, 0.1f, 0.2f}) {
    pair.measured.deviation.assign(pair.truth.size(), own);
    const PartialDisparity result = pair.With({taken});
    double count = 0, sum = 0, sum_remaining = 0, sum_squares = 0;
    for (size_t i = 0; i < pair.truth.size(); ++i) {
      if (!(result.deviation[i] < own)) continue;
      const double after = static_cast<double>(result.deviation[i]);
      // The pair's deviation cannot be less than 0.03 pixels either.
      const double share = std::pow(after / std::hypot(static_cast<double>(own), 0.03), 2);
      const double remaining = static_cast<double>(result.disparity[i]) - pair.truth[i];
      ++count;
      sum += remaining - 0.5 * share;
      sum_squares += std::pow(remaining - 0.5 * share, 2);
      sum_remaining += remaining;
    }
    EXPECT_GT(count, 3000);
    EXPECT_NEAR(sum / count, 0, 0.02);  // the gradient is not quite even over half a pixel
    EXPECT_LT(std::sqrt(sum_squares / count), 0.04);
    EXPECT_LT(sum_remaining / count, 0.3);
  }
}

// A sample surer than any picture can say stays so.
TEST(FurtherViewsTest, AgreementMakesNothingLessSure) {
  PairOnSurface pair = SlantedPair();
  pair.measured.deviation.assign(pair.truth.size(), 0.005f);
  const Taken taken(Slanted(), Mottled(42), kThird);
  const PartialDisparity result = pair.With({taken});
  for (size_t i = 0; i < pair.truth.size(); ++i) {
    ASSERT_TRUE(result.deviation[i] == 0.005f || result.deviation[i] == 4 * 0.005f);
  }
  EXPECT_NE(result.disparity, pair.measured.disparity);
}

// Fins before the third camera: noise of their own in a square of its picture. Where another
// picture agrees, one against one, the pair is believed.
TEST(FurtherViewsTest, WhatMovedIsUnsureUnlessAnotherAgrees) {
  const Taken still(Slanted(), Mottled(42), kThird);
  Taken moved = still;
  std::mt19937 generator(9);
  for (int y = 40; y < 110; ++y) {
    for (int x = 60; x < 150; ++x) {
      moved.luma.At(x, y) = static_cast<uint8_t>(1 + generator() % 255);
    }
  }
  const auto within = [&](int grow) {
    return [grow](int a, int b) {
      const Eigen::Vector3d point = *SlantedPair().PointAt(a, b);
      const auto pixel = kThird.camera.ImgFromCam(kThird.cam_from_world * point);
      return pixel && pixel->x() > 60 - grow && pixel->x() < 150 + grow && pixel->y() > 40 - grow &&
             pixel->y() < 110 + grow;
    };
  };
  const PartialDisparity result = SlantedPair().With({moved});
  const Tally inside = Compare(SlantedPair(), result, within(-7));
  EXPECT_GT(inside.count, 800);
  EXPECT_GT(inside.unsure, 0.98);
  const Tally beside = Compare(SlantedPair(), result, [&](int a, int b) {
    return !within(7)(a, b) && Shows(kThird, *SlantedPair().PointAt(a, b));
  });
  EXPECT_GT(beside.sharper, 0.998);
  EXPECT_EQ(beside.unsure, 0);
  const Tally one_each = Compare(SlantedPair(), SlantedPair().With({moved, still}), within(-7));
  EXPECT_EQ(one_each.unsure, 0);
  EXPECT_GT(one_each.sharper, 0.99);
  const Tally outvoted =
      Compare(SlantedPair(), SlantedPair().With({moved, still, moved}), within(-7));
  EXPECT_GT(outvoted.unsure, 0.96);
}

// A picture of another surface altogether, from ever farther aside: the rays of the pair are 5.7
// degrees apart, a third one within 8.6 degrees of them could see no other thing than they.
TEST(FurtherViewsTest, NoWitnessFromFarAside) {
  for (const double aside : {0.12, 0.2, 0.4, 0.6}) {
    const Viewpoint view = Stand({0, aside, 0}, {-aside * 28, 0, 3});
    const Taken taken(Slanted(), Mottled(7), view);
    const Tally tally =
        Compare(SlantedPair(), SlantedPair().With({taken}), ShownBy(SlantedPair(), view));
    EXPECT_GT(tally.count, 1500);
    if (aside < 0.3) {
      EXPECT_GT(tally.unsure, 0.8);
    } else {
      EXPECT_EQ(tally.unsure, 0);
      EXPECT_GT(tally.same, 0.9);  // the others are alike by chance
    }
  }
}

// A plane that falls away from the cameras, so that the upper part of the pictures sees it flatter
// than 17 degrees: what another picture shows there says little.
TEST(FurtherViewsTest, NoWitnessOfWhatIsTurnedAway) {
  const double angle = 70 * M_PI / 180;
  const World world({{{0, 0, kDepth}, {50, 0, 0}, {0, 50 * std::cos(angle), 50 * std::sin(angle)}}},
                    NoiseTexture(1, 1, 1));
  const Eigen::Vector3d normal(0, -std::sin(angle), std::cos(angle));
  const PairOnSurface pair(world, Mottled(42));
  const Viewpoint view = Stand({0, 0, 0});
  const Taken taken(world, Mottled(7), view);
  const PartialDisparity result = pair.With({taken});
  const auto facing = [&](double least, double most) {
    return Compare(pair, result, [&, least, most](int a, int b) {
      const Eigen::Vector3d point = *pair.PointAt(a, b);
      const double cosine = std::abs(normal.dot((point - view.Center()).normalized()));
      return Shows(view, point) && cosine > least && cosine < most;
    });
  };
  const Tally away = facing(0, 0.27), towards = facing(0.35, 1);
  EXPECT_GT(away.count, 500);
  EXPECT_LT(away.unsure, 0.01);  // the surface's slope is measured, too
  EXPECT_GT(towards.count, 500);
  EXPECT_GT(towards.unsure, 0.7);
}

// A place without texture is not contradicted, nor one whose texture runs along the line on which
// the surface would move, nor by a picture from where picture 1 was taken: it cannot tell.
TEST(FurtherViewsTest, WhatCannotBeToldIsNotContradicted) {
  const NoiseTexture noise(42, 0.12, 4);
  const Texture even = [](const Eigen::Vector3d&) { return 127; };
  const Texture upright = [noise](const Eigen::Vector3d& point) {
    return 127 + 100 * noise.At({point.x(), 0.01, 0});
  };
  const Texture oblique = [noise](const Eigen::Vector3d& point) {
    return 127 + 100 * noise.At({point.x() - point.y(), 0.01, 0});
  };
  const Viewpoint above = Stand({-0.1, 0.12, 0}, {1, -1, 2});
  struct Case {
    const char* name;
    Texture texture;
    double noise;
    Viewpoint view;
  };
  const Case cases[] = {{"even", even, 0, kThird},
                        {"even, noise", even, 0.8, kThird},
                        {"upright stripes from above", upright, kPixelNoise, above},
                        {"oblique stripes obliquely", oblique, kPixelNoise, kThird},
                        {"same place", Mottled(42), kPixelNoise, kFirst}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const PairOnSurface pair(Slanted(), c.texture, kFirst, kSecond, c.noise);
    const Taken taken(Slanted(), c.texture, c.view, c.noise);
    const Tally tally = Compare(pair, pair.With({taken}), ShownBy(pair, c.view));
    EXPECT_GT(tally.count, 1500);
    EXPECT_LT(tally.unsure, 0.003);
  }
}

// A lens that draws a patch wide and flat. Its first pixels lie a pixel within the picture, or the
// sample is left alone: at (8.05, 3.05) a byte before the picture's first one would be read.
TEST(FurtherViewsTest, PatchesLieWithinThePicture) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 400, kWidth, kHeight);
  PairOnSurface pair(FlatWorld(kDepth), Mottled(42), StandAt(camera, {-0.1, 0, 0}),
                     StandAt(camera, {0.1, 0, 0}));
  for (size_t i = 0; i < pair.truth.size(); ++i) {
    pair.measured.disparity[i] = static_cast<float>(pair.truth[i]);
  }
  // The first of its block of 8 x 8 pixels: the others ask where the further picture shows that
  // one.
  const int a = pair.measured.grid.width / 8 * 4, b = pair.measured.grid.height / 8 * 4;
  const auto sample = static_cast<size_t>(b * pair.measured.grid.width + a);
  ASSERT_GT(pair.truth[sample], 0);
  const auto is_measured_at = [&](const Eigen::Vector2d& pixel) {
    Viewpoint view = StandAt(camera, {0, 0, 0});
    view.camera.params = {1.4 * 400, 0.4 * 400, 0, 0};
    const Eigen::Vector2d offset =
        pixel - *view.camera.ImgFromCam(view.cam_from_world * *pair.PointAt(a, b));
    view.camera.params = {1.4 * 400, 0.4 * 400, offset.x(), offset.y()};
    const Taken taken(FlatWorld(kDepth), Mottled(42), view);
    bool is_measured = false;
    ForEachVectorTarget([&] {
      is_measured = pair.With({taken}).deviation[sample] < pair.measured.deviation[sample];
    });
    return is_measured;
  };
  EXPECT_FALSE(is_measured_at({8.05, 3.05}));
  EXPECT_FALSE(is_measured_at({8.55, 3.45}));
  EXPECT_FALSE(is_measured_at({8.45, 3.55}));
  EXPECT_TRUE(is_measured_at({8.55, 3.55}));
  EXPECT_TRUE(is_measured_at({kWidth - 8.55, kHeight - 3.55}));
  EXPECT_FALSE(is_measured_at({kWidth - 8.45, kHeight - 3.55}));
  EXPECT_FALSE(is_measured_at({kWidth - 8.55, kHeight - 3.45}));
}

// None at all, one that looks elsewhere, one behind the surface, one too far away or too near to be
// compared: nothing changes.
TEST(FurtherViewsTest, NothingChangesWhereNothingIsShown) {
  ExpectSame(SlantedPair().With({}), SlantedPair().measured);
  for (const Viewpoint& view : {Stand({0, 0, 0}, {0, 90, 0}), Stand({2, 0, 0}), Stand({0, 0, 4}),
                                Stand({0, 0, -4}), Stand({0, 0, 1.3})}) {
    const Taken taken(Slanted(), Mottled(42), view);
    ExpectSame(SlantedPair().With({taken}), SlantedPair().measured);
  }
}

TEST(FurtherViewsTest, SameWithAnyThreadsAndVectors) {
  const Taken taken1(Slanted(), Mottled(42), kThird);
  const Taken taken2(Slanted(), Mottled(7), Stand({0.2, 0, 0}, {1, 1, 2}));
  const PartialDisparity one = SlantedPair().With({taken1, taken2}, 1);
  for (const int num_threads : {1, 2, 5}) {
    ForEachVectorTarget([&] {
      ExpectSame(SlantedPair().With({taken1, taken2}, num_threads), one);
    });
  }
}

}  // namespace
}  // namespace colmap_seapoint
