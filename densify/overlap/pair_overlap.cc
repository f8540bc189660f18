#include "densify/overlap/pair_overlap.h"

#include <utility>

namespace colmap_seapoint {

PairOverlap WithoutPrevious(const CellGrid& cells, const std::vector<SeaPoint>& points) {
  PairOverlap overlap;
  overlap.known.grid = cells;
  overlap.labels.assign(points.size(), SeaPointLabel::kNA);
  return overlap;
}

PairOverlap OverlapWithPrevious(InfluenceMask mask, const std::vector<SeaPoint>& points,
                                const FeatureMatches& matches, const ProcessedPicture& previous,
                                double radius) {
  PairOverlap overlap;
  overlap.labels = LabelSeaPoints(mask, points, matches, previous.labels, radius);
  overlap.rate = mask.OverlapRate();
  overlap.known = {mask.grid, mask.marked, {}, {}};
  overlap.mask = std::move(mask);
  return overlap;
}

PairOverlap OverlapWithAll(PairOverlap overlap, const ViewCoverage& coverage,
                           const std::vector<SeaPoint>& points) {
  for (size_t i = 0; i < overlap.labels.size(); ++i) {
    SeaPointLabel& label = overlap.labels[i];
    if (coverage.range[coverage.grid.IndexOf(points[i].x, points[i].y)] > 0) {
      label = SeaPointLabel::kOA;
    } else if (label == SeaPointLabel::kOA) {
      label = SeaPointLabel::kREA;
    }
  }
  overlap.rate = coverage.CoveredShare();
  overlap.known = {coverage.grid, {}, coverage.range, coverage.far};
  return overlap;
}

}  // namespace colmap_seapoint
