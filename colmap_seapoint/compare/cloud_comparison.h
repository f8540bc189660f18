// What is measured of two clouds in one frame. "One way" is from the points of one cloud (the
// source) to the nearest points of the other (the target).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

inline constexpr int kMaxDistances = 8;

// Written beside the figures, so that nobody has to guess.
inline constexpr const char* kPointsDefinition =
    "share of the points, each counted once, whose nearest point of the other cloud is no farther "
    "than d";
inline constexpr const char* kEth3dDefinition =
    "ETH3D (Schoeps et al. 2017): share of the points within d of the other cloud (<= d), first in "
    "each occupied voxel, then averaged over the voxels of two grids that are half a voxel apart; "
    "accuracy of the input's points, completeness of the reference's, f1 their harmonic mean. "
    "ETH3D's test of free and unseen space needs the scanners' places: without it every point of "
    "the input counts";
inline constexpr const char* kTanksAndTemplesDefinition =
    "Tanks and Temples (Knapitsch et al. 2017): both clouds reduced to one point a voxel of side "
    "d / 2, the mean of its points; precision is the share of the input's, recall of the "
    "reference's, that are nearer than d (< d) to the other cloud, f_score their harmonic mean";
inline constexpr const char* kDistanceDefinition =
    "from each point to the nearest one of the other cloud, exact up to max_distance; mean and rms "
    "are of the points within it, the median is of all points (null: it lies beyond)";
inline constexpr const char* kSpacingDefinition =
    "median distance from a point to the nearest other place of its own cloud; of a cloud of more "
    "than 16 tiles, in 16 of them, evenly spread";
inline constexpr const char* kAreaDefinition =
    "as seen along the smallest axis of both clouds together: occupied cells of side "
    "area_cell_size; far_area weighs each cell by the share of its points that are farther than d "
    "from the other cloud; points_per_cell is redundancy: points over occupied cells of side "
    "cell_size in the same view";

// What is measured one way at one distance.
struct DistanceShares {
  uint64_t num_within = 0;          // points with a distance <= d
  double voxel_share = 0;           // ETH3D: mean over the voxels
  uint64_t num_reduced = 0;         // Tanks and Temples: points after the reduction
  uint64_t num_reduced_within = 0;  // of these, nearer than d
  double far_area = 0;              // area of the source farther than d from the target, units^2
};

struct OneWay {
  uint64_t num_points = 0;
  double spacing = 0;           // kSpacingDefinition; 0 when the cloud is one place
  uint64_t num_in_spacing = 0;  // points that it was measured at
  uint64_t num_beyond = 0;      // farther than max_distance
  double mean = 0, rms = 0;     // NaN when every point is beyond
  double median = 0;            // infinite when beyond
  uint64_t num_voxels = 0;      // ETH3D, both grids
  uint64_t num_cells = 0, num_area_cells = 0;
  double area = 0;                 // units^2
  std::vector<DistanceShares> at;  // by distance
};

struct CloudComparison {
  std::vector<double> distances;        // ascending
  bool distances_from_spacing = false;  // 1, 2 and 4 times the reference's spacing
  double max_distance = 0;
  double voxel_size = 0;      // ETH3D
  double cell_size = 0;       // redundancy
  double area_cell_size = 0;  // areas
  OneWay input, reference;    // input: from its points to the reference; reference: the reverse
};

}  // namespace colmap_seapoint
