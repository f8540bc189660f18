#include "examples/survey/control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

std::vector<std::vector<std::string>> Rows(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);  // the header
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

const SurveyTruth& Truth() {
  static const SurveyTruth truth = [] {
    SurveyOptions options;
    options.width = 200;
    options.height = 150;
    options.images_per_strip = 10;
    return MakeSurveyTruth(options);
  }();
  return truth;
}

TEST(Control, WithoutNoiseItIsTheTruth) {
  ControlOptions options;
  options.pixel_noise = options.position_noise = options.outlier_share = 0;
  const ControlTables tables = MakeControl(Truth(), options);
  std::map<std::string, const PosedImage*> images;
  for (const PosedImage& image : Truth().model.images) images[image.name] = &image;
  const auto positions = Rows(tables.positions);
  ASSERT_EQ(positions.size(), images.size());
  for (const auto& row : positions) {
    const Eigen::Vector3d position(std::stod(row[1]), std::stod(row[2]), std::stod(row[3]));
    EXPECT_LT((position - images.at(row[0])->cam_from_world.OriginInSource()).norm(), 1e-4);
  }
  // Every mark's ray meets the seabed at one and the same place, a bar's length from the other's.
  std::map<std::string, std::vector<Eigen::Vector3d>> places;
  for (const auto& row : Rows(tables.targets)) {
    const PosedImage& image = *images.at(row[1]);
    const auto on_plane = Truth()
                              .model.cameras.at(image.camera_id)
                              .CamFromImg({std::stod(row[2]), std::stod(row[3])});
    ASSERT_TRUE(on_plane);
    const Eigen::Vector3d centre = image.cam_from_world.OriginInSource();
    const Eigen::Vector3d direction =
        image.cam_from_world.rotation.conjugate() * on_plane->homogeneous();
    const auto t = Truth().surface.IntersectRay(centre, direction, 0.1, 10);
    ASSERT_TRUE(t);
    places[row[0]].push_back(centre + *t * direction);
  }
  ASSERT_EQ(places.size(), 2u);
  for (const auto& [name, of_target] : places) {
    EXPECT_GE(of_target.size(), 2u);
    for (const auto& place : of_target) EXPECT_LT((place - of_target[0]).norm(), 2e-4) << name;
  }
  const double length = (places["bar_a"][0] - places["bar_b"][0]).norm();
  EXPECT_NEAR(std::stod(Rows(tables.bars)[0][2]), length, 3e-4);
}

TEST(Control, NoiseAndOutliersAreAsLargeAsSaid) {
  ControlOptions options;
  options.position_noise = 0.2;
  options.outlier_share = 0.1;
  options.outlier_size = 50;
  const auto rows = Rows(MakeControl(Truth(), options).positions);
  int num_outliers = 0;
  double square = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3d position(std::stod(rows[i][1]), std::stod(rows[i][2]),
                                   std::stod(rows[i][3]));
    const double error =
        (position - Truth().model.images[i].cam_from_world.OriginInSource()).norm();
    if (error > 40) {
      ++num_outliers;
    } else {
      square += error * error;
    }
  }
  EXPECT_EQ(num_outliers, 2);
  EXPECT_NEAR(std::sqrt(square / (3.0 * 18)), 0.2, 0.06);
}

TEST(Control, TheSeedDecides) {
  ControlOptions options;
  const ControlTables first = MakeControl(Truth(), options), again = MakeControl(Truth(), options);
  EXPECT_EQ(first.targets, again.targets);
  EXPECT_EQ(first.positions, again.positions);
  options.seed = 2;
  EXPECT_NE(MakeControl(Truth(), options).positions, first.positions);
  EXPECT_NE(MakeControl(Truth(), options).targets, first.targets);
}

TEST(Control, ABarLongerThanTheSurveyIsRefused) {
  ControlOptions options;
  options.bar_length = 100;
  EXPECT_THROW(MakeControl(Truth(), options), Error);
  EXPECT_EQ(CheckControlOptions(options), "");
  options.outlier_share = 1.5;
  EXPECT_NE(CheckControlOptions(options), "");
}

}  // namespace
}  // namespace colmap_seapoint
