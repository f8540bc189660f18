// The page of one model: what completeness_reporter found, with the pictures, the cloud and the
// track that tell where it is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/gaps/gap_places.h"
#include "colmap_seapoint/page/cloud_sample.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// Raise it whenever the same report gives another page.
inline constexpr char kPageVersion[] = "2";

struct CompletenessPageInput {
  const SparseModel& model;  // its cameras fit the pictures
  const CompletenessResult& result;
  const GapPlaces& places;
  std::string answer;                // CompletenessLine
  std::filesystem::path image_path;  // empty: no pictures of gaps
  std::filesystem::path cloud_path;  // pairs.csv and run.json beside it are shown where they are
  std::filesystem::path map_path;    // folder that orthomosaic wrote; empty: none
  std::vector<ColoredPoint> points;  // some of the cloud
  std::vector<double> brightness;    // by image_idx, TrackInput::brightness
  int num_threads = -1;
};

// HTML. Reads up to two pictures for each of the first gaps. Throws Error for a map, a pairs.csv or
// a run.json that is none of ours.
std::string CompletenessPage(const CompletenessPageInput& input);

}  // namespace colmap_seapoint
