#include "colmap_seapoint/page/ground_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/gaps/gap_colors.h"
#include "colmap_seapoint/report/format_text.h"
#include "densify/completeness/judge_ground.h"

namespace colmap_seapoint {
namespace {

using Color = std::array<uint8_t, 3>;
using ColorOf = std::function<std::optional<Color>(const GroundCell&, int x, int y)>;

// Cells x0 .. x1, y0 .. y1; a pixel takes the middle one of step x step.
struct Extent {
  int x0 = std::numeric_limits<int>::max(), y0 = std::numeric_limits<int>::max();
  int x1 = std::numeric_limits<int>::min(), y1 = std::numeric_limits<int>::min();
  int step = 1, width = 0, height = 0;  // pixels
};

Extent ExtentOf(const GroundLayer& layer) {
  Extent extent;
  layer.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected) return;
    extent.x0 = std::min(extent.x0, x);
    extent.x1 = std::max(extent.x1, x);
    extent.y0 = std::min(extent.y0, y);
    extent.y1 = std::max(extent.y1, y);
  });
  if (extent.x0 > extent.x1) return extent;
  const int longer = std::max(extent.x1 - extent.x0, extent.y1 - extent.y0) + 1;
  extent.step = (longer + kGroundMapSide - 1) / kGroundMapSide;
  extent.width = (extent.x1 - extent.x0) / extent.step + 1;
  extent.height = (extent.y1 - extent.y0) / extent.step + 1;
  return extent;
}

Image<uint8_t> Draw(const GroundLayer& layer, const Extent& extent, const ColorOf& color_of) {
  Image<uint8_t> picture(extent.width, extent.height, 4);
  for (int b = 0; b < extent.height; ++b) {
    for (int a = 0; a < extent.width; ++a) {
      const int x = extent.x0 + a * extent.step + extent.step / 2;
      const int y = extent.y1 - b * extent.step - extent.step / 2;
      const GroundCell* cell = layer.cells.Find(x, y);
      if (cell == nullptr) continue;
      const std::optional<Color> color = color_of(*cell, x, y);
      if (!color) continue;
      uint8_t* pixel = &picture.At(a, b);
      std::copy(color->begin(), color->end(), pixel);
      pixel[3] = 255;
    }
  }
  return picture;
}

// Cividis (Nunez, Anderton and Renslow 2018) at nine places.
constexpr std::array<Color, 9> kRamp = {{{0, 32, 77},
                                         {0, 54, 111},
                                         {55, 76, 108},
                                         {87, 97, 110},
                                         {117, 119, 120},
                                         {148, 143, 120},
                                         {182, 168, 109},
                                         {219, 195, 88},
                                         {255, 234, 70}}};

Color RampColor(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (kRamp.size() - 1);
  const auto low = std::min(static_cast<size_t>(place), kRamp.size() - 2);
  Color color;
  for (size_t c = 0; c < 3; ++c) {
    const double t = place - static_cast<double>(low);
    color[c] = static_cast<uint8_t>(std::lround((1 - t) * kRamp[low][c] + t * kRamp[low + 1][c]));
  }
  return color;
}

std::string Hex(const Color& color) {
  return Format("#%02x%02x%02x", color[0], color[1], color[2]);
}

using ValueOf = std::function<std::optional<double>(const GroundCell&, int x, int y)>;

// The ends of a ramp over the values, apart.
std::pair<double, double> EndsOf(const GroundLayer& layer, const ValueOf& value_of) {
  std::vector<double> values;
  layer.cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (const std::optional<double> value = value_of(cell, x, y)) values.push_back(*value);
  });
  if (values.empty()) return {0, 1};
  const double low = Quantile(values, 0.02), high = Quantile(std::move(values), 0.98);
  return {low, high > low ? high : low + std::max(1e-9, std::abs(low) * 1e-3)};
}

struct RampKind {
  const char *key, *title, *note, *format;
  double factor;  // of what the legend shows
  std::string unit;
};

GroundMap DrawRamp(const GroundLayer& layer, const Extent& extent, const RampKind& kind,
                   const ValueOf& value_of) {
  const std::pair<double, double> ends = EndsOf(layer, value_of);
  const double span = ends.second - ends.first;
  GroundMap map = {kind.key, kind.title, kind.note, {}, {}};
  map.picture =
      Draw(layer, extent, [&](const GroundCell& cell, int x, int y) -> std::optional<Color> {
        const std::optional<double> value = value_of(cell, x, y);
        if (!value) return std::nullopt;
        return RampColor((*value - ends.first) / span);
      });
  for (int k = 0; k <= 4; ++k) {
    map.legend.push_back(
        {Hex(RampColor(0.25 * k)),
         Format(kind.format, kind.factor * (ends.first + 0.25 * k * span)) + kind.unit});
  }
  return map;
}

GroundMap DrawCauses(const GroundLayer& layer, const Extent& extent) {
  GroundMap map = {"causes",
                   "Why it is missing",
                   "Every cell that is not covered, also those of gaps too small to be listed.",
                   {},
                   {}};
  map.picture = Draw(layer, extent, [](const GroundCell& cell, int, int) -> std::optional<Color> {
    if (!cell.is_expected || cell.is_covered) return std::nullopt;
    return CauseColor(cell.cause);
  });
  return map;
}

