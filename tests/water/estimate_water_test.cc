#include "colmap_seapoint/water/estimate_water.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "colmap_seapoint/water/srgb.h"
#include "examples/benchmarks/map/color_difference.h"

namespace colmap_seapoint {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// A world of the model itself.
struct World {
  Eigen::Array3d attenuation{0.6, 0.2, 0.25}, veil{0.04, 0.15, 0.18}, veil_rate{0.5, 0.25, 0.3};
  double min_range = 1.5, max_range = 3;
  double falloff = 0;
  double noise = 0;  // of the light
  double wrong = 0;  // share of samples that show something else
  int num_places = 2000, samples_a_place = 4;
};

struct Survey {
  std::vector<WaterSample> samples;
  std::vector<Eigen::Array3d> colors;  // true ones, by place
};

Survey Take(const World& world, uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  Survey survey;
  for (int place = 0; place < world.num_places; ++place) {
    // Greys and colours whose mean is grey.
    const double light = 0.1 + 0.5 * uniform(random);
    Eigen::Array3d color = Eigen::Array3d::Constant(light);
    for (int c = 0; c < 3; ++c) color[c] *= 0.7 + 0.6 * uniform(random);
    survey.colors.push_back(color);
    for (int k = 0; k < world.samples_a_place; ++k) {
      const double z = world.min_range + (world.max_range - world.min_range) * uniform(random);
      Eigen::Array3d light_seen =
          color * (-world.attenuation * z).exp() + world.veil * (1 - (-world.veil_rate * z).exp());
      const double cosine = 0.6 + 0.4 * uniform(random);
      light_seen *= std::pow(cosine, world.falloff);
      if (uniform(random) < world.wrong) light_seen *= 2 * uniform(random);
      WaterSample sample;
      sample.place = static_cast<uint32_t>(place);
      sample.picture = static_cast<uint32_t>(k);
      sample.range = static_cast<float>(z);
      sample.axis_cosine = static_cast<float>(cosine);
      for (int c = 0; c < 3; ++c) {
        const double value = light_seen[c] + world.noise * normal(random);
        sample.rgb[static_cast<size_t>(c)] = static_cast<float>(std::max(0.0, value));
      }
      survey.samples.push_back(sample);
    }
  }
  return survey;
}

// Up to one factor for all channels, which is exposure.
double MeanColorError(const Survey& survey, const WaterModel& water) {
  double scale = 0, weight = 0, sum = 0;
  const auto restored = [&](const WaterSample& sample) -> Eigen::Array3d {
    return Restore(water, {sample.rgb[0], sample.rgb[1], sample.rgb[2]}, sample.range,
                   sample.axis_cosine)
        .cast<double>();
  };
  for (const WaterSample& sample : survey.samples) {
    const Eigen::Array3d is = restored(sample), should = survey.colors[sample.place];
    scale += (is * should).sum();
    weight += is.square().sum();
  }
  scale /= weight;
  for (const WaterSample& sample : survey.samples) {
    sum += DeltaE2000(LabFromLinear(scale * restored(sample)),
                      LabFromLinear(survey.colors[sample.place]));
  }
  return sum / static_cast<double>(survey.samples.size());
}

TEST(EstimateWater, ExactWorldGivesItsValues) {
  const World world;
  const WaterModel water = EstimateWater(Take(world).samples);
  ASSERT_EQ(water.state, WaterState::kDetermined);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(water.attenuation[c], world.attenuation[c], 0.01 * world.attenuation[c]);
    EXPECT_NEAR(water.veil[c], world.veil[c], 0.05 * world.veil[c]);
    EXPECT_NEAR(water.veil_rate[c], world.veil_rate[c], 0.05 * world.veil_rate[c]);
  }
}

TEST(EstimateWater, VignetteIsNotTakenForWater) {
  World world;
  world.falloff = 4;
  const WaterModel water = EstimateWater(Take(world).samples);
  ASSERT_EQ(water.state, WaterState::kDetermined);
  EXPECT_NEAR(water.falloff, 4, 0.05);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(water.attenuation[c], world.attenuation[c], 0.03 * world.attenuation[c] + 0.005);
  }
}

