// Demo surveys, whose colours under no water are known.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "colmap_seapoint/water/estimate_water.h"
#include "colmap_seapoint/water/srgb.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/survey.h"
#include "tests/water/color_difference.h"

namespace colmap_seapoint {
namespace {

constexpr int kNumPlaces = 3000;
constexpr int kReach = 1;  // pixels about a place that its colour is the mean of

struct Survey {
  std::vector<WaterSample> samples;
  std::vector<Eigen::Array3d> colors;  // true ones, by place
};

// Mean light about a place in a picture.
std::array<float, 3> LightAt(const ColorImage& picture, int x, int y) {
  std::array<float, 3> sum = {0, 0, 0};
  constexpr int kSide = 2 * kReach + 1;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      for (size_t c = 0; c < 3; ++c) {
        sum[c] += LinearFromSrgb(picture.At(x + dx, y + dy, static_cast<int>(c))) / (kSide * kSide);
      }
    }
  }
  return sum;
}

Survey TakeSurvey(const SurveyOptions& options) {
  const SurveyTruth truth = MakeSurveyTruth(options);
  std::vector<ColorImage> pictures;
  std::vector<PosedImage> images;
  RenderSurvey(options, truth, [&](const PosedImage& image, ColorImage&& picture) {
    images.push_back(image);
    pictures.push_back(std::move(picture));
  });
  const GridSpec& grid = truth.surface.Ground().Grid();
  const Seabed seabed({static_cast<uint64_t>(options.seed), options.relief, NominalGsd(options)});
  AlbedoMap albedo(seabed, grid.MinX(), grid.MinY(), grid.MaxX(), grid.MaxY(), size_t{1} << 30);
  albedo.Prepare(grid.MinX(), grid.MinY(), grid.MaxX(), grid.MaxY(), options.num_threads);
  const double reach = (kReach + 0.5) * truth.gsd;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Survey survey;
  while (survey.colors.size() < kNumPlaces) {
    const double x =
        grid.MinX() + reach + uniform(random) * (grid.MaxX() - grid.MinX() - 2 * reach);
    const double y =
        grid.MinY() + reach + uniform(random) * (grid.MaxY() - grid.MinY() - 2 * reach);
    Eigen::Array3d color = Eigen::Array3d::Zero();
    for (int k = 0; k < 64; ++k) {
      const Albedo at =
          albedo.At(x + reach * ((k % 8 + 0.5) / 4 - 1), y + reach * ((k / 8 + 0.5) / 4 - 1));
      color += Eigen::Array3d(at.red, at.green, at.blue) / 64;
    }
    const Eigen::Vector3d point = truth.surface.GroundAt(x, y).xyz;
    for (size_t i = 0; i < images.size(); ++i) {
      const Camera& camera = truth.model.cameras.at(images[i].camera_id);
      const auto pixel = camera.ImgFromCam(images[i].cam_from_world * point);
      if (!pixel) continue;
      const int px = static_cast<int>(std::floor(pixel->x()));
      const int py = static_cast<int>(std::floor(pixel->y()));
      if (px < kReach || py < kReach || px >= camera.width - kReach ||
          py >= camera.height - kReach) {
        continue;
      }
      const Eigen::Vector3d center = images[i].cam_from_world.OriginInSource();
      const auto t = truth.surface.IntersectRay(center, point - center, 0, 2);
      if (!t || std::abs(*t - 1) > 0.005) continue;  // hidden
      WaterSample sample;
      sample.place = static_cast<uint32_t>(survey.colors.size());
      sample.picture = static_cast<uint32_t>(i);
      sample.range = static_cast<float>((point - center).norm());
      sample.rgb = LightAt(pictures[i], px, py);
      survey.samples.push_back(sample);
    }
    survey.colors.push_back(color);
  }
  return survey;
}

double MeanDeltaE(const Survey& survey, const WaterModel& water) {
  double sum = 0;
  for (const WaterSample& sample : survey.samples) {
    const Eigen::Array3f restored =
        Restore(water, {sample.rgb[0], sample.rgb[1], sample.rgb[2]}, sample.range);
    sum += DeltaE2000(LabFromLinear(restored.cast<double>().min(1)),
                      LabFromLinear(survey.colors[sample.place]));
  }
  return sum / static_cast<double>(survey.samples.size());
}

struct Dive {
  const char* name;
  double turbidity;
  SurveyPath path;
};

class SurveyColors : public testing::TestWithParam<Dive> {};

TEST_P(SurveyColors, BalancedIsAtMostHalfAsFarFromTheTruthAsRaw) {
  SurveyOptions options;
  options.path = GetParam().path;
  options.turbidity = GetParam().turbidity;
  options.width = 400;
  options.height = 300;
  options.images_per_strip = 5;
  const Survey survey = TakeSurvey(options);
  const WaterModel water = EstimateWater(survey.samples);
  const double raw = MeanDeltaE(survey, {}), balanced = MeanDeltaE(survey, water);
  RecordProperty("raw", std::to_string(raw));
  RecordProperty("balanced", std::to_string(balanced));
  std::printf("%s: raw %.2f balanced %.2f, %s, white %.2f %.2f %.2f\n", GetParam().name, raw,
              balanced, WaterText(water).c_str(), water.white[0], water.white[1], water.white[2]);
  EXPECT_LE(balanced, 0.5 * raw);
}

INSTANTIATE_TEST_SUITE_P(Dives, SurveyColors,
                         testing::Values(Dive{"clear", 0.0, SurveyPath::kStrips},
                                         Dive{"usual", 0.3, SurveyPath::kStrips},
                                         Dive{"turbid", 0.7, SurveyPath::kStrips},
                                         Dive{"descent", 0.3, SurveyPath::kDescent}),
                         [](const auto& dive) { return std::string(dive.param.name); });

}  // namespace
}  // namespace colmap_seapoint
