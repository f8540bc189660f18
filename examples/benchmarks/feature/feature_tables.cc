#include "examples/benchmarks/feature/feature_tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "examples/benchmarks/feature/pair_measures.h"

namespace colmap_seapoint {
namespace {

constexpr char kBaseline[] = "SeaPoints";

constexpr char kDefinitions[] = R"(# SeaPoints, ORB and SIFT

Medians over the pairs of a set: (V, V+2) is the paper's interpair matching, (V, V+1) its intrapair
matching; pictures in natural order of their names. Shares are in percent.

- setting: the wanted number of SeaPoints; the threshold of ORB and SIFT, lowered from OpenCV's
  default (FAST 20, contrast 0.04) where they found too few points with it.
- matched: matches left by the flow filter, over the smaller number of points of the two pictures.
- verified: inliers of the two-view geometry (focal length 1.2 x the longer side, no prior), over the
  same; of SeaPoints with what guided matching along its epipolar lines adds.
- reliable area: influence areas around the matched points of the second picture, share of it.
- CPU: user + sys seconds of the whole process, decoding not counted; the ratio is the median of the
  pictures' (pairs') own ratios, measured in turn in one sitting.
- precision: matches within 2 pixels of the true place in the second picture.
- repeatability: points of the first picture that the second can see, and finds again within 2 pixels.
- true overlap: share of the second picture whose place is visible in the first.
- overlap error: reliable area minus true overlap, in points; signed and absolute, each its median.
- recall: share of the truly shared cells with texture that lie in the reliable area. Texture: the
  standard deviation of a cell's grey levels is above three times the noise (that of the picture's
  flattest cells), and above 1.5; the share of such cells and the limit's median are given.
- area precision: share of the reliable area that is truly shared.

)";

using Rows = std::vector<FeatureRow>;

std::vector<std::string> Distinct(const Rows& rows, std::string FeatureRow::*field) {
  std::vector<std::string> values;
  for (const FeatureRow& row : rows) {
    if (std::find(values.begin(), values.end(), row.*field) == values.end()) {
      values.push_back(row.*field);
    }
  }
  return values;
}

// `gap` 0: any.
Rows Select(const Rows& rows, const std::string& set, const std::string& detector, int gap) {
  Rows selected;
  for (const FeatureRow& row : rows) {
    if (row.set == set && row.detector == detector && (gap == 0 || row.gap == gap)) {
      selected.push_back(row);
    }
  }
  return selected;
}

double MedianOf(const Rows& rows, const std::function<double(const FeatureRow&)>& value) {
  std::vector<double> values;
  for (const FeatureRow& row : rows) values.push_back(value(row));
  return Median(values);
}

double MedianOf(const Rows& rows, double FeatureRow::*field) {
  return MedianOf(rows, [&](const FeatureRow& row) { return row.*field; });
}