TEST(EstimateWater, NoiseAndWrongPlacesLeaveTheColorsRight) {
  World world;
  world.noise = 0.004;
  world.wrong = 0.15;
  const Survey survey = Take(world);
  const WaterModel water = EstimateWater(survey.samples);
  ASSERT_EQ(water.state, WaterState::kDetermined);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(water.attenuation[c], world.attenuation[c], 0.05) << c;
  }
  world.wrong = 0;
  const Survey clean = Take(world, 2);
  EXPECT_LT(MeanColorError(clean, water), 3);
  EXPECT_GT(MeanColorError(clean, WaterModel()), 15);
}

TEST(EstimateWater, ClearAirHasNoAttenuation) {
  World world;
  world.attenuation.setZero();
  world.veil.setZero();
  world.noise = 0.002;
  const Survey survey = Take(world);
  const WaterModel water = EstimateWater(survey.samples);
  for (int c = 0; c < 3; ++c) EXPECT_LT(water.attenuation[c], 0.02);
  EXPECT_LT(MeanColorError(survey, water), 2);
}

TEST(EstimateWater, UnitsOfTheModelDoNotMatter) {
  const World world;
  std::vector<WaterSample> samples = Take(world).samples;
  const WaterModel metres = EstimateWater(samples);
  for (WaterSample& sample : samples) sample.range *= 1000;
  const WaterModel millimetres = EstimateWater(samples);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(1000 * millimetres.attenuation[c], metres.attenuation[c], 1e-3);
    EXPECT_NEAR(millimetres.white[c], metres.white[c], 1e-3 * metres.white[c]);
  }
}

TEST(EstimateWater, OrderDoesNotMatter) {
  World world;
  world.noise = 0.01;
  std::vector<WaterSample> samples = Take(world).samples;
  const WaterModel a = EstimateWater(samples);
  std::shuffle(samples.begin(), samples.end(), std::mt19937(5));
  const WaterModel b = EstimateWater(samples);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(a.attenuation[c], b.attenuation[c]);
    EXPECT_EQ(a.veil[c], b.veil[c]);
    EXPECT_EQ(a.white[c], b.white[c]);
  }
}

TEST(EstimateWater, OneRangeIsSaidAndOnlyBalanced) {
  World world;
  world.min_range = 2;
  world.max_range = 2.001;
  const Survey survey = Take(world);
  const WaterModel water = EstimateWater(survey.samples);
  EXPECT_EQ(water.state, WaterState::kOneRange);
  EXPECT_TRUE((water.attenuation == 0).all() && (water.veil == 0).all());
  // The water's cast is gone all the same.
  EXPECT_LT(MeanColorError(survey, water), 0.6 * MeanColorError(survey, WaterModel()));
  EXPECT_NE(WaterText(water).find("one range"), std::string::npos);
}

TEST(EstimateWater, PlacesSeenOnceAreSaid) {
  World world;
  world.samples_a_place = 1;
  EXPECT_EQ(EstimateWater(Take(world).samples).state, WaterState::kTooFewPlaces);
  world.samples_a_place = 4;
  world.num_places = 19;
  EXPECT_EQ(EstimateWater(Take(world).samples).state, WaterState::kTooFewPlaces);
}

TEST(EstimateWater, NothingButNoiseIsNotBelieved) {
  World world;
  world.num_places = 25;
  world.samples_a_place = 2;
  world.min_range = 2;
  world.max_range = 2.4;
  world.noise = 0.2;
  const WaterModel water = EstimateWater(Take(world).samples);
  EXPECT_EQ(water.state, WaterState::kUncertain);
  EXPECT_TRUE((water.attenuation == 0).all());
}

