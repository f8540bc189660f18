// What automatic_reconstructor leaves in WORKSPACE/report, and says at its end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/run_report.h"

namespace colmap_seapoint {

struct ModelSummary {
  std::string name;                   // "0"
  std::filesystem::path path;         // the model that is densified: sparse/0 or sparse_scaled/0
  std::vector<std::string> pictures;  // registered
  RunReport densification;
  std::filesystem::path cloud_path;
  std::string cloud_hash;  // what is made of the cloud depends on it; empty: no cloud
  std::string units = "units arbitrary";  // or metres, and the frame
  std::string units_word = "arbitrary";
  std::string scaling_fingerprint;  // of all that the units depend on; empty: not scaled
  std::string completeness;         // one line: what the cloud covers; empty: not asked for
  std::string scaling;              // one line: how the scale came about; empty: not scaled
  std::filesystem::path map_path;   // folder; empty: no map
  std::string map;                  // one line: what it is like
};

// Plain words: pictures used and left out, models, clouds, times.
std::string SummaryText(const std::vector<ModelSummary>& models, const RunReport& report);

}  // namespace colmap_seapoint
