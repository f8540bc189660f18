#include "densify/completeness/survey_limits.h"

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
constexpr double kUpperQuartile = 0.75;
constexpr double kAsUsual = 0.9, kOfQuartile = 0.25;
constexpr int kTextureReach = 2;  // of the textures that are looked at together
constexpr double kFew = 0.002;    // of all

struct Bin {
  double all = 0, covered = 0;  // units^2
  double Share() const { return all > 0 ? covered / all : 0; }
};

// What two pictures see from two sides: visit(cell, area that it stands for).
template <typename Visitor>
void ForEachPairCell(const GroundLayer& layer, const Visitor& visit) {
  layer.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected || !cell.has_pair) return;
    // Of the cells that were covered before their pictures were looked at, these are known of a
    // sample.
    const bool is_of_sample = cell.is_covered && !cell.is_from_afar;
    if (is_of_sample && !IsSampledCell(x, y)) return;
    visit(cell, (is_of_sample ? kSampleCells * kSampleCells : 1) * double{cell.area});
  });
}

// By GSD: bin 0 holds all up to the survey's own.
std::array<Bin, kNumBins> CoverageByGsd(double survey_gsd, const GroundLayer& top) {
  std::array<Bin, kNumBins> bins;
  ForEachPairCell(top, [&](const GroundCell& cell, double area) {
    const double at = std::ceil(std::log(cell.gsd / survey_gsd) / std::log(kBinRatio));
    Bin& bin = bins[static_cast<size_t>(std::clamp(at, 0.0, kNumBins - 1.0))];
    bin.all += area;
    bin.covered += cell.is_covered ? area : 0;
  });
  return bins;
}

using TextureBins = std::array<Bin, 255>;

TextureBins CoverageByTexture(const GroundLayer& top) {
  TextureBins bins;
  ForEachPairCell(top, [&](const GroundCell& cell, double area) {
    if (cell.texture >= bins.size()) return;
    Bin& bin = bins[cell.texture];
    bin.all += area;
    bin.covered += cell.is_covered ? area : 0;
  });
  return bins;
}

template <typename Bins>
Bin Sum(const Bins& bins, int from, int to) {
  Bin sum;
  for (int k = std::max(0, from); k < std::min(to, static_cast<int>(bins.size())); ++k) {
    sum.all += bins[static_cast<size_t>(k)].all;
    sum.covered += bins[static_cast<size_t>(k)].covered;
  }
  return sum;
}

int UpperQuartile(const TextureBins& bins) {
  const double covered = Sum(bins, 0, static_cast<int>(bins.size())).covered;
  double below = 0;
  for (size_t t = 0; t < bins.size(); ++t) {
    below += bins[t].covered;
    if (below > kUpperQuartile * covered) return static_cast<int>(t);
  }
  return 0;
}

}  // namespace

double LimitOfSight(double survey_gsd, const Ground& ground) {
  const auto top = ground.layers.find({Side::kTop, 0});
  if (top == ground.layers.end()) return std::numeric_limits<double>::infinity();
  const std::array<Bin, kNumBins> bins = CoverageByGsd(survey_gsd, top->second);
  const double all = Sum(bins, 0, kNumBins).all;
  for (int k = kFirstFar; k + kWindow <= kNumBins; ++k) {
    const Bin window = Sum(bins, k, k + kWindow);
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

double ReliableTexture(const Ground& ground) {
  const auto top = ground.layers.find({Side::kTop, 0});
  if (top == ground.layers.end()) return 0;
  const TextureBins bins = CoverageByTexture(top->second);
  const int num_bins = static_cast<int>(bins.size());
  const double all = Sum(bins, 0, num_bins).all;
  const int quartile = UpperQuartile(bins);
  const double usual = Sum(bins, quartile, num_bins).Share();
  int reliable = quartile;
  for (; reliable > 0; --reliable) {
    const Bin about = Sum(bins, reliable - 1 - kTextureReach, reliable + kTextureReach);
    if (about.all > kFew * all && about.Share() < kAsUsual * usual) break;
  }
  return std::max<double>(reliable, kOfQuartile * quartile);
}

void TellWhatLacksTexture(Ground* ground) {
  const double reliable = ReliableTexture(*ground);
  for (auto& [key, layer] : ground->layers) {
    layer.cells.ForEach([&](int, int, GroundCell& cell) {
      if (cell.cause == GapCause::kViewsDisagree && cell.texture < reliable) {
        cell.cause = GapCause::kNoTexture;
      }
    });
  }
}

}  // namespace colmap_seapoint
