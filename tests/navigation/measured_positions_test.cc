#include "colmap_seapoint/navigation/measured_positions.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

SparseModel ModelOf(int num_pictures) {
  SparseModel model;
  for (int i = 0; i < num_pictures; ++i) {
    PosedImage image;
    image.name = "p" + std::to_string(i) + ".jpg";
    model.images.push_back(image);
  }
  return model;
}

PictureRecords Gps(int num_pictures) {
  PictureRecords records;
  records.gps.heights = "heights from the GPS altitude";
  records.gps.positions.is_geographic = true;
  for (int i = 0; i < num_pictures; ++i) {
    records.gps.positions.positions["p" + std::to_string(i) + ".jpg"] = {-34.5, 150.9 + 1e-4 * i,
                                                                         0};
  }
  return records;
}

TEST(FindPositions, ExifWhereNothingElseIsGiven) {
  ScaleSources sources;
  const PositionSource found = FindPositions(sources, Gps(5), ModelOf(5));
  EXPECT_TRUE(found.is_there);
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.measured.crs, "EPSG:32756");
  EXPECT_NE(found.text.find("--positions_path none declines"), std::string::npos);
  sources.crs = "EPSG:28356";
  EXPECT_EQ(FindPositions(sources, Gps(5), ModelOf(5)).measured.crs, "EPSG:28356");
  EXPECT_FALSE(FindPositions(sources, {}, ModelOf(5)).is_there);
  EXPECT_NE(FindPositions(sources, Gps(2), ModelOf(5)).problem, "");
  sources.positions_path = kNoPositions;
  EXPECT_FALSE(FindPositions(sources, Gps(5), ModelOf(5)).is_there);
  sources.positions_path.clear();
  sources.rig_spacing = 0.1;
  EXPECT_FALSE(FindPositions(sources, Gps(5), ModelOf(5)).is_there);
}

TEST(Doubt, OfPositionsThatScatterOrContradict) {
  SimilarityEstimate estimate;
  estimate.scale_sigma = 0.05;
  estimate.position_used.assign(4, true);
  EXPECT_EQ(Doubt(estimate), "");
  estimate.scale_sigma = 0.2;
  estimate.position_rms = 7;
  EXPECT_NE(Doubt(estimate).find("scatter by 7.0 m"), std::string::npos);
  EXPECT_NE(Doubt(estimate).find("20 %"), std::string::npos);
  estimate.scale_sigma = 0.05;
  estimate.position_used = {true, false, false, false};
  EXPECT_NE(Doubt(estimate).find("contradict"), std::string::npos);
  estimate.problem = "no three positions agree";
  EXPECT_EQ(Doubt(estimate), estimate.problem);
}

}  // namespace
}  // namespace colmap_seapoint
