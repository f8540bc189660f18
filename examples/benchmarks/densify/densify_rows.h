// One row of the densification benchmark: a set of pictures and a variant. And its CSV form.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "examples/benchmarks/feature/row_csv.h"

namespace colmap_seapoint {

// Complete means the same selected pairs, each in full: what a partial variant is compared with.
struct DensifyVariant {
  const char* name;
  const char* mode;        // PartialDensification.mode
  const char* redundancy;  // PartialDensification.redundancy
  const char* baseline;    // variant that it is compared with, or null
};

inline constexpr DensifyVariant kDensifyVariants[] = {
    {"complete", "complete", "sequential", nullptr},
    {"sequential", "partial", "sequential", "complete"},
    {"complete_all", "complete", "all", nullptr},
    {"all", "partial", "all", "complete_all"},
};

// Throws UsageError for an unknown name.
const DensifyVariant& FindVariant(const std::string& name);

// Shares 0..1; kNotMeasured where nothing could be measured.
struct DensifyRow {
  std::string set, variant;
  double pictures = 0, megapixels = 0, threads = 0;
  double cpu = 0, wall = 0;                   // seconds, of densification alone
  double rectification = 0, propagation = 0;  // of it, wall seconds summed over the pairs
  double seapoint_cpu = kNotMeasured;  // to find and describe SeaPoints; in none of the above
  double match_cpu = 0;                // to match those that no database has; in none of the above
  double memory_mb = kNotMeasured;     // peak above what was held before (pictures in memory)
  double pairs = 0, completion_pairs = 0, passed_over = 0;
  double same_pairs = kNotMeasured;    // share of the baseline's pairs that it has too
  double pair_seconds = kNotMeasured;  // wall, median over pairs after the first
  double points = 0;
  double new_share = kNotMeasured;       // mean of 1 - overlap over pairs after the first
  double true_new_share = kNotMeasured;  // of all area that the pairs see, what none before saw
  double true_new_later = kNotMeasured;  // the same, mean over pairs after the first
  double seeds = 0;
  double seeds_kept = kNotMeasured;    // of the baseline's on the same pairs, after the first
  double seeds_failed = kNotMeasured;  // share of the seeds that did not spread
  double rea_share = kNotMeasured;     // share of SeaPoints labelled REA, pairs after the first
  double layers = kNotMeasured;        // pairs that gave points to a cell, mean over cells
  double kept_cover = kNotMeasured;    // share of the baseline's cloud that this one passes
  // Against a survey's truth.
  double within_1gsd = kNotMeasured, within_2gsd = kNotMeasured, within_4gsd = kNotMeasured;
  double median_gsd = kNotMeasured;
  double coverage_2gsd = kNotMeasured, coverage_4gsd = kNotMeasured;
  double points_per_cm2 = kNotMeasured, points_per_gsd2 = kNotMeasured;
  double redundancy = kNotMeasured;  // points in an occupied cell of 1 GSD
};

// The whole program (variant "program"): decoding, SeaPoints, densification, writing.
struct ProgramRow {
  std::string set, arguments;
  double pictures = 0, megapixels = 0, threads = 0;
  double cpu = 0, wall = 0, peak_rss_mb = 0;
  double decode_cpu = 0;      // of the same pictures once to colour with OpenCV
  double own_decode_cpu = 0;  // with the program's own reader
};

// Sparse points that were kept from the densifier, and the cloud it made.
struct HoldOutRow {
  std::string set, variant;
  double every = 0;
  double points = 0, held = 0, eligible = 0;
  double near = kNotMeasured;            // share of the eligible with a cloud point within 10 GSD
  double passed = kNotMeasured;          // share of the eligible with one within 3 GSD
  double passed_near = kNotMeasured;     // the same of the near ones
  double passed_spacing = kNotMeasured;  // within 3 spacings of samples, of the eligible
  double median_gsd = kNotMeasured;      // distance of the near ones
  double own_gsd = kNotMeasured;         // uncertainty of the points themselves in depth, median
  double passed_sure = kNotMeasured;     // share passed of those whose own is up to 1 GSD
  double cloud_points = 0;
};

void WriteDensifyRows(const std::filesystem::path& path, const std::vector<DensifyRow>& rows);
void WriteProgramRows(const std::filesystem::path& path, const std::vector<ProgramRow>& rows);
void WriteHoldOutRows(const std::filesystem::path& path, const std::vector<HoldOutRow>& rows);

// Throw Error for a missing file and for anything the functions above do not write.
std::vector<DensifyRow> ReadDensifyRows(const std::filesystem::path& path);
std::vector<ProgramRow> ReadProgramRows(const std::filesystem::path& path);
std::vector<HoldOutRow> ReadHoldOutRows(const std::filesystem::path& path);

}  // namespace colmap_seapoint
