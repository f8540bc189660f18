#include "examples/benchmarks/densify/densify_rows.h"

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

const RowColumns<DensifyRow>& DensifyColumns() {
  using R = DensifyRow;
  static const RowColumns<R> kColumns = {{{"set", &R::set}, {"variant", &R::variant}},
                                         {{"pictures", &R::pictures},
                                          {"megapixels", &R::megapixels},
                                          {"threads", &R::threads},
                                          {"cpu_s", &R::cpu},
                                          {"wall_s", &R::wall},
                                          {"match_cpu_s", &R::match_cpu},
                                          {"rectification_s", &R::rectification},
                                          {"propagation_s", &R::propagation},
                                          {"seapoint_cpu_s", &R::seapoint_cpu},
                                          {"memory_mb", &R::memory_mb},
                                          {"pairs", &R::pairs},
                                          {"completion_pairs", &R::completion_pairs},
                                          {"passed_over", &R::passed_over},
                                          {"same_pairs", &R::same_pairs},
                                          {"pair_s", &R::pair_seconds},
                                          {"points", &R::points},
                                          {"new_share", &R::new_share},
                                          {"true_new_share", &R::true_new_share},
                                          {"true_new_later", &R::true_new_later},
                                          {"seeds", &R::seeds},
                                          {"seeds_kept", &R::seeds_kept},
                                          {"seeds_failed", &R::seeds_failed},
                                          {"rea_share", &R::rea_share},
                                          {"layers", &R::layers},
                                          {"kept_cover", &R::kept_cover},
                                          {"within_1gsd", &R::within_1gsd},
                                          {"within_2gsd", &R::within_2gsd},
                                          {"within_4gsd", &R::within_4gsd},
                                          {"median_gsd", &R::median_gsd},
                                          {"coverage_2gsd", &R::coverage_2gsd},
                                          {"coverage_4gsd", &R::coverage_4gsd},
                                          {"points_per_cm2", &R::points_per_cm2},
                                          {"points_per_gsd2", &R::points_per_gsd2},
                                          {"redundancy", &R::redundancy}}};
  return kColumns;
}

const RowColumns<ProgramRow>& ProgramColumns() {
  using R = ProgramRow;
  static const RowColumns<R> kColumns = {{{"set", &R::set}, {"arguments", &R::arguments}},
                                         {{"pictures", &R::pictures},
                                          {"megapixels", &R::megapixels},
                                          {"threads", &R::threads},
                                          {"cpu_s", &R::cpu},
                                          {"wall_s", &R::wall},
                                          {"peak_rss_mb", &R::peak_rss_mb},
                                          {"decode_cpu_s", &R::decode_cpu},
                                          {"own_decode_cpu_s", &R::own_decode_cpu}}};
  return kColumns;
}

const RowColumns<HoldOutRow>& HoldOutColumns() {
  using R = HoldOutRow;
  static const RowColumns<R> kColumns = {{{"set", &R::set}, {"variant", &R::variant}},
                                         {{"every", &R::every},
                                          {"points", &R::points},
                                          {"held", &R::held},
                                          {"eligible", &R::eligible},
                                          {"near", &R::near},
                                          {"passed", &R::passed},
                                          {"passed_near", &R::passed_near},
                                          {"passed_spacing", &R::passed_spacing},
                                          {"median_gsd", &R::median_gsd},
                                          {"own_gsd", &R::own_gsd},
                                          {"passed_sure", &R::passed_sure},
                                          {"cloud_points", &R::cloud_points}}};
  return kColumns;
}

}  // namespace

const DensifyVariant& FindVariant(const std::string& name) {
  std::string names;
  for (const DensifyVariant& variant : kDensifyVariants) {
    if (name == variant.name) return variant;
    names += std::string(names.empty() ? "" : ", ") + variant.name;
  }
  throw UsageError("'" + name + "' is no variant; there are " + names);
}

void WriteDensifyRows(const std::filesystem::path& path, const std::vector<DensifyRow>& rows) {
  WriteRows(path, DensifyColumns(), rows);
}

void WriteProgramRows(const std::filesystem::path& path, const std::vector<ProgramRow>& rows) {
  WriteRows(path, ProgramColumns(), rows);
}

void WriteHoldOutRows(const std::filesystem::path& path, const std::vector<HoldOutRow>& rows) {
  WriteRows(path, HoldOutColumns(), rows);
}

std::vector<DensifyRow> ReadDensifyRows(const std::filesystem::path& path) {
  return ReadRows(path, DensifyColumns());
}

std::vector<ProgramRow> ReadProgramRows(const std::filesystem::path& path) {
  return ReadRows(path, ProgramColumns());
}

std::vector<HoldOutRow> ReadHoldOutRows(const std::filesystem::path& path) {
  return ReadRows(path, HoldOutColumns());
}

}  // namespace colmap_seapoint
