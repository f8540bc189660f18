#include "examples/benchmarks/densify/densify_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace colmap_seapoint {
namespace {

constexpr char kDefinitions[] = R"(# Complete against partial densification

Variants: `sequential` reconstructs only what the previous pair has not
(`--PartialDensification.redundancy sequential`, the paper's setting), `complete` the same pairs,
each in full. `all` leaves out what any earlier pair has reconstructed and adds the completion pass,
`complete_all` is its complete form. Ratios: partial over complete. Shares are in percent.

- CPU: user + sys seconds of densification alone; pictures are decoded, SeaPoints found, described
  and matched beforehand (columns of their own), as they are in the chain's database. Wall: of the
  same. A pair: wall, median over the pairs after the first.
- truly new: of the area that the pairs see, the share that the previous pair (`all`: any earlier
  pair) did not see, by the survey's truth; over all pairs: the floor of the CPU ratio. In brackets:
  mean over the pairs after the first. 1 - overlap: as the program estimates it, after the first.
- seeds kept: of complete's seeds on the same pairs, after the first. Failed: share of seeds that did
  not spread. REA: share of SeaPoints labelled to be tried again.
- layers: pairs that gave points to an occupied cube of 3 sample spacings, mean; 1 = no redundancy.
  Redundancy: points in an occupied square of 1 GSD (ground sampling distance), mean.
- coverage: share of the surface seen by two pictures that has a point within 2 or 4 GSD. Cover kept:
  share of complete's points that have a point of the partial cloud within 2 sample spacings.
- held-out points: every fifth point of the model is kept from the densifier, with the SeaPoints there;
  looked for are those with three views and a reprojection error up to a pixel. GSD: depth in the first
  view over focal length. A point's own uncertainty: its reprojection error over the tangent of its
  largest parallax; median. Sure ones: own uncertainty up to 1 GSD.
- memory: peak during densification above what was held before, cloud not counted.

)";

std::string Text(double value, const char* format) {
  if (std::isnan(value)) return "–";
  char text[32];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string Percent(double share) { return Text(100 * share, "%.1f"); }

std::string Line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  return line + "\n";
}

std::string Head(const std::string& title, const std::vector<std::string>& columns) {
  std::string rule = "|";
  for (size_t i = 0; i < columns.size(); ++i) rule += "---|";
  return "## " + title + "\n\n" + Line(columns) + rule + "\n";
}

const DensifyRow* Find(const std::vector<DensifyRow>& rows, const std::string& set,
                       const std::string& variant) {
  for (const DensifyRow& row : rows) {
    if (row.set == set && row.variant == variant) return &row;
  }
  return nullptr;
}

const DensifyRow* BaselineOf(const std::vector<DensifyRow>& rows, const DensifyRow& row) {
  const char* name = FindVariant(row.variant).baseline;
  return name == nullptr ? nullptr : Find(rows, row.set, name);
}

double Ratio(const std::vector<DensifyRow>& rows, const DensifyRow& row,
             double DensifyRow::*field) {
  const DensifyRow* baseline = BaselineOf(rows, row);
  return baseline == nullptr || baseline->*field == 0 ? kNotMeasured
                                                      : row.*field / baseline->*field;
}

// Table 2: one local cloud.
std::string PairTable(const std::vector<DensifyRow>& rows) {
  std::string table = Head("A local cloud (paper: Table 2)",
                           {"set", "partial variant", "complete, s a pair", "partial, s a pair",
                            "ratio", "complete, points/cm²", "partial, points/cm²", "ratio"});
  for (const DensifyRow& row : rows) {
    const DensifyRow* baseline = BaselineOf(rows, row);
    if (baseline == nullptr) continue;
    table += Line({row.set, row.variant, Text(baseline->pair_seconds, "%.3f"),
                   Text(row.pair_seconds, "%.3f"),
                   Text(Ratio(rows, row, &DensifyRow::pair_seconds), "%.2f"),
                   Text(baseline->points_per_cm2, "%.1f"), Text(row.points_per_cm2, "%.1f"),
                   Text(Ratio(rows, row, &DensifyRow::points_per_cm2), "%.2f")});
  }
  return table;
}

// The incremental rows of Table 3.
std::string SetTable(const std::vector<DensifyRow>& rows) {
  std::string table =
      Head("The whole set (paper: Table 3, incremental)",
           {"set", "variant", "pictures", "MP", "pairs", "CPU s", "ratio", "wall s", "ratio",
            "CPU s/MP", "points", "ratio", "layers", "redundancy", "cover kept"});
  for (const DensifyRow& row : rows) {
    table += Line({row.set, row.variant, Text(row.pictures, "%.0f"), Text(row.megapixels, "%.1f"),
                   Text(row.pairs - row.completion_pairs, "%.0f") +
                       (row.completion_pairs > 0 ? " + " + Text(row.completion_pairs, "%.0f") : ""),
                   Text(row.cpu, "%.2f"), Text(Ratio(rows, row, &DensifyRow::cpu), "%.3f"),
                   Text(row.wall, "%.2f"), Text(Ratio(rows, row, &DensifyRow::wall), "%.3f"),
                   Text(row.cpu / row.megapixels, "%.4f"), Text(row.points, "%.0f"),
                   Text(Ratio(rows, row, &DensifyRow::points), "%.3f"), Text(row.layers, "%.2f"),
                   Text(row.redundancy, "%.3f"), Percent(row.kept_cover)});
  }
  return table;
}

std::string StatisticsTable(const std::vector<DensifyRow>& rows) {
  std::string table =
      Head("Where the saving comes from",
           {"set", "variant", "CPU ratio", "truly new", "CPU ratio over truly new", "1 - overlap",
            "passed over", "same pairs", "seeds kept", "failed", "REA"});
  for (const DensifyRow& row : rows) {
    if (BaselineOf(rows, row) == nullptr) continue;
    const double ratio = Ratio(rows, row, &DensifyRow::cpu);
    table += Line({row.set, row.variant, Text(ratio, "%.3f"),
                   Percent(row.true_new_share) + " (" + Percent(row.true_new_later) + ")",
                   Text(ratio / row.true_new_share, "%.2f"), Percent(row.new_share),
                   Text(row.passed_over, "%.0f"), Percent(row.same_pairs), Percent(row.seeds_kept),
                   Percent(row.seeds_failed), Percent(row.rea_share)});
  }
  return table;
}

std::string TruthTable(const std::vector<DensifyRow>& rows) {
  std::string lines;
  for (const DensifyRow& row : rows) {
    if (std::isnan(row.within_1gsd)) continue;
    lines +=
        Line({row.set, row.variant, Percent(row.within_1gsd), Text(100 * row.within_2gsd, "%.2f"),
              Text(100 * row.within_4gsd, "%.2f"), Text(row.median_gsd, "%.3f"),
              Percent(row.coverage_2gsd), Text(100 * row.coverage_4gsd, "%.2f"),
              Text(Ratio(rows, row, &DensifyRow::coverage_4gsd), "%.4f"),
              Text(row.points_per_gsd2, "%.3f")});
  }
  if (lines.empty()) return "";
  return Head("Against the truth",
              {"set", "variant", "within 1 GSD", "within 2", "within 4", "median GSD",
               "coverage 2 GSD", "coverage 4 GSD", "ratio", "points/GSD²"}) +
         lines + "\n";
}

std::string StageTable(const std::vector<DensifyRow>& rows) {
  std::string table = Head("Stages", {"set", "variant", "CPU s", "rectification, s",
                                      "propagation, s", "SeaPoints, CPU s (not in CPU s)",
                                      "matching, CPU s (not in CPU s)", "memory, MB", "threads"});
  for (const DensifyRow& row : rows) {
    table +=
        Line({row.set, row.variant, Text(row.cpu, "%.2f"), Text(row.rectification, "%.2f"),
              Text(row.propagation, "%.2f"), Text(row.seapoint_cpu, "%.2f"),
              Text(row.match_cpu, "%.2f"), Text(row.memory_mb, "%.0f"), Text(row.threads, "%.0f")});
  }
  return table;
}

std::string HoldOutTable(const std::vector<HoldOutRow>& rows) {
  std::string table =
      Head("Held-out sparse points",
           {"set", "variant", "points", "held out", "of them 3 views, 1 px", "passed within 3 GSD",
            "within 3 sample spacings", "any point within 10 GSD", "of those, within 3 GSD",
            "median GSD", "own uncertainty in depth, GSD", "of the sure ones, within 3 GSD"});
  for (const HoldOutRow& row : rows) {
    table += Line({row.set, row.variant, Text(row.points, "%.0f"), Text(row.held, "%.0f"),
                   Text(row.eligible, "%.0f"), Percent(row.passed), Percent(row.passed_spacing),
                   Percent(row.near), Percent(row.passed_near), Text(row.median_gsd, "%.2f"),
                   Text(row.own_gsd, "%.2f"), Percent(row.passed_sure)});
  }
  return table;
}

std::string ProgramTable(const std::vector<ProgramRow>& rows) {
  std::string table =
      Head("The whole program against decoding",
           {"set", "pictures", "MP", "CPU s", "wall s", "OpenCV decoding, CPU s", "ratio",
            "own decoding, CPU s", "CPU s/MP", "peak memory, MB", "options"});
  for (const ProgramRow& row : rows) {
    table += Line({row.set, Text(row.pictures, "%.0f"), Text(row.megapixels, "%.1f"),
                   Text(row.cpu, "%.2f"), Text(row.wall, "%.2f"), Text(row.decode_cpu, "%.2f"),
                   Text(row.cpu / row.decode_cpu, "%.2f"), Text(row.own_decode_cpu, "%.2f"),
                   Text(row.cpu / row.megapixels, "%.4f"), Text(row.peak_rss_mb, "%.0f"),
                   row.arguments.empty() ? "default" : row.arguments});
  }
  return table;
}

}  // namespace

