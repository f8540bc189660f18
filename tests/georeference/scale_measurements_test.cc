#include "colmap_seapoint/georeference/scale_measurements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/georeference/five_cameras.h"

namespace colmap_seapoint {
namespace {

// Five cameras in a row, 0.5 model units apart, that look down on targets 2 units below; in the
// model, z points down.
class Measurements : public FiveCameras {
 protected:
  Measurements() : FiveCameras(CenterOf) {
    model_.points3D[7].xyz = {0, 0, 2};
    model_.points3D[8].xyz = {0.3, 0.4, 2};
  }

  static Eigen::Vector3d CenterOf(uint32_t i) { return {0.5 * i - 1, i == 2 ? 0.1 : 0, 0}; }

  // "name,image,x,y" of a target at `xyz` as these pictures (from 1) show it.
  std::string MarksOf(const std::string& name, const Eigen::Vector3d& xyz,
                      const std::vector<int>& pictures, double error = 0) const {
    std::string lines;
    for (const int k : pictures) {
      const PosedImage& image = model_.images[static_cast<size_t>(k - 1)];
      const Eigen::Vector2d pixel =
          *model_.cameras.at(1).ImgFromCam(image.cam_from_world * xyz) + Eigen::Vector2d(error, 0);
      char text[100];
      std::snprintf(text, sizeof(text), "%s,%s,%.12g,%.12g\n", name.c_str(), image.name.c_str(),
                    pixel.x(), pixel.y());
      lines += text;
    }
    return lines;
  }

