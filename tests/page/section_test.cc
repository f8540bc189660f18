#include "colmap_seapoint/page/section.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

class SectionOfASurvey : public testing::Test {
 protected:
  static bool Keep(const Eigen::Vector2d& p) {
    return (p - Eigen::Vector2d(1.6, 2.4)).norm() > 0.8;
  }
  const SparseModel model_ = MakeFlatSurvey({2, 4, 1.6, 3.2});
  const CompletenessResult result_ = AssessCompleteness(FlatInput(model_, Keep), {}, 2);

  Json Write(const GapPlaces& places) const {
    SectionInput input;
    input.model = &model_;
    input.result = &result_;
    input.places = &places;
    input.answer = "\xff is no UTF-8";
    input.maps = DrawGroundMaps(result_, places.Unit());
    const std::vector<double> brightness(model_.images.size(), -1);
    input.track = FollowTrack({&model_, &result_.records, &brightness});
    GapPicture picture;
    picture.name = "a.jpg";
    picture.crop = ColorImage(8, 6, 3, 77);
    picture.outline = {{{1.4, 2.6}, {3, 4}, {5, 5}}};
    input.gap_pictures.resize(result_.gaps.size());
    input.gap_pictures[0] = {picture};
    input.cloud = PackCloud({{{1, 2, 3}, {4, 5, 6}}}, result_.ground.frame.map_from_world);
    const std::string text = SectionJson(input);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return Json::parse(text);
  }
};

TEST_F(SectionOfASurvey, HoldsWhatThePageShows) {
  const Json json = Write(GapPlaces(ModelUnits(), result_.ground.frame));
  EXPECT_EQ(json.at("unit"), "units");
  EXPECT_FALSE(json.at("is_north_up").get<bool>());
  EXPECT_EQ(json.at("figures").at("coverage")[0].at("share"), result_.coverage[0].share);
  EXPECT_EQ(json.at("figures").at("tolerance"), result_.share_tolerance);
  ASSERT_EQ(json.at("gaps").size(), result_.gaps.size());
  for (size_t g = 0; g < result_.gaps.size(); ++g) {
    const Gap& gap = result_.gaps[g];
    const Json& written = json.at("gaps")[g];
    EXPECT_EQ(written.at("id"), gap.id);
    EXPECT_TRUE(json.at("causes").contains(written.at("cause").get<std::string>()));
    ASSERT_EQ(written.at("outline").size(), gap.outline.size());
    for (size_t k = 0; k < gap.outline[0].size(); ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(written.at("outline")[0][k][static_cast<size_t>(axis)].get<double>(),
                    gap.outline[0][k][axis], 0.01 * result_.ground.cell_side);
      }
    }
    EXPECT_EQ(written.at("pass").at("corners").size(), gap.pass.corners.size());
    // The number on the map lies in its gap, whatever its shape.
    AskedArea area;
    area.rings = gap.region.rings;
    const Json& mark = written.at("middle");
    EXPECT_TRUE(gap.region.layer.side != Side::kTop ||
                area.Contains({mark[0].get<double>(), mark[1].get<double>()}));
  }
  EXPECT_EQ(json.at("route").size(), result_.route.size());
  EXPECT_EQ(json.at("track").at("pictures").size(), model_.images.size());
  EXPECT_EQ(json.at("map").at("list").size(), 7u);
  EXPECT_EQ(json.at("cloud").at("count"), 1);
  const Json& picture = json.at("gaps")[0].at("pictures")[0];
  EXPECT_EQ(picture.at("outline")[0][0], (Json{1, 3}));
  EXPECT_EQ(picture.at("src").get<std::string>().substr(0, 27), "data:image/jpeg;base64,/9j/");
}

TEST_F(SectionOfASurvey, NorthIsUpWhereThatIsKnown) {
  ModelUnits units;
  units.is_metric = true;
  units.frame = "east-north-up";
  units.origin = GeoPosition{43.1, 5.9, 0};
  const Json json = Write(GapPlaces(units, result_.ground.frame));
  EXPECT_EQ(json.at("unit"), "m");
  EXPECT_TRUE(json.at("is_north_up").get<bool>());
  // Latitude first, as people say it.
  EXPECT_NEAR(std::stod(json.at("gaps")[0].at("place").get<std::string>()), 43.1, 0.001);
}

}  // namespace
}  // namespace colmap_seapoint
