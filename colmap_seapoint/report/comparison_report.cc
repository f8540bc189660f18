#include "colmap_seapoint/report/comparison_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/compare/comparison_scores.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity and no NaN.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json CloudJson(const std::string& path, const OneWay& way, const ComparisonReport& report) {
  Json json;
  const double points = static_cast<double>(way.num_points);
  json["path"] = path;
  json["points"] = way.num_points;
  json["spacing"] = way.spacing;
  json[kComparisonJsonWords] = way.num_in_spacing;
  json["area"] = way.area;
  json["points_per_unit2"] = points / way.area;
  json["points_per_cm2"] = report.unit_in_metres ? Json(points / (1e4 * way.area)) : Json(nullptr);
  json["points_per_cell"] = points / static_cast<double>(way.num_cells);
  json["occupied_cells"] = way.num_cells;
  return json;
}

Json DistanceJson(const OneWay& way) {
  return {{"mean", Number(way.mean)},
          {"rms", Number(way.rms)},
          {"median", Number(way.median)},
          {"points_beyond_max_distance", way.num_beyond}};
}

Json PointsJson(const CloudComparison& c) {
  Json json = {{"definition", kPointsDefinition}, {"at", Json::array()}};
  for (size_t k = 0; k < c.distances.size(); ++k) {
    const ComparisonScores scores = PointScores(c, k);
    json["at"].push_back({{"distance", c.distances[k]},
                          {"accuracy", scores.accuracy},
                          {"completeness", scores.completeness},
                          {"f_score", scores.f_score},
                          {"input_points_within", c.input.at[k].num_within},
                          {"reference_points_within", c.reference.at[k].num_within}});
  }
  return json;
}

Json Eth3dJson(const CloudComparison& c) {
  Json json = {{"definition", kEth3dDefinition},
               {"voxel_size", c.voxel_size},
               {"input_voxels", c.input.num_voxels},
               {"reference_voxels", c.reference.num_voxels},
               {"at", Json::array()}};
  for (size_t k = 0; k < c.distances.size(); ++k) {
    const ComparisonScores scores = Eth3dScores(c, k);
    json["at"].push_back({{"distance", c.distances[k]},
                          {"accuracy", scores.accuracy},
                          {"completeness", scores.completeness},
                          {"f1", scores.f_score}});
  }
  return json;
}

Json TanksJson(const CloudComparison& c) {
  Json json = {{"definition", kTanksAndTemplesDefinition}, {"at", Json::array()}};
  for (size_t k = 0; k < c.distances.size(); ++k) {
    const ComparisonScores scores = TanksScores(c, k);
    json["at"].push_back({{"distance", c.distances[k]},
                          {"voxel_size", 0.5 * c.distances[k]},
                          {"precision", scores.accuracy},
                          {"recall", scores.completeness},
                          {"f_score", scores.f_score},
                          {"input_points", c.input.at[k].num_reduced},
                          {"input_points_within", c.input.at[k].num_reduced_within},
                          {"reference_points", c.reference.at[k].num_reduced},
                          {"reference_points_within", c.reference.at[k].num_reduced_within}});
  }
  return json;
}

Json HolesJson(const CloudComparison& c) {
  Json json = Json::array();
  for (size_t k = 0; k < c.distances.size(); ++k) {
    json.push_back({{"distance", c.distances[k]},
                    {"hole_area", c.reference.at[k].far_area},
                    {"hole_share", c.reference.at[k].far_area / c.reference.area},
                    {"excess_area", c.input.at[k].far_area},
                    {"excess_share", c.input.at[k].far_area / c.input.area}});
  }
  return json;
}

std::string ScoreRows(const char* name, const CloudComparison& c,
                      ComparisonScores (*scores_at)(const CloudComparison&, size_t)) {
  std::string rows;
  for (size_t k = 0; k < c.distances.size(); ++k) {
    const ComparisonScores scores = scores_at(c, k);
    rows += Format("%-18s %12.6g %10.4f %13.4f %9.4f\n", k == 0 ? name : "", c.distances[k],
                   scores.accuracy, scores.completeness, scores.f_score);
  }
  return rows;
}

std::string CloudRow(const char* name, const OneWay& way, bool in_metres) {
  const double points = static_cast<double>(way.num_points);
  return Format("%-10s %12llu %12.6g %12.6g %12.6g %10.3f\n", name,
                static_cast<unsigned long long>(way.num_points), way.spacing, way.area,
                points / (in_metres ? 1e4 * way.area : way.area),
                points / static_cast<double>(way.num_cells));
}

std::string DistanceRow(const char* name, const OneWay& way) {
  return Format("%-20s %12.6g %12.6g %12.6g %12llu\n", name, way.mean, way.median, way.rms,
                static_cast<unsigned long long>(way.num_beyond));
}

}  // namespace

std::string ComparisonJson(const ComparisonReport& report) {
  const CloudComparison& c = report.comparison;
  Json json;
  json["version"] = Version();
  json["unit"] = report.unit_in_metres ? "metre" : "that of the clouds";
  json["input"] = CloudJson(report.input_path, c.input, report);
  json["reference"] = CloudJson(report.reference_path, c.reference, report);
  json["distances"] = c.distances;
  json["distances_are"] =
      c.distances_from_spacing ? "1, 2 and 4 times the reference's spacing" : "as given";
  json["max_distance"] = c.max_distance;
  json["cell_size"] = c.cell_size;
  json["area_cell_size"] = c.area_cell_size;
  json["definitions"] = {{"spacing", kSpacingDefinition},
                         {"area", kAreaDefinition},
                         {"distance", kDistanceDefinition}};
  json["distance"] = {{"input_to_reference", DistanceJson(c.input)},
                      {"reference_to_input", DistanceJson(c.reference)}};
  json["points"] = PointsJson(c);
  json["eth3d"] = Eth3dJson(c);
  json["tanks_and_temples"] = TanksJson(c);
  json["holes"] = HolesJson(c);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ComparisonTable(const ComparisonReport& report) {
  const CloudComparison& c = report.comparison;
  std::string table =
      Format("%-10s %12s %12s %12s %12s %10s\n", "cloud", "points", "spacing", "area",
             report.unit_in_metres ? "per cm^2" : "per unit^2", "a cell") +
      CloudRow("input", c.input, report.unit_in_metres) +
      CloudRow("reference", c.reference, report.unit_in_metres) +
      Format("\n%-20s %12s %12s %12s %12s\n", "distance", "mean", "median", "rms", "beyond") +
      DistanceRow("input to reference", c.input) + DistanceRow("reference to input", c.reference) +
      Format("\n%-18s %12s %10s %13s %9s\n", "", "within", "accuracy", "completeness", "F-score") +
      ScoreRows("points", c, PointScores) + ScoreRows("ETH3D", c, Eth3dScores) +
      ScoreRows("Tanks and Temples", c, TanksScores) +
      Format("\n%-18s %12s %14s %14s\n", "", "farther than", "hole area", "excess area");
  for (size_t k = 0; k < c.distances.size(); ++k) {
    table += Format("%-18s %12.6g %14.6g %14.6g\n", "", c.distances[k], c.reference.at[k].far_area,
                    c.input.at[k].far_area);
  }
  return table;
}

}  // namespace colmap_seapoint
