#include "tests/feature/detector/detector_oracle.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace colmap_seapoint {

namespace {

// Gaussian weights in 256ths; what rounding leaves over goes to the middle.
std::vector<int> Taps(double sigma) {
  const int radius = sigma > 0 ? static_cast<int>(std::ceil(2.5 * sigma)) : 0;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    sum += sigma > 0 ? std::exp(-i * i / (2 * sigma * sigma)) : 1;
  }
  std::vector<int> taps;
  int total = 0;
  for (int i = -radius; i <= radius; ++i) {
    const double weight = sigma > 0 ? std::exp(-i * i / (2 * sigma * sigma)) : 1;
    taps.push_back(static_cast<int>(std::lround(256 * weight / sum)));
    total += taps.back();
  }
  taps[static_cast<size_t>(radius)] += 256 - total;
  return taps;
}

// Grey level times 16, smoothed.
int SmoothAt(const GrayImage& picture, const std::vector<int>& taps, int x, int y) {
  const int radius = static_cast<int>(taps.size()) / 2;
  int64_t sum = 0;
  for (int v = -radius; v <= radius; ++v) {
    for (int u = -radius; u <= radius; ++u) {
      sum += static_cast<int64_t>(taps[static_cast<size_t>(u + radius)]) *
             taps[static_cast<size_t>(v + radius)] * picture.At(x + u, y + v);
    }
  }
  return static_cast<int>((sum + 2048) / 4096);
}

SeaPoint TopOfQuadratic(const FloatImage& map, int x, int y) {
  auto at = [&](int dx, int dy) { return static_cast<double>(map.At(x + dx, y + dy)); };
  const Eigen::Vector2d gradient((at(1, 0) - at(-1, 0)) / 2, (at(0, 1) - at(0, -1)) / 2);
  Eigen::Matrix2d hessian;
  hessian(0, 0) = at(1, 0) + at(-1, 0) - 2 * at(0, 0);
  hessian(1, 1) = at(0, 1) + at(0, -1) - 2 * at(0, 0);
  hessian(0, 1) = hessian(1, 0) = (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1)) / 4;
  Eigen::Vector2d offset(0, 0);
  if (hessian.determinant() > 0 && hessian(0, 0) < 0) {
    offset = (-hessian.inverse() * gradient).cwiseMax(-0.5).cwiseMin(0.5);
  }
  SeaPoint point;
  point.x = static_cast<float>(x + 0.5 + offset.x());
  point.y = static_cast<float>(y + 0.5 + offset.y());
  return point;
}

float ThresholdIn(const std::vector<float>& values, double low, double high, int count_above,
                  float threshold_above, int min_count, int max_count) {
  std::vector<std::vector<float>> bins(256);
  for (const float value : values) {
    const int bin = static_cast<int>((value - low) / (high - low) * 256);
    bins[static_cast<size_t>(std::min(255, bin))].push_back(value);
  }
  for (int b = 255; b >= 0; --b) {
    const std::vector<float>& bin = bins[static_cast<size_t>(b)];
    if (bin.empty()) continue;
    const auto [smallest, largest] = std::minmax_element(bin.begin(), bin.end());
    const int sum = count_above + static_cast<int>(bin.size());
    if (sum > max_count) {
      if (*smallest == *largest) return threshold_above;
      return ThresholdIn(bin, *smallest, *largest, count_above, threshold_above, min_count,
                         max_count);
    }
    count_above = sum;
    threshold_above = *smallest;
    if (sum >= min_count) break;
  }
  return threshold_above;
}

}  // namespace