GroundMap DrawCoverage(const GroundLayer& layer, const Extent& extent) {
  constexpr Color kCovered = {0, 114, 178}, kFromAfar = {86, 180, 233}, kThin = {240, 228, 66},
                  kMissing = {213, 94, 0};
  GroundMap map = {"coverage",
                   "What is covered",
                   "Blank: nothing was expected there.",
                   {},
                   {{Hex(kCovered), "covered"},
                    {Hex(kFromAfar), "covered as finely as far pictures can"},
                    {Hex(kThin), "almost: too few points"},
                    {Hex(kMissing), "not covered"}}};
  map.picture = Draw(layer, extent, [&](const GroundCell& cell, int, int) -> std::optional<Color> {
    if (!cell.is_expected) return std::nullopt;
    if (cell.is_covered) return cell.is_from_afar ? kFromAfar : kCovered;
    return cell.is_thin ? kThin : kMissing;
  });
  return map;
}

// What only a sample of the covered cells knows is shown by its block.
const GroundCell* SampleOf(const GroundLayer& layer, int x, int y) {
  const GroundCell* cell = layer.cells.Find(SampledCellOf(x), SampledCellOf(y));
  return cell != nullptr && cell->is_covered && cell->num_views > 0 ? cell : nullptr;
}

GroundMap DrawRelief(const GroundLayer& layer, const Extent& extent, double cell_side,
                     const std::string& unit) {
  const ValueOf height = [](const GroundCell& cell, int, int) -> std::optional<double> {
    if (cell.count == 0) return std::nullopt;
    return cell.height;
  };
  GroundMap map = DrawRamp(
      layer, extent,
      {"relief", "Relief", "Heights, in slanting light; blank: no points.", "%.3g", 1, " " + unit},
      height);
  for (int b = 0; b < extent.height; ++b) {
    for (int a = 0; a < extent.width; ++a) {
      const int x = extent.x0 + a * extent.step + extent.step / 2;
      const int y = extent.y1 - b * extent.step - extent.step / 2;
      const GroundCell* left = layer.cells.Find(x - 1, y + 1);
      const GroundCell* right = layer.cells.Find(x + 1, y - 1);
      if (left == nullptr || right == nullptr || left->count == 0 || right->count == 0) continue;
      const double slope = (right->height - left->height) / (2 * cell_side);
      const double light = std::clamp(1 + 0.7 * slope, 0.35, 1.3);
      uint8_t* pixel = &map.picture.At(a, b);
      for (int c = 0; c < 3; ++c) {
        pixel[c] = static_cast<uint8_t>(std::min(255.0, light * pixel[c]));
      }
    }
  }
  return map;
}

std::vector<GroundMap> DrawRamps(const GroundLayer& layer, const Extent& extent,
                                 const CompletenessResult& result, const std::string& unit) {
  std::vector<GroundMap> maps;
  const double cell_side = result.ground.cell_side;
  maps.push_back(
      DrawRamp(layer, extent,
               {"density", "Points", "Points on a square of the wanted spacing; one is asked for.",
                "%.2g", 1, ""},
               [&](const GroundCell& cell, int, int) -> std::optional<double> {
                 if (!cell.is_expected || cell.count == 0) return std::nullopt;
                 return cell.count / WantedPoints(cell.area, result.spacing);
               }));
  maps.push_back(DrawRamp(layer, extent,
                          {"views", "Pictures that see it",
                           "Usable pictures, of every fourth covered cell.", "%.0f", 1, ""},
                          [&](const GroundCell&, int x, int y) -> std::optional<double> {
                            const GroundCell* sample = SampleOf(layer, x, y);
                            if (sample == nullptr) return std::nullopt;
                            return sample->num_views;
                          }));
  maps.push_back(
      DrawRamp(layer, extent,
               {"parallax", "Parallax",
                "The largest angle between two pictures of a place; the more, the surer its depth.",
                "%.0f", 1, " degrees"},
               [&](const GroundCell&, int x, int y) -> std::optional<double> {
                 const GroundCell* sample = SampleOf(layer, x, y);
                 if (sample == nullptr) return std::nullopt;
                 return sample->parallax_deg;
               }));
  const bool is_metric = unit == "m";
  maps.push_back(DrawRamp(layer, extent,
                          {"detail", "Detail", "What a pixel of the nearest picture covers.",
                           "%.2g", is_metric ? 1000.0 : 1.0, is_metric ? " mm" : " " + unit},
                          [](const GroundCell& cell, int, int) -> std::optional<double> {
                            if (!cell.is_expected || !(cell.gsd > 0) || !std::isfinite(cell.gsd)) {
                              return std::nullopt;
                            }
                            return cell.gsd;
                          }));
  maps.push_back(DrawRelief(layer, extent, cell_side, unit));
  return maps;
}

}  // namespace

GroundMaps DrawGroundMaps(const CompletenessResult& result, const std::string& unit) {
  GroundMaps drawn;
  const auto place = result.ground.layers.find({Side::kTop, 0});
  if (place == result.ground.layers.end()) return drawn;
  const GroundLayer& layer = place->second;
  const Extent extent = ExtentOf(layer);
  if (extent.width == 0) return drawn;
  const double side = result.ground.cell_side;
  drawn.left = extent.x0 * side;
  drawn.top = (extent.y1 + 1) * side;
  drawn.right = drawn.left + extent.width * extent.step * side;
  drawn.bottom = drawn.top - extent.height * extent.step * side;
  drawn.maps.push_back(DrawCauses(layer, extent));
  drawn.maps.push_back(DrawCoverage(layer, extent));
  for (GroundMap& map : DrawRamps(layer, extent, result, unit))
    drawn.maps.push_back(std::move(map));
  return drawn;
}

}  // namespace colmap_seapoint
