#include "colmap_seapoint/georeference/marker_places.h"

#include <gtest/gtest.h>

#include <cmath>

#include "colmap_seapoint/georeference/marker_search.h"
#include "colmap_seapoint/georeference/scale_measurements.h"
#include "tests/georeference/five_cameras.h"

namespace colmap_seapoint {
namespace {

constexpr double kSide = 0.1;

// Five cameras in a row, 0.4 units apart, that look at the plane z = 2.
class MarkerPlaces : public FiveCameras {
 protected:
  MarkerPlaces() : FiveCameras([](uint32_t i) { return Eigen::Vector3d(0.4 * i - 0.8, 0, 0); }) {}

  // Seen by these pictures (from 1), its corners turned and moved by `error` pixels in turn.
  void See(const std::string& marker, const Eigen::Vector3d& centre,
           const std::vector<int>& pictures, double factor = 1, double stretch = 1) {
    for (const int k : pictures) {
      const PosedImage& image = model_.images[static_cast<size_t>(k - 1)];
      MarkerSighting sighting{
          marker, image.name, static_cast<int>(1200 * factor), static_cast<int>(900 * factor),
          {},     false};
      for (size_t corner = 0; corner < 4; ++corner) {
        const double angle = 0.3 + 1.5707963267948966 * static_cast<double>(corner);
        const Eigen::Vector3d xyz =
            centre +
            kSide / std::sqrt(2.0) * Eigen::Vector3d(stretch * std::cos(angle), std::sin(angle), 0);
        sighting.corners[corner] =
            factor * *model_.cameras.at(1).ImgFromCam(image.cam_from_world * xyz);
      }
      sightings_.push_back(sighting);
    }
  }

  MarkerPlace Place(int id = 3) {
    return PlaceMarkers(model_, sightings_, 4).at({MarkerFamily::kTag36h11, id});
  }

  ScaleMeasurements Gather() {
    return GatherMeasurements(model_, sources_, sightings_, {}, 1, &report_);
  }
};

TEST_F(MarkerPlaces, ExactSightingsGiveTheExactPlaceAndSide) {
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2, 3, 4});
  const MarkerPlace place = Place();
  EXPECT_EQ(place.problem, "");
  EXPECT_LT((place.xyz - Eigen::Vector3d(0.2, -0.1, 2)).norm(), 1e-9);
  EXPECT_NEAR(place.side, kSide, 1e-9);
  EXPECT_EQ(place.num_used, 4u);
  EXPECT_GT(place.side_sigma, 0);
  EXPECT_GT(place.covariance.trace(), 0);
}

TEST_F(MarkerPlaces, PicturesOfAnotherSizeThanTheModels) {
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2, 3}, 2);
  EXPECT_LT((Place().xyz - Eigen::Vector3d(0.2, -0.1, 2)).norm(), 1e-9);
}

TEST_F(MarkerPlaces, AFalseFindAmongRealOnesIsNotUsed) {
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2, 3, 4});
  See("tag36h11:3", {-0.4, 0.3, 2.4}, {5});
  const MarkerPlace place = Place();
  EXPECT_EQ(place.problem, "");
  EXPECT_EQ(place.num_used, 4u);
  EXPECT_LT((place.xyz - Eigen::Vector3d(0.2, -0.1, 2)).norm(), 1e-9);
}

TEST_F(MarkerPlaces, TheSameMarkerTwiceInTheSceneIsNotUsed) {
  for (const bool in_same_pictures : {false, true}) {
    sightings_.clear();
    See("tag36h11:3", {0.2, -0.1, 2}, {1, 2, 3});
    See("tag36h11:3", {0.3, 0.3, 2},
        in_same_pictures ? std::vector<int>{1, 2, 3} : std::vector<int>{4, 5});
    EXPECT_NE(Place().problem.find("in the scene more than once"), std::string::npos);
  }
}

TEST_F(MarkerPlaces, OnceOnlyElsewhereMirroredAndNoSquare) {
  See("tag36h11:3", {0.2, -0.1, 2}, {2});
  EXPECT_NE(Place().problem.find("one picture of this model only"), std::string::npos);
  sightings_[0].image = "other.jpg";
  EXPECT_NE(Place().problem.find("in 1 picture, none of them in this model"), std::string::npos);
  sightings_[0].is_mirrored = true;
  EXPECT_NE(Place().problem.find("mirror image"), std::string::npos);
  sightings_.clear();
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2, 3}, 1, 2.5);
  EXPECT_NE(Place().problem.find("no square"), std::string::npos);
}

TEST_F(MarkerPlaces, DegenerateCornersDoNoHarm) {
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2});
  for (MarkerSighting& sighting : sightings_) sighting.corners.fill({5, 5});
  EXPECT_NE(Place().problem, "");
}