TEST(EstimateWater, OddSamplesArePassedOver) {
  EXPECT_EQ(EstimateWater({}).state, WaterState::kTooFewPlaces);
  EXPECT_TRUE((EstimateWater({}).white == 1).all());
  const World world;
  std::vector<WaterSample> samples = Take(world).samples;
  const WaterModel clean = EstimateWater(samples);
  for (const float odd : {kNan, -1.0f, 1e30f, 1.0f}) {
    WaterSample sample = samples[5];
    sample.rgb[1] = odd;
    samples.push_back(sample);
  }
  for (const float odd : {kNan, -1.0f, 0.0f, 1.1f}) {
    WaterSample sample = samples[5];
    sample.axis_cosine = odd;
    samples.push_back(sample);
  }
  for (const float odd : {kNan, -1.0f, 0.0f, std::numeric_limits<float>::infinity()}) {
    WaterSample sample = samples[5];
    sample.range = odd;
    samples.push_back(sample);
  }
  const WaterModel water = EstimateWater(samples);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(water.attenuation[c], clean.attenuation[c]);
  std::vector<WaterSample> black(1000);
  for (size_t i = 0; i < black.size(); ++i) {
    black[i].place = static_cast<uint32_t>(i / 4);
    black[i].range = 1 + static_cast<float>(i % 4);
  }
  const WaterModel none = EstimateWater(black);
  EXPECT_TRUE(none.attenuation.allFinite() && none.white.allFinite());
}

TEST(Restore, NoiseIsNotMultipliedWithoutEnd) {
  World world;
  world.noise = 0.004;
  const WaterModel water = EstimateWater(Take(world).samples);
  const Eigen::Array3f dark(0.01f, 0.01f, 0.01f);
  EXPECT_TRUE((Restore(water, dark, 2) >= 0).all());
  // Ten times as far as any sample: red is as good as gone.
  const Eigen::Array3f veil = (water.veil * (1 - (-water.veil_rate * 30).exp())).cast<float>();
  const Eigen::Array3f noise = Restore(water, veil + 0.004f, 30);
  EXPECT_LT(noise.maxCoeff(), 0.15f);  // without a bound: 0.004 exp(0.6 * 30), more than white
  EXPECT_GT(noise.maxCoeff(), 0.05f);
}

TEST(Restore, UnknownRangesAreOnlyBalanced) {
  WaterModel water;
  water.attenuation.setConstant(1);
  water.max_gain.setConstant(100);
  water.white = {2, 1, 0.5};
  const Eigen::Array3f rgb(0.2f, 0.2f, 0.2f);
  for (const float range : {0.0f, -1.0f, kNan}) {
    const Eigen::Array3f restored = Restore(water, rgb, range);
    EXPECT_NEAR(restored[0], 0.4f, 1e-6);
    EXPECT_NEAR(restored[2], 0.1f, 1e-6);
  }
  EXPECT_NEAR(Restore(water, rgb, 1)[1], 0.2 * std::exp(1.0), 1e-6);
  // Of bytes, the same by way of light.
  EXPECT_EQ(RestorePixel(WaterModel(), {1, 128, 254}, 3), (std::array<uint8_t, 3>{1, 128, 254}));
}

TEST(Srgb, EveryByteComesBack) {
  for (int value = 0; value < 256; ++value) {
    const float light = LinearFromSrgb(static_cast<uint8_t>(value));
    EXPECT_EQ(SrgbFromLinear(light), value);
    EXPECT_EQ(SrgbFromLinear(light + 1e-6f), value);
  }
  EXPECT_EQ(SrgbFromLinear(-1), 0);
  EXPECT_EQ(SrgbFromLinear(7), 255);
  EXPECT_EQ(SrgbFromLinear(kNan), 0);
  EXPECT_NEAR(LinearFromSrgb(188), 0.5029, 1e-4);
}

// Of the pairs that Sharma, Wu and Dalal published to test implementations.
TEST(DeltaE2000, PublishedPairs) {
  const double pairs[][7] = {{50, 2.6772, -79.7751, 50, 0, -82.7485, 2.0425},
                             {50, -1, 2, 50, 0, 0, 2.3669},
                             {50, 2.49, -0.001, 50, -2.49, 0.0011, 7.2195},
                             {50, 2.5, 0, 73, 25, -18, 27.1492},
                             {60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644},
                             {2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082},
                             {6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377}};
  for (const auto& p : pairs) {
    EXPECT_NEAR(DeltaE2000({p[0], p[1], p[2]}, {p[3], p[4], p[5]}), p[6], 1e-4);
  }
  EXPECT_NEAR(LabFromLinear(Eigen::Array3d::Ones())[0], 100, 1e-9);
}

}  // namespace
}  // namespace colmap_seapoint
