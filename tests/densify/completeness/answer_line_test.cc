#include "colmap_seapoint/gaps/answer_line.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

std::string LineOf(double spacing, double area, double route, bool is_metric) {
  CompletenessResult result;
  result.spacing = spacing;
  result.coverage[0].share = 0.327;
  result.share_tolerance = 0.005;
  result.route_length = route;
  Gap gap;
  gap.region.area = area;
  result.gaps.push_back(gap);
  ModelUnits units;
  units.is_metric = is_metric;
  return CompletenessLine(result, {}, GapPlaces(units, result.ground.frame));
}

TEST(CompletenessLine, WritesNoNumberWithAnExponent) {
  const std::string large = LineOf(0.0523, 3870, 1423, true);
  EXPECT_EQ(
      large.find("32.7 % (+- 0.5) of the survey is covered at 5.2 cm spacing; 1 gap, 3900 m2:"), 0u)
      << large;
  EXPECT_NE(large.find("; a route of 1420 m closes them"), std::string::npos) << large;
  const std::string small = LineOf(0.000312, 0.0000412, 0.0123, false);
  EXPECT_NE(small.find("at 0.000312 units spacing; 1 gap, 0.000041 square units:"),
            std::string::npos)
      << small;
  EXPECT_NE(small.find("; a route of 0.0123 units closes them"), std::string::npos) << small;
  EXPECT_NE(LineOf(0.0052, 1, 0.996, true).find("at 5.2 mm spacing"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
