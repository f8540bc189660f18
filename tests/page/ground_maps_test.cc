#include "colmap_seapoint/page/ground_maps.h"

#include <gtest/gtest.h>

#include <set>

#include "colmap_seapoint/gaps/gap_colors.h"
#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

class GroundMapsOfASurvey : public testing::Test {
 protected:
  static bool Keep(const Eigen::Vector2d& p) {
    return (p - Eigen::Vector2d(1.6, 2.4)).norm() > 0.8;
  }
  const SparseModel model_ = MakeFlatSurvey({2, 4, 1.6, 3.2});
  const CompletenessResult result_ = AssessCompleteness(FlatInput(model_, Keep), {}, 2);
  const GroundMaps maps_ = DrawGroundMaps(result_, "units");

  const GroundMap& Map(const std::string& key) const {
    for (const GroundMap& map : maps_.maps) {
      if (map.key == key) return map;
    }
    throw std::out_of_range(key);
  }
  // Red, green, blue, alpha at a place of the plan.
  std::array<int, 4> At(const std::string& key, double x, double y) const {
    const Image<uint8_t>& picture = Map(key).picture;
    const int a = static_cast<int>((x - maps_.left) / (maps_.right - maps_.left) * picture.width);
    const int b = static_cast<int>((maps_.top - y) / (maps_.top - maps_.bottom) * picture.height);
    EXPECT_TRUE(picture.Contains(a, b));
    const uint8_t* p = &picture.At(a, b);
    return {p[0], p[1], p[2], p[3]};
  }
};

TEST_F(GroundMapsOfASurvey, TheHoleHasItsCauseAndItsPlace) {
  const auto color = CauseColor(GapCause::kViewsDisagree);
  EXPECT_EQ(At("causes", 1.6, 2.4), (std::array<int, 4>{color[0], color[1], color[2], 255}));
  EXPECT_EQ(At("causes", 1.6, 0.6)[3], 0);  // covered
  EXPECT_EQ(At("coverage", 1.6, 2.4), (std::array<int, 4>{213, 94, 0, 255}));
  EXPECT_EQ(At("coverage", 1.6, 0.6), (std::array<int, 4>{0, 114, 178, 255}));
  EXPECT_EQ(At("relief", 1.6, 2.4)[3], 0);  // no point, no height
  EXPECT_EQ(At("views", 1.6, 2.4)[3], 0);
}

TEST_F(GroundMapsOfASurvey, OneOfEachWithItsLegend) {
  std::set<std::string> keys;
  for (const GroundMap& map : maps_.maps) {
    keys.insert(map.key);
    EXPECT_EQ(map.picture.channels, 4);
    EXPECT_LE(std::max(map.picture.width, map.picture.height), kGroundMapSide);
    EXPECT_FALSE(map.title.empty());
    EXPECT_GE(map.legend.size(), map.key == "causes" ? 0u : 4u) << map.key;
  }
  EXPECT_EQ(keys, (std::set<std::string>{"causes", "coverage", "density", "views", "parallax",
                                         "detail", "relief"}));
  // A pixel of the survey is kFlatGsd.
  EXPECT_EQ(Map("detail").legend.front().text.substr(0, 4), "0.02");
  // More pictures see the middle than the rim.
  EXPECT_GT(At("views", 1.6, 3.6)[0], At("views", -1.5, 0.3)[0]);
}

TEST(DrawGroundMaps, NothingOfNothing) {
  EXPECT_TRUE(DrawGroundMaps(CompletenessResult(), "m").maps.empty());
}

}  // namespace
}  // namespace colmap_seapoint
