#include "feature/rbrief_descriptor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "feature/local_contrast.h"
#include "feature/rbrief_pattern.h"

namespace colmap_seapoint {

namespace {

constexpr int kCentroidRadius = 15;

// Half width of the disc's rows. Rounded down: exactly the pixels with x^2 + y^2 <= radius^2, as
// wide as high. (Rounded to nearest, columns are cut otherwise than rows, and quarter turns of a
// picture turn the orientation by up to 7 degrees more or less.)
std::vector<int> DiscHalfWidths() {
  std::vector<int> half_widths;
  for (int y = 0; y <= kCentroidRadius; ++y) {
    half_widths.push_back(static_cast<int>(
        std::sqrt(static_cast<double>(kCentroidRadius * kCentroidRadius - y * y))));
  }
  return half_widths;
}

float CentroidOrientation(const GrayImage& picture, int x, int y,
                          const std::vector<int>& half_widths) {
  int moment_x = 0, moment_y = 0;
  for (int v = -kCentroidRadius; v <= kCentroidRadius; ++v) {
    const int half_width = half_widths[static_cast<size_t>(std::abs(v))];
    const uint8_t* row = picture.Row(y + v) + x;
    int row_sum = 0;
    for (int u = -half_width; u <= half_width; ++u) {
      moment_x += u * row[u];
      row_sum += row[u];
    }
    moment_y += v * row_sum;
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

// Where the pattern's pixels lie in memory around a point, first and second of every test.
std::array<std::ptrdiff_t, 512> PatternOffsets(size_t stride) {
  std::array<std::ptrdiff_t, 512> offsets{};
  for (size_t bit = 0; bit < 256; ++bit) {
    const RBriefTest& test = RBriefPattern()[bit];
    const auto row = static_cast<std::ptrdiff_t>(stride);
    offsets[2 * bit] = test.first[1] * row + test.first[0];
    offsets[2 * bit + 1] = test.second[1] * row + test.second[0];
  }
  return offsets;
}

// `sample(i)`: the i-th of the pattern's 512 pixels.
template <typename Sample>
Descriptor Compare(const Sample& sample) {
  Descriptor descriptor{};
  for (size_t byte = 0; byte < descriptor.size(); ++byte) {
    unsigned bits = 0;
    for (size_t bit = 0; bit < 8; ++bit) {
      const size_t test = 8 * byte + bit;
      bits |= static_cast<unsigned>(sample(2 * test) < sample(2 * test + 1)) << bit;
    }
    descriptor[byte] = static_cast<uint8_t>(bits);
  }
  return descriptor;
}

Descriptor DescribeNearEdge(const Image<int16_t>& contrast, int x, int y) {
  return Compare([&](size_t i) {
    const RBriefTest& test = RBriefPattern()[i / 2];
    const auto& offset = i % 2 == 0 ? test.first : test.second;
    return contrast.At(std::clamp(x + offset[0], 0, contrast.width - 1),
                       std::clamp(y + offset[1], 0, contrast.height - 1));
  });
}

}  // namespace

std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points) {
  std::vector<Descriptor> descriptors;
  if (points->empty()) return descriptors;
  const Image<int16_t> contrast = LocalContrast(picture);
  const std::vector<int> half_widths = DiscHalfWidths();
  const std::array<std::ptrdiff_t, 512> offsets = PatternOffsets(contrast.Stride());
  descriptors.reserve(points->size());
  for (SeaPoint& point : *points) {
    const int x = static_cast<int>(point.x), y = static_cast<int>(point.y);
    point.orientation = CentroidOrientation(picture, x, y, half_widths);
    const bool is_inside = x >= kPatternRadius && y >= kPatternRadius &&
                           x + kPatternRadius < contrast.width &&
                           y + kPatternRadius < contrast.height;
    const int16_t* center = contrast.Row(y) + x;
    descriptors.push_back(is_inside ? Compare([&](size_t i) { return center[offsets[i]]; })
                                    : DescribeNearEdge(contrast, x, y));
  }
  return descriptors;
}

Descriptor TurnDescriptor(const Descriptor& descriptor, int turns) {
  const unsigned left = static_cast<unsigned>(turns) % kNumTurns;
  Descriptor turned;
  for (size_t word = 0; word < 8; ++word) {
    uint32_t bits = 0;  // bit k of the word is bit k % 8 of its byte k / 8
    for (size_t byte = 0; byte < 4; ++byte) {
      bits |= static_cast<uint32_t>(descriptor[4 * word + byte]) << (8 * byte);
    }
    bits = bits << left | bits >> ((kNumTurns - left) % kNumTurns);
    for (size_t byte = 0; byte < 4; ++byte) {
      turned[4 * word + byte] = static_cast<uint8_t>(bits >> (8 * byte));
    }
  }
  return turned;
}

std::vector<Descriptor> TurnDescriptors(const std::vector<Descriptor>& descriptors, int turns) {
  std::vector<Descriptor> turned;
  turned.reserve(descriptors.size());
  for (const Descriptor& descriptor : descriptors) {
    turned.push_back(TurnDescriptor(descriptor, turns));
  }
  return turned;
}

}  // namespace colmap_seapoint
