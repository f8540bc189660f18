#include "examples/survey/render/water.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {
namespace {

constexpr float kReferenceWidth = 1360;  // blur and flakes are given in its pixels

cv::Mat Wrap(FloatImage* image) {
  return cv::Mat(image->height, image->width, CV_32FC3, image->data.data());
}

struct Flake {
  float x, y, radius, light;
};

void AddFlake(const Flake& flake, FloatImage* linear) {
  const int x_end = std::min(linear->width, static_cast<int>(flake.x + flake.radius) + 1);
  const int y_end = std::min(linear->height, static_cast<int>(flake.y + flake.radius) + 1);
  for (int y = std::max(0, static_cast<int>(flake.y - flake.radius)); y < y_end; ++y) {
    for (int x = std::max(0, static_cast<int>(flake.x - flake.radius)); x < x_end; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - flake.x;
      const float dy = static_cast<float>(y) + 0.5f - flake.y;
      const float q = (dx * dx + dy * dy) / (flake.radius * flake.radius);
      if (q >= 1) continue;
      const float light = flake.light * (1 - q) * (1 - q);
      for (int c = 0; c < 3; ++c) linear->At(x, y, c) += light * (c == 0 ? 0.8f : 1.0f);
    }
  }
}

// sRGB for linear values k / 4095.
std::vector<uint8_t> MakeToneCurve() {
  std::vector<uint8_t> curve(4096);
  for (size_t k = 0; k < curve.size(); ++k) {
    const double v = static_cast<double>(k) / 4095;
    const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    curve[k] = static_cast<uint8_t>(std::lround(255 * s));
  }
  return curve;
}

}  // namespace

Water MakeWater(double turbidity, int width) {
  const float t = static_cast<float>(turbidity);
  Water water;
  water.attenuation = Eigen::Array3f(0.28f, 0.07f, 0.09f) + t * Eigen::Array3f(0.34f, 0.26f, 0.36f);
  water.veil = t * Eigen::Array3f(0.10f, 0.20f, 0.19f);
  water.open = (0.3f + t) * Eigen::Array3f(0.012f, 0.070f, 0.085f);
  water.halo_share = 0.5 * turbidity;
  water.halo_sigma = (3 + 6 * turbidity) * width / kReferenceWidth;
  return water;
}

float Caustics(const Eigen::Vector3d& point, double strength, uint64_t picture_seed) {
  // Bright lines where a wavy surface focuses: ridges of noise, warped by other noise.
  const double warp_x = 0.10 * NoiseAt(point.x(), point.y(), 0.45, Hash(picture_seed, 1));
  const double warp_y = 0.10 * NoiseAt(point.x(), point.y(), 0.45, Hash(picture_seed, 2));
  const double x = point.x() + 0.25 * point.z() + warp_x, y = point.y() + warp_y;
  const float coarse = 1 - std::min(1.0f, 3 * std::abs(NoiseAt(x, y, 0.33, Hash(picture_seed, 3))));
  const float fine = 1 - std::min(1.0f, 3 * std::abs(NoiseAt(x, y, 0.17, Hash(picture_seed, 4))));
  const float light = 1.9f * coarse * coarse * coarse + 0.9f * fine * fine * fine;
  return 1 + static_cast<float>(strength) * (light - 0.85f);
}

void ScatterForward(const Water& water, FloatImage* linear) {
  cv::Mat sharp = Wrap(linear);
  const double lens_sigma = 0.5 * std::max(1.0, linear->width / (2.0 * kReferenceWidth));
  cv::GaussianBlur(sharp, sharp, cv::Size(5, 5), lens_sigma);
  if (water.halo_share <= 0) return;
  // The halo is smooth: a picture of half the size carries it.
  cv::Mat small, halo;
  cv::resize(sharp, small, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  cv::GaussianBlur(small, small, cv::Size(), 0.5 * water.halo_sigma);
  cv::resize(small, halo, sharp.size(), 0, 0, cv::INTER_LINEAR);
  cv::addWeighted(sharp, 1 - water.halo_share, halo, water.halo_share, 0, sharp);
}

void AddMarineSnow(double density, uint64_t picture_seed, FloatImage* linear) {
  const int num_flakes = static_cast<int>(std::lround(350 * density));
  const float scale = static_cast<float>(linear->width) / kReferenceWidth;
  for (int k = 0; k < num_flakes; ++k) {
    const auto random = [&](int purpose) {
      return static_cast<float>(Uniform(Hash(picture_seed, 9000 + purpose, k)));
    };
    const float nearness = random(2) * random(2) * random(2);  // most are far and small
    Flake flake;
    flake.x = random(0) * static_cast<float>(linear->width);
    flake.y = random(1) * static_cast<float>(linear->height);
    flake.radius = scale * (1.6f + 26 * nearness);
    flake.light = (0.12f + 0.5f * random(3)) / (1 + 9 * nearness);
    AddFlake(flake, linear);
  }
}

ColorImage Expose(const FloatImage& linear, double noise, uint64_t picture_seed, int num_threads) {
  static const std::vector<uint8_t> kToneCurve = MakeToneCurve();
  ColorImage picture(linear.width, linear.height, 3);
  const float shot = static_cast<float>(noise * noise * 1.2e-4);
  const float read = static_cast<float>(noise * noise * 2.0e-6);
  ParallelFor(num_threads, linear.height, [&](int64_t y) {
    const float* in = linear.Row(static_cast<int>(y));
    uint8_t* out = picture.Row(static_cast<int>(y));
    for (size_t k = 0; k < linear.Stride(); ++k) {
      float value = std::max(in[k], 0.0f);
      if (noise > 0) {
        value += std::sqrt(read + shot * value) *
                 Bell(Hash(picture_seed + static_cast<uint64_t>(y) * linear.Stride() + k));
      }
      const float level = std::min(std::max(value, 0.0f), 1.0f) * 4095 + 0.5f;
      out[k] = kToneCurve[static_cast<size_t>(level)];
    }
  });
  return picture;
}

}  // namespace colmap_seapoint
