// Any bytes as picture, mask and options of the SeaPoint detector: every instruction set and number
// of threads must give what the definition gives, inside the border and the mask.
//
// Input: 12 bytes of sizes and options, the rest pixels (over again when there are too few).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "feature/detector/seapoint_detector.h"
#include "hwy/targets.h"
#include "tests/feature/detector/detector_oracle.h"
#include "tests/fuzz/require.h"

namespace colmap_seapoint {
namespace {

struct Case {
  GrayImage picture, mask;
  SeaPointExtractionOptions options;
  int border = 0;
  int num_threads = 1;
};

Case Parse(const uint8_t* data) {
  Case c;
  c.picture = GrayImage(1 + data[0] % 80, 1 + data[1] % 80);
  c.options.smoothing_sigma = data[2] % 41 / 10.0;
  c.options.window_size = 3 + 2 * (data[3] % 5);
  c.options.harris_k = data[4] % 26 / 100.0;
  c.options.nms_radius = 1 + data[5] % 20;
  c.options.min_num_features = 1 + data[6];
  c.options.max_num_features = c.options.min_num_features + data[7];
  c.options.light_balance = 0;  // the definition knows the paper's measures only
  c.border = data[8] % 40;
  c.num_threads = 1 + data[9] % 5;
  if (data[10] % 2 == 1) c.mask = GrayImage(c.picture.width, c.picture.height);
  return c;
}

void Fill(const uint8_t* data, size_t size, size_t from, GrayImage* image) {
  for (size_t i = 0; i < image->data.size() && size > 0; ++i) {
    image->data[i] = data[(from + i) % size];
  }
}

bool SameBytes(const std::vector<SeaPoint>& a, const std::vector<SeaPoint>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(SeaPoint)) == 0);
}

void RequireDefinition(const Case& c, const std::vector<SeaPoint>& points) {
  const HarrisOptions harris = {c.options.smoothing_sigma, c.options.window_size,
                                c.options.harris_k};
  const int border = std::max(c.border, HarrisBorder(harris) + 1);
  FUZZ_REQUIRE(static_cast<int>(points.size()) <= c.options.max_num_features);
  for (const SeaPoint& point : points) {
    FUZZ_REQUIRE(point.x >= border && point.x <= c.picture.width - border);
    FUZZ_REQUIRE(point.y >= border && point.y <= c.picture.height - border);
  }
  const std::vector<SeaPoint> expected = OracleDetect(c.picture, c.mask, c.options, border);
  FUZZ_REQUIRE(points.size() == expected.size());
  for (size_t i = 0; i < points.size(); ++i) {
    FUZZ_REQUIRE(std::abs(points[i].x - expected[i].x) <= 1e-3);
    FUZZ_REQUIRE(std::abs(points[i].y - expected[i].y) <= 1e-3);
  }
}

}  // namespace
}  // namespace colmap_seapoint

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace colmap_seapoint;  // NOLINT
  constexpr size_t kHeader = 12;
  if (size < kHeader) return 0;
  Case c = Parse(data);
  Fill(data + kHeader, size - kHeader, 0, &c.picture);
  Fill(data + kHeader, size - kHeader, c.picture.data.size() + data[11], &c.mask);

  const auto [points, summary] =
      DetectSeaPoints(c.picture, c.mask, c.options, c.border, c.num_threads);
  RequireDefinition(c, points);
  FUZZ_REQUIRE(static_cast<int>(points.size()) <= summary.num_local_maxima);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    FUZZ_REQUIRE(SameBytes(DetectSeaPoints(c.picture, c.mask, c.options, c.border).points, points));
  }
  hwy::SetSupportedTargetsForTest(0);
  return 0;
}
