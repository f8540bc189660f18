#include "feature/descriptor/rbrief_descriptor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "feature/descriptor/local_contrast.h"
#include "feature/descriptor/rbrief_pattern.h"

namespace colmap_seapoint {

namespace {

constexpr int kCentroidRadius = 15;

// The half widths of the disc's rows. They are rounded down, which gives exactly the pixels with
// x^2 + y^2 <= radius^2. Rounded to nearest, columns are cut otherwise than rows, and quarter turns
// of a picture turn the orientation by up to 7 degrees more or less.
std::vector<int> DiscHalfWidths() {
  std::vector<int> half_widths;
  for (int y = 0; y <= kCentroidRadius; ++y) {
    half_widths.push_back(static_cast<int>(
        std::sqrt(static_cast<double>(kCentroidRadius * kCentroidRadius - y * y))));
  }
  return half_widths;
}

float CentroidOrientation(const Image<int16_t>& contrast, int x, int y,
                          const std::vector<int>& half_widths) {
  int moment_x = 0, moment_y = 0;
  for (int v = -kCentroidRadius; v <= kCentroidRadius; ++v) {
    const int half_width = half_widths[static_cast<size_t>(std::abs(v))];
    const int16_t* row = contrast.Row(y + v) + x;
    int row_sum = 0;
    for (int u = -half_width; u <= half_width; ++u) {
      moment_x += u * row[u];
      row_sum += row[u];
    }
    moment_y += v * row_sum;
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

// One of the two scales: its local contrast and where its tests' pixels lie around a point.
class TestScale {
 public:
  TestScale(const GrayImage& picture, int reduction, size_t first_test)
      : reduction_(static_cast<float>(reduction)),
        first_test_(first_test),
        contrast_(LocalContrast(picture)) {
    const auto row = static_cast<std::ptrdiff_t>(contrast_.Stride());
    for (size_t i = 0; i < offsets_.size(); ++i) {
      const std::array<int8_t, 2>& offset = Offset(i);
      offsets_[i] = offset[1] * row + offset[0];
    }
  }

  const Image<int16_t>& Contrast() const { return contrast_; }
  // The point's pixel at this scale.
  int X(const SeaPoint& point) const { return Pixel(point.x, contrast_.width); }
  int Y(const SeaPoint& point) const { return Pixel(point.y, contrast_.height); }

  // 16 bytes of the descriptor.
  void Describe(const SeaPoint& point, uint8_t* bytes) const {
    const int x = X(point), y = Y(point);
    const int16_t* center = contrast_.Row(y) + x;
    if (x >= kPatternRadius && y >= kPatternRadius && x + kPatternRadius < contrast_.width &&
        y + kPatternRadius < contrast_.height) {
      Compare([&](size_t i) { return center[offsets_[i]]; }, bytes);
    } else {
      Compare(
          [&](size_t i) {
            const std::array<int8_t, 2>& offset = Offset(i);
            return contrast_.At(std::clamp(x + offset[0], 0, contrast_.width - 1),
                                std::clamp(y + offset[1], 0, contrast_.height - 1));
          },
          bytes);
    }
  }

 private:
  static constexpr size_t kNumTests = kFirstCoarseTest;

  const std::array<int8_t, 2>& Offset(size_t i) const {
    const RBriefTest& test = RBriefPattern()[first_test_ + i / 2];
    return i % 2 == 0 ? test.first : test.second;
  }
  int Pixel(float coordinate, int size) const {
    return std::min(static_cast<int>(coordinate / reduction_), size - 1);
  }
  // `sample(2 t)` and `sample(2 t + 1)`: what test t compares.
  template <typename Sample>
  static void Compare(const Sample& sample, uint8_t* bytes) {
    for (size_t byte = 0; byte < kNumTests / 8; ++byte) {
      unsigned bits = 0;
      for (size_t bit = 0; bit < 8; ++bit) {
        const size_t test = 8 * byte + bit;
        bits |= static_cast<unsigned>(sample(2 * test) < sample(2 * test + 1)) << bit;
      }
      bytes[byte] = static_cast<uint8_t>(bits);
    }
  }

  const float reduction_;
  const size_t first_test_;
  const Image<int16_t> contrast_;
  std::array<std::ptrdiff_t, 2 * kNumTests> offsets_{};
};

}  // namespace

int DescriptionReduction(const GrayImage& picture) {
  constexpr int64_t kMaxArea = 4000000;
  int reduction = 1;
  while (int64_t{picture.width} * picture.height / reduction / reduction > kMaxArea) reduction *= 2;
  return reduction;
}

std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points) {
  if (points->empty()) return {};
  const int reduction = DescriptionReduction(picture);
  GrayImage reduced;
  for (int r = 1; r < reduction; r *= 2) reduced = HalfSize(r == 1 ? picture : reduced);
  const GrayImage& described = reduction == 1 ? picture : reduced;
  const TestScale fine(described, reduction, 0);
  const TestScale coarse(HalfSize(described), 2 * reduction, kFirstCoarseTest);

  const std::vector<int> half_widths = DiscHalfWidths();
  std::vector<Descriptor> descriptors(points->size());
  for (size_t i = 0; i < points->size(); ++i) {
    SeaPoint& point = (*points)[i];
    point.orientation =
        CentroidOrientation(fine.Contrast(), fine.X(point), fine.Y(point), half_widths);
    fine.Describe(point, descriptors[i].data());
    coarse.Describe(point, descriptors[i].data() + kFirstCoarseTest / 8);
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
