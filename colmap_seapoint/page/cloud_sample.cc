#include "colmap_seapoint/page/cloud_sample.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr double kMaxCode = 65535;
constexpr double kStray = 0.001;  // of the points, at either end of an axis

void Put16(double value, std::vector<uint8_t>* bytes) {
  const auto code = static_cast<uint16_t>(std::lround(value));
  bytes->push_back(static_cast<uint8_t>(code & 255));
  bytes->push_back(static_cast<uint8_t>(code >> 8));
}

}  // namespace

PointChooser::PointChooser(uint64_t total, uint64_t wanted)
    : limit_(total <= wanted
                 ? uint64_t{1} << 32
                 : static_cast<uint64_t>(std::ldexp(1.0, 32) * static_cast<double>(wanted) /
                                         static_cast<double>(total))) {}

bool PointChooser::Takes(uint64_t index) const {
  uint64_t h = (index + 1) * 0x9e3779b97f4a7c15ULL;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  return (h >> 32) < limit_;
}

PackedCloud PackCloud(const std::vector<ColoredPoint>& points,
                      const Eigen::Matrix3d& map_from_world) {
  PackedCloud packed;
  if (points.empty()) return packed;
  std::vector<Eigen::Vector3d> places;
  places.reserve(points.size());
  for (const ColoredPoint& point : points) {
    places.emplace_back(map_from_world * point.xyz);
  }
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(places.size());
    for (const Eigen::Vector3d& place : places) values.push_back(place[axis]);
    packed.low[axis] = Quantile(values, kStray);
    high[axis] = Quantile(std::move(values), 1 - kStray);
  }
  packed.step = std::max((high - packed.low).maxCoeff() / kMaxCode, 1e-12);
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d& place = places[i];
    if ((place.array() < packed.low.array()).any() || (place.array() > high.array()).any()) {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      Put16(std::min((place[axis] - packed.low[axis]) / packed.step, kMaxCode), &packed.codes);
    }
    packed.colors.insert(packed.colors.end(), points[i].rgb.begin(), points[i].rgb.end());
  }
  return packed;
}

}  // namespace colmap_seapoint
