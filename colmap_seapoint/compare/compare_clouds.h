// The spine of cloud_comparer: two clouds of any size in one frame, against each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/compare/cloud_comparison.h"
#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

// Lengths are in units of the clouds; where they are 0, the value in the comment is taken.
struct CompareOptions {
  // Ascending, positive, at most kMaxDistances; empty: 1, 2 and 4 times the reference's spacing.
  std::vector<double> distances;
  double max_distance = 0;      // 10 times the largest distance
  double voxel_size = 0;        // the smallest distance
  double cell_size = 0;         // the reference's spacing
  double area_cell_size = 0;    // 4 times the larger spacing of both
  int num_threads = -1;         // no more than 8 are used, for each takes memory
  double tile_points = 500000;  // of both clouds in a tile; never changes a count
};

// What is known before the first point is compared.
struct CompareSetup {
  CloudComparison comparison;  // its lengths and numbers of points
  PlanView view;
  bool input_fits_float = false, reference_fits_float = false;
};

struct CompareCallbacks {
  std::function<void(const std::string& stage, int64_t done, int64_t total)> progress;
  std::function<void(const CompareSetup& setup)> begin;
  // Optional: gets every point once, in an order that depends on the clouds only, with its squared
  // distance to the other cloud (kBeyond beyond max_distance).
  std::function<void(bool of_input, const PointVector& points, const std::vector<double>& squared)>
      difference;
};

// Both clouds are read twice, and sorted into temporary files in `temporary_folder`, of 12 bytes a
// point (24 where float would round) and 8 more for its distance. Memory: some 100 MB a thread,
// whatever the size of the clouds. Counts and distances are those of comparing every point with
// every other one in double precision; the same bytes come out for any number of threads, and
// exchanging the clouds exchanges input and reference exactly (but for lengths left to be chosen).
// About 3 CPU seconds a million points of either cloud. Throws Error as SurveyCloud does, and when
// no distances are given and the reference has no spacing.
CloudComparison CompareClouds(const std::filesystem::path& input,
                              const std::filesystem::path& reference,
                              const std::filesystem::path& temporary_folder,
                              const CompareOptions& options, const CompareCallbacks& callbacks);

}  // namespace colmap_seapoint
