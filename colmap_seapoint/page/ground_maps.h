// The ground from above, once for each thing that is known of its cells.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

struct LegendEntry {
  std::string color;  // "#rrggbb"
  std::string text;
};

struct GroundMap {
  std::string key, title;  // "views"; "Pictures that see it"
  std::string note;        // a sentence: what is shown, and what is left blank
  Image<uint8_t> picture;  // 4 channels; alpha 0 where nothing is known
  std::vector<LegendEntry> legend;
};

struct GroundMaps {
  double left = 0, top = 0, right = 0, bottom = 0;  // in the plan, units; of all pictures
  std::vector<GroundMap> maps;
};

inline constexpr int kGroundMapSide = 1200;  // pixels, at most

// Of the top layer: causes, coverage, density, views, parallax, detail, relief. A pixel is a cell,
// or the middle one of a block of cells where they are too many. Ramps are cividis', which the
// colour-blind see as others do; they reach from the 2nd to the 98th hundredth of what there is.
// Without maps where the layer has no expected cell. `unit`: "m" or "units".
GroundMaps DrawGroundMaps(const CompletenessResult& result, const std::string& unit);

}  // namespace colmap_seapoint
