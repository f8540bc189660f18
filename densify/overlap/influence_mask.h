// Influence areas around matched SeaPoints, the overlap mask and the labels (paper 2.5, 2.7).
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "densify/match/cell_grid.h"

namespace colmap_seapoint {

enum class SeaPointLabel : uint8_t {
  kNA,   // new area
  kOA,   // overlap area: already reconstructed
  kREA,  // re-evaluation area: seen before, but its seeds failed to spread
  kPA,   // processed area
};

// The mask on the candidate picture: 1 in the cells that belong to the overlap with the previous
// pair's first picture.
struct InfluenceMask {
  CellGrid grid;
  std::vector<uint8_t> marked;
  double OverlapRate() const;  // share of the picture's cells, 0..1
};

// What is known of the previous pair's first picture once that pair is densified.
struct ProcessedPicture {
  std::vector<SeaPoint> points;
  std::vector<SeaPointLabel> labels;  // PA / REA, of the points
  CellGrid grid;
  std::vector<float> filled;  // share of each cell that is reconstructed, by whichever pair
};

// `matches`: interpair matches, idx1 in the previous first picture, idx2 in the candidate. Areas
// around PA matches are marked; then areas around REA matches are erased. `radius`: of an influence
// area, pixels. Ours: an area ends where, carried back along its match, it leaves what is filled;
// the paper's whole discs (those of an empty `filled`) close strips beyond the previous picture's
// rim that no pair has seen.
InfluenceMask MakeInfluenceMask(const CellGrid& grid, const std::vector<SeaPoint>& candidate_points,
                                const FeatureMatches& matches, const ProcessedPicture& previous,
                                double radius);

// Labels of the candidate's SeaPoints: OA in the mask, REA near an erasing match, NA elsewhere.
std::vector<SeaPointLabel> LabelSeaPoints(const InfluenceMask& mask,
                                          const std::vector<SeaPoint>& candidate_points,
                                          const FeatureMatches& matches,
                                          const std::vector<SeaPointLabel>& previous_labels,
                                          double radius);

// After densification (paper 2.7): REA for the SeaPoints whose surroundings (radius in pixels) hold
// too little disparity, `filled` being the share of each cell's samples that matched; else PA.
std::vector<SeaPointLabel> RelabelProcessed(const CellGrid& grid, const std::vector<float>& filled,
                                            const std::vector<SeaPoint>& points, double radius);

}  // namespace colmap_seapoint
