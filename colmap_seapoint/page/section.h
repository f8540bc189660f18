// What the page shows of one model, as JSON.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/gaps/gap_places.h"
#include "colmap_seapoint/page/cloud_sample.h"
#include "colmap_seapoint/page/gap_pictures.h"
#include "colmap_seapoint/page/ground_maps.h"
#include "colmap_seapoint/page/mosaic.h"
#include "colmap_seapoint/page/pair_rows.h"
#include "colmap_seapoint/page/track.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

struct SectionInput {
  const SparseModel* model = nullptr;
  const CompletenessResult* result = nullptr;
  const GapPlaces* places = nullptr;
  std::string answer;  // CompletenessLine
  GroundMaps maps;
  std::optional<Mosaic> mosaic;
  std::vector<std::vector<GapPicture>> gap_pictures;       // by position in result->gaps
  std::vector<std::pair<std::string, ColorImage>> layers;  // of walls and undersides, by name
  PackedCloud cloud;
  std::vector<TrackPicture> track;
  std::vector<TrackHint> hints;
  std::vector<PairRow> pairs;
};

// One line. All places are in the plan of the map (right, ahead, up; units), rounded to a hundredth
// of a cell; pictures are data: URIs. web/section.js reads it.
std::string SectionJson(const SectionInput& input);

}  // namespace colmap_seapoint
