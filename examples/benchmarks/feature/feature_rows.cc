#include "examples/benchmarks/feature/feature_rows.h"

namespace colmap_seapoint {
namespace {

const RowColumns<FeatureRow>& Columns() {
  static const RowColumns<FeatureRow> kColumns = {
      {{"set", &FeatureRow::set},
       {"detector", &FeatureRow::detector},
       {"setting", &FeatureRow::setting},
       {"picture1", &FeatureRow::picture1},
       {"picture2", &FeatureRow::picture2}},
      {{"gap", &FeatureRow::gap},
       {"points1", &FeatureRow::points1},
       {"points2", &FeatureRow::points2},
       {"matches", &FeatureRow::matches},
       {"matched_share", &FeatureRow::matched_share},
       {"verified", &FeatureRow::verified},
       {"verified_share", &FeatureRow::verified_share},
       {"reliable_area", &FeatureRow::reliable_area},
       {"extract_cpu_s_1", &FeatureRow::extract_cpu1},
       {"extract_cpu_s_2", &FeatureRow::extract_cpu2},
       {"match_cpu_s", &FeatureRow::match_cpu},
       {"texture_limit", &FeatureRow::texture_limit},
       {"precision", &FeatureRow::precision},
       {"repeatability", &FeatureRow::repeatability},
       {"true_overlap", &FeatureRow::true_overlap},
       {"overlap_error", &FeatureRow::overlap_error},
       {"textured", &FeatureRow::textured},
       {"recall", &FeatureRow::recall},
       {"area_precision", &FeatureRow::area_precision}}};
  return kColumns;
}

}  // namespace

void WriteFeatureRows(const std::filesystem::path& path, const std::vector<FeatureRow>& rows) {
  WriteRows(path, Columns(), rows);
}

std::vector<FeatureRow> ReadFeatureRows(const std::filesystem::path& path) {
  return ReadRows(path, Columns());
}

}  // namespace colmap_seapoint
