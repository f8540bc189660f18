// Colours of a picture between its pixels, and light instead of what a screen is sent.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "colmap_seapoint/base/picture.h"

namespace colmap_seapoint {

using Light = std::array<float, 3>;  // red, green, blue, linear, 1 = white

namespace sampling {

inline constexpr int kScreenSteps = 4096;

// sRGB's curve and its inverse, with one entry more than is needed.
struct LightTables {
  std::array<float, 257> light;
  std::array<float, kScreenSteps + 2> screen;
  LightTables();
};
extern const LightTables kLightTables;

// Between the four nearest pixels' centres; beyond the outermost ones, those.
inline float Bilinear(const GrayImage& image, float x, float y) {
  const float px = std::clamp(x - 0.5f, 0.0f, static_cast<float>(image.width - 1));
  const float py = std::clamp(y - 0.5f, 0.0f, static_cast<float>(image.height - 1));
  const int left = std::min(static_cast<int>(px), std::max(0, image.width - 2));
  const int top = std::min(static_cast<int>(py), std::max(0, image.height - 2));
  const int right = std::min(left + 1, image.width - 1);
  const float fx = px - static_cast<float>(left), fy = py - static_cast<float>(top);
  const uint8_t *above = image.Row(top), *below = image.Row(std::min(top + 1, image.height - 1));
  const float a =
      static_cast<float>(above[left]) * (1 - fx) + static_cast<float>(above[right]) * fx;
  const float b =
      static_cast<float>(below[left]) * (1 - fx) + static_cast<float>(below[right]) * fx;
  return a + fy * (b - a);
}

}  // namespace sampling

// sRGB's curve, by tables: from 0 ... 255 with fractions, and to the nearest of 0 ... 255.
inline float LightOf(float value) {
  const std::array<float, 257>& table = sampling::kLightTables.light;
  const auto at = static_cast<size_t>(value);
  return table[at] + (value - static_cast<float>(at)) * (table[at + 1] - table[at]);
}

inline uint8_t ScreenOf(float light) {
  const auto& table = sampling::kLightTables.screen;
  const float place = std::clamp(light, 0.0f, 1.0f) * sampling::kScreenSteps;
  const auto at = static_cast<size_t>(place);
  const float value = table[at] + (place - static_cast<float>(at)) * (table[at + 1] - table[at]);
  return static_cast<uint8_t>(value + 0.5f);
}

inline bool IsMasked(const Picture& picture, float x, float y) {
  if (picture.mask.Empty()) return false;
  const int column = std::clamp(static_cast<int>(x), 0, picture.mask.width - 1);
  const int row = std::clamp(static_cast<int>(y), 0, picture.mask.height - 1);
  return picture.mask.At(column, row) == 0;
}

// Red, green and blue, 0 ... 255, at a place in pixels of the luma.
inline std::array<float, 3> ScreenColorAt(const Picture& picture, float x, float y) {
  const float luma = sampling::Bilinear(picture.luma, x, y);
  if (!picture.HasColor()) return {luma, luma, luma};
  const float cx = x / static_cast<float>(1 << picture.chroma_shift_x);
  const float cy = y / static_cast<float>(1 << picture.chroma_shift_y);
  const float cb = sampling::Bilinear(picture.cb, cx, cy) - 128;
  const float cr = sampling::Bilinear(picture.cr, cx, cy) - 128;
  return {std::clamp(luma + 1.402f * cr, 0.0f, 255.0f),
          std::clamp(luma - 0.344136286f * cb - 0.714136286f * cr, 0.0f, 255.0f),
          std::clamp(luma + 1.772f * cb, 0.0f, 255.0f)};
}

inline Light LightAt(const Picture& picture, float x, float y) {
  const std::array<float, 3> color = ScreenColorAt(picture, x, y);
  return {LightOf(color[0]), LightOf(color[1]), LightOf(color[2])};
}

}  // namespace colmap_seapoint
