// pairs.csv read back, for the page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct PairRow {
  std::string image1, image2;
  double overlap = 0;  // with what came before, 0..1
  double num_points = 0;
  std::string skipped;  // why; empty: it was densified
};

// In the order of the file; empty where there is none. Throws Error for a table without the columns
// of WritePairsCsv.
std::vector<PairRow> ReadPairRows(const std::filesystem::path& path);

}  // namespace colmap_seapoint