FloatImage OracleHarrisMeasure(const GrayImage& picture, const HarrisOptions& options) {
  const std::vector<int> taps = Taps(options.smoothing_sigma);
  const int smoothing = static_cast<int>(taps.size()) / 2, box = options.window_size / 2;
  const int border = smoothing + 1 + box;
  FloatImage map(picture.width, picture.height);
  Image<int> smooth(picture.width, picture.height);
  for (int y = smoothing; y < picture.height - smoothing; ++y) {
    for (int x = smoothing; x < picture.width - smoothing; ++x) {
      smooth.At(x, y) = SmoothAt(picture, taps, x, y);
    }
  }
  for (int y = border; y < picture.height - border; ++y) {
    for (int x = border; x < picture.width - border; ++x) {
      int64_t xx = 0, xy = 0, yy = 0;
      for (int v = y - box; v <= y + box; ++v) {
        for (int u = x - box; u <= x + box; ++u) {
          const int64_t gx = smooth.At(u + 1, v) - smooth.At(u - 1, v);
          const int64_t gy = smooth.At(u, v + 1) - smooth.At(u, v - 1);
          xx += gx * gx;
          xy += gx * gy;
          yy += gy * gy;
        }
      }
      const float a = static_cast<float>(xx) / 65536.0f, b = static_cast<float>(xy) / 65536.0f,
                  c = static_cast<float>(yy) / 65536.0f;
      const float det = a * c - b * b, trace = a + c;
      map.At(x, y) = det - static_cast<float>(options.k) * (trace * trace);
    }
  }
  return map;
}

float OracleThreshold(const std::vector<float>& measures, int min_count, int max_count) {
  return ThresholdIn(measures, 0, 255, 0, std::numeric_limits<float>::infinity(), min_count,
                     max_count);
}

LocalMaxima OracleLocalMaxima(const FloatImage& map, const GrayImage& mask, int radius,
                              int border) {
  LocalMaxima found;
  for (const float measure : map.data) {
    found.lowest = std::min(found.lowest, measure);
    found.highest = std::max(found.highest, measure);
  }
  for (int y = border; y < map.height - border; ++y) {
    for (int x = border; x < map.width - border; ++x) {
      bool first_of_greatest = map.At(x, y) > 0 && (mask.Empty() || mask.At(x, y) != 0);
      for (int v = y - radius; v <= y + radius; ++v) {
        for (int u = x - radius; u <= x + radius; ++u) {
          if (!map.Contains(u, v) || (u == x && v == y)) continue;
          const bool earlier = std::make_pair(v, u) < std::make_pair(y, x);
          if (map.At(u, v) > map.At(x, y) || (map.At(u, v) == map.At(x, y) && earlier)) {
            first_of_greatest = false;
          }
        }
      }
      if (!first_of_greatest) continue;
      LocalMaximum maximum;
      maximum.x = x;
      maximum.y = y;
      for (int i = 0; i < 9; ++i) maximum.around[i] = map.At(x + i % 3 - 1, y + i / 3 - 1);
      found.maxima.push_back(maximum);
    }
  }
  return found;
}

std::vector<SeaPoint> OracleDetect(const GrayImage& picture, const GrayImage& mask,
                                   const SeaPointExtractionOptions& options, int border) {
  const FloatImage map = OracleHarrisMeasure(
      picture, {options.smoothing_sigma, options.window_size, options.harris_k});
  const LocalMaxima found = OracleLocalMaxima(map, mask, options.nms_radius, border);
  std::vector<std::pair<float, const LocalMaximum*>> candidates;
  std::vector<float> measures;
  for (const LocalMaximum& maximum : found.maxima) {
    const double remapped = (static_cast<double>(maximum.measure()) - found.lowest) *
                            (255.0 / (static_cast<double>(found.highest) - found.lowest));
    measures.push_back(static_cast<float>(remapped));
    candidates.emplace_back(measures.back(), &maximum);
  }
  const float threshold =
      OracleThreshold(measures, options.min_num_features, options.max_num_features);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<SeaPoint> points;
  for (const auto& [measure, maximum] : candidates) {
    if (measure < threshold) break;
    points.push_back(TopOfQuadratic(map, maximum->x, maximum->y));
  }
  return points;
}

}  // namespace colmap_seapoint
