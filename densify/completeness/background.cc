#include "densify/completeness/background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "densify/completeness/judge_ground.h"

namespace colmap_seapoint {
namespace {

constexpr double kBinRatio = 1.1;  // from one bin of GSD to the next
constexpr int kNumBins = 64;
constexpr int kFirstFar = 5;  // the bin of 1.5 times the survey's GSD
constexpr int kWindow = 3;    // bins that are looked at together
constexpr double kMostlyNothing = 0.5;
constexpr double kMinAreaShare = 0.005;  // of all, in a window: less tells nothing
constexpr double kFarForOne = 2;         // of the survey's GSD

struct Bin {
  double all = 0, covered = 0;  // units^2
  double Share() const { return all > 0 ? covered / all : 0; }
};

// By GSD: bin 0 holds all up to the survey's own.
std::array<Bin, kNumBins> CoverageByGsd(double survey_gsd, const GroundLayer& top) {
  std::array<Bin, kNumBins> bins;
  top.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected || !cell.has_pair) return;
    // Of the cells that were covered before their pictures were looked at, a sample has a GSD.
    const bool is_of_sample = cell.is_covered && !cell.is_from_afar;
    if (is_of_sample && !IsSampledCell(x, y)) return;
    const double at = std::ceil(std::log(cell.gsd / survey_gsd) / std::log(kBinRatio));
    Bin& bin = bins[static_cast<size_t>(std::clamp(at, 0.0, kNumBins - 1.0))];
    const double area = (is_of_sample ? kSampleCells * kSampleCells : 1) * double{cell.area};
    bin.all += area;
    bin.covered += cell.is_covered ? area : 0;
  });
  return bins;
}

}  // namespace

double LimitOfSight(double survey_gsd, const Ground& ground) {
  const auto top = ground.layers.find({Side::kTop, 0});
  if (top == ground.layers.end()) return std::numeric_limits<double>::infinity();
  const std::array<Bin, kNumBins> bins = CoverageByGsd(survey_gsd, top->second);
  double all = 0;
  for (const Bin& bin : bins) all += bin.all;
  for (int k = kFirstFar; k + kWindow <= kNumBins; ++k) {
    Bin window;
    for (int i = k; i < k + kWindow; ++i) {
      window.all += bins[static_cast<size_t>(i)].all;
      window.covered += bins[static_cast<size_t>(i)].covered;
    }
    if (window.all < kMinAreaShare * all) continue;
    if (window.Share() < kMostlyNothing * bins[0].Share()) {
      return survey_gsd * std::pow(kBinRatio, k - 1);
    }
  }
  return std::numeric_limits<double>::infinity();
}

void LeaveOutBackground(double survey_gsd, Ground* ground) {
  const double limit = LimitOfSight(survey_gsd, *ground);
  const double limit_for_one = std::min(limit, kFarForOne * survey_gsd);
  for (auto& [key, layer] : ground->layers) {
    layer.cells.ForEach([&](int, int, GroundCell& cell) {
      if (cell.is_covered && !cell.is_from_afar) return;
      if (cell.gsd > (cell.has_pair ? limit : limit_for_one)) cell.is_expected = false;
    });
  }
}

}  // namespace colmap_seapoint
