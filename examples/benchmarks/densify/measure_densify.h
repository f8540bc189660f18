// Measures densification on one set of pictures: complete against partial (paper 3, Tables 2, 3).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "densify/partial_densification_options.h"
#include "examples/benchmarks/densify/densify_rows.h"

namespace colmap_seapoint {

// Where a set comes from. Empty paths are filled in from the survey's folder: its pictures, and its
// exact cameras as the model.
struct DensifySet {
  std::string name;
  std::filesystem::path image_path, input_path, survey_path;
  std::string database_path;  // SeaPoints; empty: they are found again
};

DensifySet WithPaths(DensifySet set);

struct DensifyMeasureOptions {
  DensifySet set;
  std::vector<std::string> variants;          // names, in this order
  PartialDensificationOptions densification;  // mode and redundancy are the variant's
  int num_repeats = 1;                        // of every timing; variants take turns; the median
  int num_threads = -1;
  std::filesystem::path debug_path;  // folder for every variant's cloud and pairs.csv, or empty
};

// One row a variant. Times are those of DensifySequence alone, on decoded pictures and known
// SeaPoints. Progress on stderr. Throws Error for unreadable input.
std::vector<DensifyRow> MeasureDensify(const DensifyMeasureOptions& options);

struct HoldOutOptions {
  DensifySet set;
  std::string variant = "all";
  PartialDensificationOptions densification;
  int every = 5;  // every so manieth sparse point is held out
  int num_threads = -1;
  std::filesystem::path debug_path;
};

// Densifies without a part of the model's sparse points, and looks for those in the cloud: held-out
// points are taken from the model, and SeaPoints within a pixel of where a picture saw them are
// forgotten. Eligible are those with three views or more and a reprojection error up to a pixel.
// GSD: depth in the point's first view over the focal length.
HoldOutRow MeasureHoldOut(const HoldOutOptions& options);

}  // namespace colmap_seapoint