TEST_F(MarkerPlaces, ABarOfTwoMarkersIsALength) {
  sources_.scale_bars_path =
      Table("bars.csv", "name1,name2,length_m\nDICT_APRILTAG_36h11:3,tag36h11:4,1.5\n");
  See("tag36h11:3", {-0.25, 0, 2}, {1, 2, 3, 4});
  See("tag36h11:4", {0.25, 0, 2}, {2, 3, 4, 5});
  EXPECT_EQ(FamiliesToFind(sources_), std::vector<MarkerFamily>{MarkerFamily::kTag36h11});
  EXPECT_TRUE(MissingMarkers(sources_, sightings_).empty());
  const ScaleMeasurements found = Gather();
  ASSERT_EQ(found.problem.lengths.size(), 1u);
  EXPECT_NEAR(found.problem.lengths[0].in_model, 0.5, 1e-9);
  EXPECT_EQ(found.problem.lengths[0].metres, 1.5);
  ASSERT_EQ(found.targets.size(), 2u);
  EXPECT_EQ(found.targets[0].num_used, 4u);
}

TEST_F(MarkerPlaces, ABarWithoutItsMarkerIsNamedWithWhatWasFound) {
  sources_.scale_bars_path = Table(
      "bars.csv", "name1,name2,length_m\ntag36h11:3,tag36h11:4,1.5\ntag36h11:3,tag36h11:9,2\n");
  See("tag36h11:3", {-0.25, 0, 2}, {1, 2, 3, 4});
  See("tag36h11:4", {0.25, 0, 2}, {2, 3, 4, 5});
  const auto lines = MissingMarkers(sources_, sightings_);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("tag36h11:9 is found in no picture; found: tag36h11:3, tag36h11:4"),
            std::string::npos);
  EXPECT_EQ(Gather().problem.lengths.size(), 1u);
  ASSERT_EQ(report_.left_out.size(), 1u);
  EXPECT_NE(report_.left_out[0].reason.find("found: tag36h11:3, tag36h11:4"), std::string::npos);
}

TEST_F(MarkerPlaces, MarksInATableComeBeforeTheMarker) {
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\ntag36h11:3,B,1.5\n");
  sources_.targets_path =
      Table("targets.csv", "target,image,x,y\ntag36h11:3,img1.jpg,5,5\nB,img1.jpg,6,6\n");
  EXPECT_TRUE(FamiliesToFind(sources_).empty());
}

TEST_F(MarkerPlaces, SidesOfKnownSizeAreLengths) {
  sources_.marker_size = 0.3;
  See("tag36h11:3", {-0.25, 0, 2}, {1, 2, 3, 4});
  See("tag36h11:4", {0.25, 0, 2}, {5});
  const ScaleMeasurements found = Gather();
  ASSERT_EQ(found.problem.lengths.size(), 1u);
  EXPECT_NEAR(found.problem.lengths[0].metres / found.problem.lengths[0].in_model, 3, 1e-6);
  sightings_.clear();
  EXPECT_ERROR(Gather(), "no marker has a place in the model; found: none");
}

TEST_F(MarkerPlaces, NumbersAndFamiliesThatThereAreNot) {
  sources_.scale_bars_path =
      Table("bars.csv", "name1,name2,length_m\ntag36h11:3,tag36h11:587,1.5\n");
  EXPECT_ERROR(CheckScaleTables(sources_), "tag36h11 has the markers 0 to 586");
  ScaleSources sized;
  sized.marker_size = 0.1;
  EXPECT_TRUE(sized.Any());
  EXPECT_EQ(sized.Check(), "");
  for (const char* families : {"DICT_4X4", "tag36h11,DICT_5X5", "", "circles"}) {
    sized.marker_families = families;
    EXPECT_NE(sized.Check(), "") << families;
  }
}

TEST_F(MarkerPlaces, TheTableComesBackAsItWasWritten) {
  See("tag36h11:3", {0.2, -0.1, 2}, {1, 2});
  sightings_[0].image = "a \"b\", c.jpg";
  sightings_[1].is_mirrored = true;
  WriteBytes(dir_ / "m.csv", MarkersCsv(sightings_));
  const auto read = ReadMarkersCsv(dir_ / "m.csv");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(MarkersCsv(read), MarkersCsv(sightings_));
  EXPECT_EQ(read[0].image, sightings_[0].image);
  EXPECT_LT((read[1].corners[2] - sightings_[1].corners[2]).norm(), 1e-3);
  for (const std::string& row : {std::string("tag36h11:3,a.jpg,10\n"),
                                 std::string("tag36h11:3,a.jpg,10,10,1,2,3,4,5,6,7,nan,0\n"),
                                 std::string(",a.jpg,10,10,1,2,3,4,5,6,7,8,0\n"),
                                 std::string("tag36h11:3,a.jpg,0,10,1,2,3,4,5,6,7,8,0\n")}) {
    WriteBytes(dir_ / "bad.csv", kMarkersHeader + ("\n" + row));
    EXPECT_ERROR(ReadMarkersCsv(dir_ / "bad.csv"), "bad.csv:2");
  }
  WriteBytes(dir_ / "bad.csv", "x,y\n1,2\n");
  EXPECT_ERROR(ReadMarkersCsv(dir_ / "bad.csv"), "is no table of markers");
}

}  // namespace
}  // namespace colmap_seapoint