std::string Text(double value, const char* format) {
  if (std::isnan(value)) return "–";
  char text[32];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string Percent(double share) { return Text(100 * share, "%.1f"); }

// The value of each picture, which is the same in all pairs that it is part of.
std::map<std::string, double> ByPicture(const Rows& rows, double FeatureRow::*of1,
                                        double FeatureRow::*of2) {
  std::map<std::string, double> values;
  for (const FeatureRow& row : rows) {
    values[row.picture1] = row.*of1;
    values[row.picture2] = row.*of2;
  }
  return values;
}

std::map<std::string, double> ByPair(const Rows& rows, double FeatureRow::*field) {
  std::map<std::string, double> values;
  for (const FeatureRow& row : rows) values[row.picture1 + "," + row.picture2] = row.*field;
  return values;
}

double MedianValue(const std::map<std::string, double>& by_key) {
  std::vector<double> values;
  for (const auto& entry : by_key) values.push_back(entry.second);
  return Median(values);
}

double MedianRatio(const std::map<std::string, double>& numerators,
                   const std::map<std::string, double>& denominators) {
  std::vector<double> ratios;
  for (const auto& [key, denominator] : denominators) {
    const auto numerator = numerators.find(key);
    if (numerator != numerators.end() && denominator > 0) {
      ratios.push_back(numerator->second / denominator);
    }
  }
  return Median(ratios);
}

struct Cpu {
  std::map<std::string, double> extract, match;
};

Cpu CpuOf(const Rows& rows, const std::string& set, const std::string& detector) {
  const Rows selected = Select(rows, set, detector, 0);
  return {ByPicture(selected, &FeatureRow::extract_cpu1, &FeatureRow::extract_cpu2),
          ByPair(selected, &FeatureRow::match_cpu)};
}

std::string MatchingLine(const Rows& rows, const std::string& set, const std::string& detector) {
  const Rows all = Select(rows, set, detector, 0);
  const auto points = ByPicture(all, &FeatureRow::points1, &FeatureRow::points2);
  std::string line = "| " + set + " | " + std::to_string(points.size()) + " | " + detector + " | " +
                     all[0].setting + " | " + Text(MedianValue(points), "%.0f") + " |";
  for (double FeatureRow::*field :
       {&FeatureRow::matched_share, &FeatureRow::verified_share, &FeatureRow::reliable_area}) {
    for (int gap : {2, 1}) {
      line += " " + Percent(MedianOf(Select(rows, set, detector, gap), field)) + " |";
    }
  }
  return line + "\n";
}

std::string CpuLine(const Rows& rows, const std::string& set, const std::string& detector) {
  const Cpu cpu = CpuOf(rows, set, detector), baseline = CpuOf(rows, set, kBaseline);
  const double extract = MedianValue(cpu.extract), match = MedianValue(cpu.match);
  std::string line = "| " + set + " | " + detector + " | ";
  line += Text(extract, "%.3f") + " | " + Text(match, "%.4f") + " | " +
          Text(extract + match, "%.3f") + " | ";
  line += Text(MedianRatio(baseline.extract, cpu.extract), "%.2f") + " | " +
          Text(MedianRatio(baseline.match, cpu.match), "%.2f") + " |\n";
  return line;
}

std::string TruthLine(const Rows& rows, const std::string& set, const std::string& detector) {
  const Rows by_gap[] = {Select(rows, set, detector, 2), Select(rows, set, detector, 1)};
  std::string line = "| " + set + " | " + detector + " |";
  for (double FeatureRow::*field : {&FeatureRow::precision, &FeatureRow::repeatability}) {
    for (const Rows& selected : by_gap) line += " " + Percent(MedianOf(selected, field)) + " |";
  }
  for (const Rows& selected : by_gap) {
    const double absolute =
        MedianOf(selected, [](const FeatureRow& row) { return std::abs(row.overlap_error); });
    line += " " + Percent(MedianOf(selected, &FeatureRow::true_overlap)) + " | " +
            Text(100 * MedianOf(selected, &FeatureRow::overlap_error), "%+.1f") + " / " +
            Percent(absolute) + " |";
  }
  for (double FeatureRow::*field : {&FeatureRow::recall, &FeatureRow::area_precision}) {
    for (const Rows& selected : by_gap) line += " " + Percent(MedianOf(selected, field)) + " |";
  }
  line += " " + Percent(MedianOf(by_gap[1], &FeatureRow::textured)) + " |";
  return line + " " + Text(MedianOf(by_gap[1], &FeatureRow::texture_limit), "%.1f") + " |\n";
}

std::string Rule(int num_columns) {
  std::string line = "|";
  for (int i = 0; i < num_columns; ++i) line += "---|";
  return line + "\n";
}

}  // namespace

std::string MarkdownTables(const std::vector<FeatureRow>& rows) {
  std::string matching =
      "## Matching\n\n| set | pictures | detector | setting | points | matched V,V+2 | matched "
      "V,V+1 | "
      "verified V,V+2 | verified V,V+1 | reliable area V,V+2 | reliable area V,V+1 |\n" +
      Rule(11);
  std::string cpu =
      "\n## CPU seconds\n\n| set | detector | detection and description a picture | matching and "
      "filtering a pair | both | SeaPoints' detection over its | SeaPoints' matching over its |\n" +
      Rule(7);
  std::string truth =
      "\n## Against the truth\n\n| set | detector | precision V,V+2 | precision V,V+1 | "
      "repeatability V,V+2 | repeatability V,V+1 | true overlap V,V+2 | its error | true overlap "
      "V,V+1 | its error | recall V,V+2 | recall V,V+1 | area precision V,V+2 | area precision "
      "V,V+1 | textured V,V+1 | texture limit |\n" +
      Rule(16);
  bool any_truth = false;
  for (const std::string& set : Distinct(rows, &FeatureRow::set)) {
    for (const std::string& detector : Distinct(rows, &FeatureRow::detector)) {
      const Rows selected = Select(rows, set, detector, 0);
      if (selected.empty()) continue;
      matching += MatchingLine(rows, set, detector);
      cpu += CpuLine(rows, set, detector);
      if (std::isnan(selected[0].true_overlap)) continue;
      any_truth = true;
      truth += TruthLine(rows, set, detector);
    }
  }
  return kDefinitions + matching + cpu + (any_truth ? truth : "");
}

std::string PlotData(const std::vector<FeatureRow>& rows) {
  const std::vector<std::string> detectors = Distinct(rows, &FeatureRow::detector);
  std::string text = "set";
  for (const std::string& detector : detectors) {
    for (const char* what : {"matched_2", "matched_1", "area_2", "area_1", "extract", "match"}) {
      text += "\t" + std::string(what) + " " + detector;
    }
  }
  for (const std::string& set : Distinct(rows, &FeatureRow::set)) {
    text += "\n" + set;
    for (const std::string& detector : detectors) {
      std::vector<double> values;
      for (double FeatureRow::*field : {&FeatureRow::matched_share, &FeatureRow::reliable_area}) {
        for (int gap : {2, 1}) {
          values.push_back(100 * MedianOf(Select(rows, set, detector, gap), field));
        }
      }
      const Cpu cpu = CpuOf(rows, set, detector);
      values.push_back(MedianValue(cpu.extract));
      values.push_back(MedianValue(cpu.match));
      for (double value : values) text += "\t" + (std::isnan(value) ? "?" : Text(value, "%.5g"));
    }
  }
  return text + "\n";
}

}  // namespace colmap_seapoint