std::string DensifyDefinitions() { return kDefinitions; }

std::string DensifyTables(const DensifyResults& results) {
  std::string text;
  const std::vector<DensifyRow>& rows = results.rows;
  if (!rows.empty()) {
    text += SetTable(rows) + "\n";
    const bool compared = std::any_of(rows.begin(), rows.end(), [&](const DensifyRow& row) {
      return BaselineOf(rows, row) != nullptr;
    });
    if (compared) text += PairTable(rows) + "\n" + StatisticsTable(rows) + "\n";
    text += TruthTable(rows) + StageTable(rows) + "\n";
  }
  if (!results.hold_outs.empty()) text += HoldOutTable(results.hold_outs) + "\n";
  if (!results.programs.empty()) text += ProgramTable(results.programs) + "\n";
  return text;
}

std::string DensifyPlotData(const std::vector<DensifyRow>& rows) {
  std::vector<std::string> sets;
  for (const DensifyRow& row : rows) {
    if (std::find(sets.begin(), sets.end(), row.set) == sets.end()) sets.push_back(row.set);
  }
  std::string text = "set";
  for (const DensifyVariant& variant : kDensifyVariants) {
    for (const char* what : {"cpu", "pair", "coverage", "layers", "density"}) {
      text += "\t" + std::string(what) + " " + variant.name;
    }
  }
  for (const std::string& set : sets) {
    text += "\n" + set;
    for (const DensifyVariant& variant : kDensifyVariants) {
      const DensifyRow* row = Find(rows, set, variant.name);
      std::vector<double> values(5, kNotMeasured);
      if (row != nullptr) {
        values = {row->cpu / row->megapixels, row->pair_seconds, 100 * row->coverage_4gsd,
                  row->layers, row->points_per_cm2};
      }
      for (double value : values) text += "\t" + (std::isnan(value) ? "?" : Text(value, "%.5g"));
    }
  }
  return text + "\n";
}

}  // namespace colmap_seapoint