  ScaleMeasurements Gather(const StereoRig& rig = {}) {
    return GatherMeasurements(model_, sources_, sightings_, rig, 5, &report_);
  }
};

TEST_F(Measurements, NamesAreCheckedAgainstThePictures) {
  const std::vector<std::string> names = {"img1.jpg", "img2.jpg"};
  sources_.positions_path = Table("positions.csv", "image,x,y,z\nIMG1.JPG,1,2,3\n");
  EXPECT_ERROR(CheckScaleNames(sources_, names), "e.g. IMG1.JPG; write the names");
  sources_.positions_path = Table("positions.csv", "image,x,y,z\nimg1.jpg,1,2,3\nb.jpg,1,2,3\n");
  testing::internal::CaptureStderr();
  CheckScaleNames(sources_, names);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("are not there: b.jpg"), std::string::npos);
  sources_.positions_path = kNoPositions;
  CheckScaleNames(sources_, names);
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\na,b,1\n");
  sources_.targets_path = Table("targets.csv", "target,image,x,y\na,other.jpg,1,2\n");
  EXPECT_ERROR(CheckScaleNames(sources_, names), "targets.csv: none of the pictures");
}

TEST_F(Measurements, PositionsOfTheModelsPictures) {
  sources_.positions_path =
      Table("positions.csv",
            "image,x,y,z\nimg4.jpg,4,40,-4\nimg1.jpg,1,10,-1\nother.jpg,9,9,9\nimg3.jpg,3,30,-3\n");
  testing::internal::CaptureStderr();
  const ScaleMeasurements found = Gather();
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(found.position_names, (std::vector<std::string>{"img1.jpg", "img3.jpg", "img4.jpg"}));
  ASSERT_EQ(found.problem.positions.size(), 3u);
  EXPECT_EQ(found.problem.positions[1].metres, Eigen::Vector3d(3, 30, -3));
  EXPECT_LT((found.problem.positions[1].in_model - CenterOf(2)).norm(), 1e-12);
  EXPECT_EQ(found.problem.positions[1].sigma, Eigen::Vector3d::Zero());
  EXPECT_EQ(found.problem.seed, 5);
  EXPECT_EQ(found.units.frame, "local");
  EXPECT_TRUE(found.units.is_metric);
  EXPECT_EQ(found.units.offset, Eigen::Vector3d::Zero());
  EXPECT_NE(said.find("1 of its pictures are not in the model: other.jpg"), std::string::npos);
}

TEST_F(Measurements, SigmasOfATable) {
  sources_.positions_path =
      Table("positions.csv", "image,x,y,z,sigma_xy,sigma_z\nimg1.jpg,1,2,3,0.5,0.02\n");
  EXPECT_EQ(Gather().problem.positions[0].sigma, Eigen::Vector3d(0.5, 0.5, 0.02));
}

TEST_F(Measurements, LargeCoordinatesGetAnOffsetOfTheWholeTable) {
  sources_.positions_path =
      Table("positions.csv",
            "image,x,y,z\nimg1.jpg,512345,4312361,-12\nimg2.jpg,512348,4312362,-12\n"
            "of_another_model.jpg,512999,4312999,-30\n");
  const ScaleMeasurements found = Gather();
  EXPECT_EQ(found.units.offset, Eigen::Vector3d(512300, 4312400, 0));
  EXPECT_LT((found.problem.positions[0].metres - Eigen::Vector3d(45, -39, -12)).norm(), 1e-9);
}

TEST_F(Measurements, LatitudeAndLongitudeBecomeEastNorthUp) {
  sources_.positions_path = Table("positions.csv",
                                  "image,lat,lon,depth\nimg1.jpg,43,6,10\nimg2.jpg,43.00001,6,12\n"
                                  "img3.jpg,43,6.00001,10\n");
  const ScaleMeasurements found = Gather();
  EXPECT_EQ(found.units.frame, "east-north-up");
  ASSERT_TRUE(found.units.origin);
  EXPECT_NEAR(found.units.origin->latitude_deg, 43, 1e-9);
  EXPECT_NEAR(found.units.origin->longitude_deg, 6, 1e-9);
  const auto& positions = found.problem.positions;
  // A hundred-thousandth of a degree: 1.111 m to the north, 0.814 m to the east.
  EXPECT_NEAR((positions[1].metres - positions[0].metres).y(), 1.111, 1e-3);
  EXPECT_NEAR((positions[2].metres - positions[0].metres).x(), 0.815, 1e-3);
  EXPECT_NEAR((positions[1].metres - positions[0].metres).z(), -2, 1e-6);
}

// The median has moved with the pictures that came in.
TEST_F(Measurements, OriginAndOffsetOfBeforeAreKept) {
  FormerScale former;
  former.units.is_metric = true;
  former.units.frame = "east-north-up";
  former.units.origin = GeoPosition{43.00002, 5.00001, 0};
  former.metric_from_model.scale = 3;
  const auto gather = [&] {
    return GatherMeasurements(model_, sources_, sightings_, {}, 5, &report_, nullptr, &former);
  };
  sources_.positions_path = Table("positions.csv",
                                  "image,lat,lon,alt\nimg1.jpg,43.1,5.1,-3\n"
                                  "img2.jpg,43.1001,5.1,-3\nimg3.jpg,43.1001,5.1001,-3\n");
  const ScaleMeasurements found = gather();
  EXPECT_EQ(found.units.origin->latitude_deg, 43.00002);
  ASSERT_TRUE(found.problem.former);
  EXPECT_EQ(found.problem.former->scale, 3);
  EXPECT_GT(found.problem.positions[0].metres.norm(), 1000);
  // Of another kind: nothing of it counts.
  sources_.positions_path =
      Table("positions.csv", "image,x,y,z\nimg1.jpg,1,10,-1\nimg2.jpg,1,20,-1\n");
  EXPECT_FALSE(gather().problem.former);
}

TEST_F(Measurements, AProjectedFrame) {
  sources_.crs = "EPSG:32632";
  sources_.positions_path =
      Table("positions.csv", "image,lat,lon,alt\nimg1.jpg,43,9,0\nimg2.jpg,43.00001,9,0\n");
  const ScaleMeasurements found = Gather();
  EXPECT_EQ(found.units.frame, "projected");
  EXPECT_EQ(found.units.crs, "EPSG:32632");
  // On the central meridian of zone 32: 500 km east.
  EXPECT_NEAR(found.units.offset.x() + found.problem.positions[0].metres.x(), 500000, 1e-3);
  EXPECT_NEAR((found.problem.positions[1].metres - found.problem.positions[0].metres).y(),
              1.111 * 0.9996, 1e-3);
  sources_.crs = "EPSG:nothing";
  EXPECT_ERROR(Gather(), "EPSG:nothing");
  EXPECT_ERROR(CheckScaleTables(sources_), "EPSG:nothing");
}

TEST_F(Measurements, ATableOfOtherPicturesIsAnError) {
  sources_.positions_path = Table("positions.csv", "image,x,y,z\nDSC1.jpg,1,2,3\n");
  EXPECT_ERROR(Gather(), "img1.jpg");
}

TEST_F(Measurements, BarsBetweenPointsOfTheModel) {
  sources_.scale_bars_path =
      Table("bars.csv", "name1,name2,length_m,sigma_m\npoint:7,point:8,1.25,0.002\n");
  const ScaleMeasurements found = Gather();
  ASSERT_EQ(found.problem.lengths.size(), 1u);
  EXPECT_EQ(found.length_names[0], "point:7 - point:8");
  EXPECT_NEAR(found.problem.lengths[0].in_model, 0.5, 1e-12);
  EXPECT_EQ(found.problem.lengths[0].in_model_sigma, 0);
  EXPECT_EQ(found.problem.lengths[0].metres, 1.25);
  EXPECT_EQ(found.problem.lengths[0].sigma, 0.002);
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\npoint:7,point:99,1\n");
  EXPECT_ERROR(Gather(), "no 3D point 99");
}

TEST_F(Measurements, BarsBetweenTargets) {
  const Eigen::Vector3d a(0, 0.2, 2), b(0.4, -0.1, 2);
  sources_.targets_path =
      Table("targets.csv", "target,image,x,y\n" + MarksOf("A", a, {1, 2, 4, 5}) +
                               MarksOf("B", b, {2, 3, 4}) + MarksOf("A", a, {3}, 70));
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\nA,B,1\n");
  sources_.length_sigma = 0.004;
  const ScaleMeasurements found = Gather();
  ASSERT_EQ(found.problem.lengths.size(), 1u);
  EXPECT_NEAR(found.problem.lengths[0].in_model, (b - a).norm(), 1e-6);
  EXPECT_GT(found.problem.lengths[0].in_model_sigma, 1e-4);
  EXPECT_LT(found.problem.lengths[0].in_model_sigma, 1e-2);
  EXPECT_EQ(found.problem.lengths[0].sigma, 0.004);
  ASSERT_EQ(found.targets.size(), 2u);
  EXPECT_EQ(found.targets[0].name, "A");
  EXPECT_EQ(found.targets[0].num_marks, 5u);
  EXPECT_EQ(found.targets[0].num_used, 4u);
  EXPECT_LT(found.targets[0].rms_pixels, 1e-6);
  EXPECT_EQ(found.targets[1].problem, "");
}

TEST_F(Measurements, BarsWithoutTwoEndsInTheModelAreLeftOut) {
  sources_.targets_path =
      Table("targets.csv", "target,image,x,y\n" + MarksOf("A", {0, 0.2, 2}, {1, 2}) +
                               MarksOf("lonely", {0, 0, 2}, {4}) + "absent,other.jpg,5,5\n");
  sources_.scale_bars_path =
      Table("bars.csv", "name1,name2,length_m\nA,lonely,1\nabsent,A,2\npoint:7,point:8,1\n");
  const ScaleMeasurements found = Gather();
  EXPECT_EQ(found.length_names, std::vector<std::string>{"point:7 - point:8"});
  ASSERT_EQ(report_.left_out.size(), 2u);
  EXPECT_EQ(report_.left_out[0].name, "scale bar A - lonely");
  EXPECT_EQ(report_.left_out[0].reason,
            "target lonely is marked in 1 pictures of the model; 2 are needed at least");
  EXPECT_EQ(report_.left_out[1].name, "scale bar absent - A");
  EXPECT_NE(report_.left_out[1].reason.find("target absent is marked in 0 pictures"),
            std::string::npos);
}

TEST_F(Measurements, EndsThatCoincide) {
  model_.points3D[8].xyz = model_.points3D[7].xyz;
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\npoint:7,point:8,1\n");
  EXPECT_ERROR(Gather(), "its two ends coincide in the model");
}

TEST_F(Measurements, FaultsOfTargets) {
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\nA,B,1\n");
  EXPECT_ERROR(Gather(), "'A' is no target; give --targets_path");
  sources_.targets_path = Table("targets.csv", "target,image,x,y\nA,img1.jpg,1200.5,10\n");
  EXPECT_ERROR(Gather(), "the mark lies outside img1.jpg, which has 1200 x 900 pixels");
  sources_.targets_path =
      Table("targets.csv", "target,image,x,y\n" + MarksOf("A", {0, 0, 2}, {1, 2}));
  EXPECT_ERROR(Gather(), "'B' is no target; mark it in");
}

TEST_F(Measurements, TheSpacingOfARigIsTheMedianOfItsFrames) {
  sources_.rig_spacing = 0.12;
  EXPECT_ERROR(Gather(), "the model holds no two pictures that a rig took at once");
  StereoRig rig;
  rig.right_of = {1, -1, 3, -1, -1};
  rig.is_right = {0, 1, 0, 1, 0};
  const ScaleMeasurements found = Gather(rig);
  ASSERT_EQ(found.problem.lengths.size(), 1u);
  EXPECT_EQ(found.length_names[0], "rig (2 frames)");
  EXPECT_EQ(found.problem.lengths[0].metres, 0.12);
  // Of two values the larger; the third camera is 0.1 off the line.
  EXPECT_NEAR(found.problem.lengths[0].in_model, std::hypot(0.5, 0.1), 1e-12);
  EXPECT_GT(found.problem.lengths[0].in_model_sigma, 0);
}

TEST_F(Measurements, WhereTheCamerasLook) {
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\npoint:7,point:8,1\n");
  EXPECT_LT((Gather().problem.down_in_model - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  // All round: no direction.
  for (size_t i = 0; i < 5; ++i) {
    model_.images[i].cam_from_world.rotation =
        Eigen::AngleAxisd(1.2566 * static_cast<double>(i), Eigen::Vector3d::UnitX());
  }
  EXPECT_EQ(Gather().problem.down_in_model, Eigen::Vector3d::Zero());
}

TEST(ScaleSourcesTest, OptionsThatDoNotGoTogether) {
  ScaleSources sources;
  EXPECT_FALSE(sources.Any());
  EXPECT_EQ(sources.Check(), "");
  sources.targets_path = "t.csv";
  EXPECT_FALSE(sources.Any());
  EXPECT_NE(sources.Check().find("it needs scale_bars_path"), std::string::npos);
  sources.scale_bars_path = "b.csv";
  EXPECT_TRUE(sources.Any());
  EXPECT_EQ(sources.Check(), "");
  sources.crs = "EPSG:32632";
  EXPECT_NE(sources.Check().find("it needs positions_path"), std::string::npos);
  sources.positions_path = "p.csv";
  EXPECT_EQ(sources.Check(), "");
  ScaleSources rig;
  rig.rig_spacing = 0.1;
  EXPECT_TRUE(rig.Any());
}

TEST_F(Measurements, EveryTableIsCheckedBeforehand) {
  CheckScaleTables(sources_);
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\nA,B,-1\n");
  EXPECT_ERROR(CheckScaleTables(sources_), "bars.csv:2");
  sources_.scale_bars_path = Table("bars.csv", "name1,name2,length_m\nA,B,1\n");
  sources_.targets_path = Table("targets.csv", "target,picture,x,y\n");
  EXPECT_ERROR(CheckScaleTables(sources_), "targets.csv");
  sources_.targets_path.clear();
  sources_.positions_path = Table("positions.csv", "image,x,y,z\nimg1.jpg,1,2,nan\n");
  EXPECT_ERROR(CheckScaleTables(sources_), "positions.csv:2");
}

}  // namespace
}  // namespace colmap_seapoint
