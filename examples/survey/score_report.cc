#include <cstdio>
#include <nlohmann/json.hpp>

#include "examples/survey/score.h"

namespace colmap_seapoint {

std::string ScoreJson(const SurveyScore& s) {
  const nlohmann::ordered_json json = {{"gsd_m", s.gsd},
                                       {"refined", s.refined},
                                       {"num_images", s.num_images},
                                       {"num_registered", s.num_registered},
                                       {"centre_rms_mm", 1000 * s.centre_rms},
                                       {"centre_max_mm", 1000 * s.centre_max},
                                       {"scale", s.scale},
                                       {"num_points", s.num_points},
                                       {"share_within_1gsd", s.share_1gsd},
                                       {"share_within_2gsd", s.share_2gsd},
                                       {"share_within_4gsd", s.share_4gsd},
                                       {"median_gsd", s.median_gsd},
                                       {"mean_gsd", s.mean_gsd},
                                       {"twice_seen_m2", s.twice_seen_m2},
                                       {"coverage_2gsd", s.coverage_2gsd},
                                       {"coverage_4gsd", s.coverage_4gsd},
                                       {"points_per_gsd2", s.points_per_gsd2},
                                       {"points_per_cm2", s.points_per_cm2},
                                       {"redundancy", s.redundancy}};
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
  add("points within 1 GSD", 100 * s.share_1gsd, 2, "%");
  add("points within 2 GSD", 100 * s.share_2gsd, 2, "%");
  add("points within 4 GSD", 100 * s.share_4gsd, 2, "%");
  add("median distance", s.median_gsd, 3, "GSD");
  add("surface seen twice or more", s.twice_seen_m2, 2, "m2");
  add("of it with a point within 2 GSD", 100 * s.coverage_2gsd, 2, "%");
  add("of it with a point within 4 GSD", 100 * s.coverage_4gsd, 2, "%");
  add("density", s.points_per_gsd2, 3, "points/GSD2");
  add("density", s.points_per_cm2, 2, "points/cm2");
  add("redundancy", s.redundancy, 2, "points/occupied GSD cell");
  return table;
}

}  // namespace colmap_seapoint
