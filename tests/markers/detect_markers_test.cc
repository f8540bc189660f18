#include "colmap_seapoint/markers/detect_markers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "colmap_seapoint/markers/marker_codes.h"
#include "tests/markers/marker_world.h"

namespace colmap_seapoint {
namespace {

constexpr MarkerFamily kAll[] = {MarkerFamily::kTag36h11, MarkerFamily::kAruco4x4,
                                 MarkerFamily::kAruco5x5, MarkerFamily::kAruco6x6};

Camera SmallCamera() { return MakeCamera(CameraModel::kPinhole, 500, 240, 180); }

// Straight above the plane at 2 units: a marker of 0.1 is 25 pixels wide.
GrayImage FromAbove(const std::vector<PlaneMarker>& markers, const Water& water = {}) {
  return MarkerPicture(markers, SmallCamera(), Rigid3d(), water);
}

PlaneMarker Marker(MarkerFamily family, int id, double x, double y, double turn = 0.4) {
  return {{family, id}, {x, y, 2}, 0.1, turn, false};
}

TEST(MarkerCodesTest, EveryMarkerIsItsOwnAndNoneIsAnotherTurned) {
  for (const MarkerFamily family : kAll) {
    const int cells = NumCells(family);
    std::set<std::vector<bool>> known;
    for (int id = 0; id < NumMarkers(family); ++id) {
      for (int turn = 0; turn < 4; ++turn) {
        std::vector<bool> bits;
        for (int k = 0; k < cells * cells; ++k) {
          int x = k % cells, y = k / cells;
          for (int t = 0; t < turn; ++t) {
            const int before = x;
            x = cells - 1 - y;
            y = before;
          }
          bits.push_back(IsWhiteCell({family, id}, x, y));
        }
        EXPECT_TRUE(known.insert(bits).second) << FamilyText(family) << " " << id << " " << turn;
      }
    }
    EXPECT_FALSE(IsWhiteCell({family, 0}, 0, 3));
    EXPECT_TRUE(IsWhiteCell({family, 0}, -1, 3));
    EXPECT_TRUE(IsWhiteCell({family, 0}, 2, cells));
  }
}

TEST(MarkerNameTest, SpellingsAndNumbers) {
  EXPECT_EQ(MarkerText(*ParseMarkerName("TAG36h11:12").name), "tag36h11:12");
  EXPECT_EQ(MarkerText(*ParseMarkerName("DICT_4X4_50:49").name), "DICT_4X4:49");
  EXPECT_EQ(MarkerText(*ParseMarkerName("dict_apriltag_36h11:0").name), "tag36h11:0");
  for (const char* text : {"bar_a", "point:12", "tag36h11", "", ":", "DICT_4X4_60:1"}) {
    EXPECT_FALSE(ParseMarkerName(text).name) << text;
    EXPECT_EQ(ParseMarkerName(text).problem, "") << text;
  }
  for (const char* text : {"tag36h11:587", "tag36h11:-1", "tag36h11:", "tag36h11:1x",
                           "DICT_4X4_50:50", "tag36h11:99999999999"}) {
    EXPECT_FALSE(ParseMarkerName(text).name) << text;
    EXPECT_NE(ParseMarkerName(text).problem, "") << text;
  }
  EXPECT_EQ(ParseMarkerFamilies("DICT_6X6,tag36h11")->size(), 2u);
  EXPECT_FALSE(ParseMarkerFamilies(""));
  EXPECT_FALSE(ParseMarkerFamilies("tag36h11,nothing"));
}

// Each family's, turned, at 25 pixels: number, corners and centre are exact.
TEST(DetectMarkersTest, EveryFamilyWithExactCorners) {
  for (const MarkerFamily family : kAll) {
    const std::vector<PlaneMarker> world = {Marker(family, 7, -0.2, -0.1, 0.4),
                                            Marker(family, 31, 0.15, 0.1, 3.9)};
    auto found = DetectMarkers(FromAbove(world), {family});
    if (family == MarkerFamily::kAruco4x4) {  // of others, some are found by chance
      found.erase(std::remove_if(found.begin(), found.end(),
                                 [](const DetectedMarker& marker) {
                                   return marker.name.id != 7 && marker.name.id != 31;
                                 }),
                  found.end());
    }
    ASSERT_EQ(found.size(), 2u) << FamilyText(family);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(found[i].name.id, world[i].name.id);
      EXPECT_FALSE(found[i].is_mirrored);
      const Camera camera = SmallCamera();
      EXPECT_LT((found[i].Centre() - *camera.ImgFromCam(world[i].centre)).norm(), 0.1);
      for (const Eigen::Vector2d& corner : found[i].corners) {
        double nearest = 1e9;
        for (int k = 0; k < 4; ++k) {
          nearest = std::min(nearest, (corner - *camera.ImgFromCam(world[i].Corner(k))).norm());
        }
        EXPECT_LT(nearest, 0.35) << FamilyText(family);
      }
    }
  }
}

TEST(DetectMarkersTest, TheFirstCornerIsThatOfThePrint) {
  const PlaneMarker upright = Marker(MarkerFamily::kTag36h11, 5, 0, 0, 0);
  PlaneMarker turned = upright;
  turned.turn = 2;
  const auto a = DetectMarkers(FromAbove({upright}), {MarkerFamily::kTag36h11});
  const auto b = DetectMarkers(FromAbove({turned}), {MarkerFamily::kTag36h11});
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  const Eigen::Rotation2Dd turn(2);
  for (size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d arm = turn * (a[0].corners[k] - a[0].Centre());
    EXPECT_LT((arm - (b[0].corners[k] - b[0].Centre())).norm(), 0.5);
  }
}

TEST(DetectMarkersTest, SmallMarkersInBadWater) {
  const Water water = {0.2, 2, 1, 0.5};
  int num_found = 0;
  for (int id = 0; id < 12; ++id) {
    const auto found =
        DetectMarkers(FromAbove({Marker(MarkerFamily::kTag36h11, id, 0.03, 0.02, 0.5 * id)}, water),
                      {MarkerFamily::kTag36h11});
    EXPECT_LE(found.size(), 1u);
    for (const DetectedMarker& marker : found) num_found += marker.name.id == id;
  }
  EXPECT_GE(num_found, 11);
}

TEST(DetectMarkersTest, MirrorImagesAreToldAsSuch) {
  for (const MarkerFamily family : kAll) {
    PlaneMarker mirrored = Marker(family, 11, 0, 0);
    mirrored.is_mirrored = true;
    const auto found = DetectMarkers(FromAbove({mirrored}), {family});
    bool is_told = false;
    for (const DetectedMarker& marker : found) {
      // By chance the mirror image of a small one can be another marker.
      EXPECT_TRUE(marker.is_mirrored || family != MarkerFamily::kTag36h11);
      is_told = is_told || (marker.is_mirrored && marker.name.id == 11);
    }
    EXPECT_TRUE(is_told || family == MarkerFamily::kAruco4x4) << FamilyText(family);
  }
}

TEST(DetectMarkersTest, NothingWhereThereIsNothing) {
  const std::vector<MarkerFamily> all(std::begin(kAll), std::end(kAll));
  EXPECT_TRUE(DetectMarkers(GrayImage(), all).empty());
  for (const int side : {1, 3, 15, 16, 17, 40}) {
    EXPECT_TRUE(DetectMarkers(GrayImage(side, 300 - side, 1, 128), all).empty());
  }
  EXPECT_TRUE(DetectMarkers(FromAbove({}, {1, 20, 0, 0}), {MarkerFamily::kTag36h11}).empty());
  EXPECT_TRUE(DetectMarkers(FromAbove({Marker(MarkerFamily::kTag36h11, 1, 0, 0)}), {}).empty());
  // Cut by the picture's edge.
  EXPECT_TRUE(DetectMarkers(FromAbove({Marker(MarkerFamily::kTag36h11, 1, 0.46, 0)}),
                            {MarkerFamily::kTag36h11})
                  .empty());
}

}  // namespace
}  // namespace colmap_seapoint
