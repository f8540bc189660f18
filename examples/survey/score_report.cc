#include <cstdio>
#include <nlohmann/json.hpp>

#include "examples/survey/score.h"

namespace colmap_seapoint {
namespace {

nlohmann::ordered_json AccuracyJson(const AccuracyScore& accuracy) {
  return {{"share_within_1gsd", accuracy.share_1gsd},
          {"share_within_2gsd", accuracy.share_2gsd},
          {"share_within_4gsd", accuracy.share_4gsd},
          {"median_gsd", accuracy.median_gsd},
          {"mean_gsd", accuracy.mean_gsd}};
}

// One line: shares within 1, 2 and 4, and the median.
void AddShares(const char* name, const AccuracyScore& accuracy, std::string* table) {
  char line[160];
  std::snprintf(line, sizeof(line), "%-34s %.2f / %.2f / %.2f %%, median %.3f\n",
                (std::string("within 1 / 2 / 4 ") + name).c_str(), 100 * accuracy.share_1gsd,
                100 * accuracy.share_2gsd, 100 * accuracy.share_4gsd, accuracy.median_gsd);
  *table += line;
}

}  // namespace

std::string ScoreJson(const SurveyScore& s) {
  nlohmann::ordered_json json = {{"gsd_m", s.gsd},
                                 {"refined", s.refined},
                                 {"num_images", s.num_images},
                                 {"num_registered", s.num_registered},
                                 {"centre_rms_mm", 1000 * s.centre_rms},
                                 {"centre_max_mm", 1000 * s.centre_max},
                                 {"scale", s.scale},
                                 {"num_points", s.num_points},
                                 {"share_within_1gsd", s.accuracy.share_1gsd},
                                 {"share_within_2gsd", s.accuracy.share_2gsd},
                                 {"share_within_4gsd", s.accuracy.share_4gsd},
                                 {"median_gsd", s.accuracy.median_gsd},
                                 {"mean_gsd", s.accuracy.mean_gsd},
                                 {"twice_seen_m2", s.twice_seen_m2},
                                 {"coverage_2gsd", s.coverage_2gsd},
                                 {"coverage_4gsd", s.coverage_4gsd},
                                 {"points_per_gsd2", s.points_per_gsd2},
                                 {"points_per_cm2", s.points_per_cm2},
                                 {"redundancy", s.redundancy}};
  json["parallax_seen_m2"] = s.parallax_seen_m2;
  json["parallax_coverage_2gsd"] = s.parallax_coverage_2gsd;
  json["parallax_coverage_4gsd"] = s.parallax_coverage_4gsd;
  json["own_redundancy"] = s.own_redundancy;
  json["own_gsd"] = AccuracyJson(s.own_accuracy);
  if (s.has_views) json["view_gsd"] = AccuracyJson(s.view_accuracy);
  return json.dump(2) + "\n";
}

std::string ScoreTable(const SurveyScore& s) {
  std::string table;
  const auto add = [&](const char* name, double value, int digits, const char* unit) {
    char line[128];
    std::snprintf(line, sizeof(line), "%-34s %12.*f %s\n", name, digits, value, unit);
    table += line;
  };
  add("pictures in the survey", s.num_images, 0, "");
  add("pictures registered", s.num_registered, 0, "");
  add("camera centres, RMS error", 1000 * s.centre_rms, 2, "mm");
  add("camera centres, largest error", 1000 * s.centre_max, 2, "mm");
  add("ground sampling distance (GSD)", 1000 * s.gsd, 3, "mm");
  add("points", static_cast<double>(s.num_points), 0, "");
  add("points within 1 GSD", 100 * s.accuracy.share_1gsd, 2, "%");
  add("points within 2 GSD", 100 * s.accuracy.share_2gsd, 2, "%");
  add("points within 4 GSD", 100 * s.accuracy.share_4gsd, 2, "%");
  add("median distance", s.accuracy.median_gsd, 3, "GSD");
  AddShares("own GSD", s.own_accuracy, &table);
  if (s.has_views) AddShares("GSD of its pictures", s.view_accuracy, &table);
  add("surface seen twice or more", s.twice_seen_m2, 2, "m2");
  add("of it with a point within 2 GSD", 100 * s.coverage_2gsd, 2, "%");
  add("of it with a point within 4 GSD", 100 * s.coverage_4gsd, 2, "%");
  add("surface seen 3 degrees apart", s.parallax_seen_m2, 2, "m2");
  add("of it within 2 own GSD", 100 * s.parallax_coverage_2gsd, 2, "%");
  add("of it within 4 own GSD", 100 * s.parallax_coverage_4gsd, 2, "%");
  add("density", s.points_per_gsd2, 3, "points/GSD2");
  add("density", s.points_per_cm2, 2, "points/cm2");
  add("redundancy", s.redundancy, 2, "points/occupied GSD cell");
  add("redundancy", s.own_redundancy, 2, "points/occupied cell of own GSD");
  return table;
}

}  // namespace colmap_seapoint
