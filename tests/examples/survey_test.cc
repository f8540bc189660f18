#include "examples/survey/survey.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/paths/survey_path.h"
#include "examples/survey/render/renderer.h"

namespace colmap_seapoint {
namespace {

SurveyOptions SmallSurvey() {
  SurveyOptions options;
  options.width = 200;
  options.height = 150;
  options.images_per_strip = 3;
  options.num_threads = 2;
  return options;
}

std::vector<ColorImage> Render(const SurveyOptions& options, const SurveyTruth& truth) {
  std::vector<ColorImage> pictures;
  RenderSurvey(options, truth, [&](const PosedImage&, ColorImage&& picture) {
    pictures.push_back(std::move(picture));
  });
  return pictures;
}

double MeanGrey(const ColorImage& picture) {
  double sum = 0;
  for (uint8_t v : picture.data) sum += v;
  return sum / static_cast<double>(picture.data.size());
}

TEST(SurveyPathTest, LawnMowerWithTurns) {
  SurveyOptions options = SmallSurvey();
  options.jitter = 0;
  const SparseModel model = PlanSurvey(options);
  ASSERT_EQ(model.images.size(), 6u);
  const double footprint_x = NominalGsd(options) * options.width;
  const double footprint_y = NominalGsd(options) * options.height;
  EXPECT_NEAR(footprint_x, 2 * 2 * std::tan(30 * 3.14159265358979 / 180), 1e-9);
  const auto centre = [&](size_t i) { return model.images[i].cam_from_world.OriginInSource(); };
  EXPECT_LT((centre(1) - centre(0) - Eigen::Vector3d(0.25 * footprint_y, 0, 0)).norm(), 1e-9);
  EXPECT_LT((centre(3) - centre(2) - Eigen::Vector3d(0, 0.5 * footprint_x, 0)).norm(), 1e-9);
  EXPECT_LT((centre(4) - centre(3) + Eigen::Vector3d(0.25 * footprint_y, 0, 0)).norm(), 1e-9);
  for (size_t i = 0; i < 6; ++i) {
    const Eigen::Matrix3d axes = model.images[i].cam_from_world.rotation.toRotationMatrix();
    EXPECT_LT((axes.row(2).transpose() - Eigen::Vector3d(0, 0, -1)).norm(), 1e-9);
    const double heading = i < 3 ? 1 : -1;  // image rows run against the vehicle's way
    EXPECT_LT((axes.row(1).transpose() - Eigen::Vector3d(-heading, 0, 0)).norm(), 1e-9);
  }
}

TEST(SurveyPathTest, RevisitComesBackToTheFirstStripAndChangesNothingBefore) {
  SurveyOptions options = SmallSurvey();
  const SparseModel strips = PlanSurvey(options);
  options.revisit = 3;
  const SparseModel model = PlanSurvey(options);
  ASSERT_EQ(model.images.size(), 9u);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(model.images[i].cam_from_world.translation,
              strips.images[i].cam_from_world.translation);
    EXPECT_EQ(model.images[i].cam_from_world.rotation.coeffs(),
              strips.images[i].cam_from_world.rotation.coeffs());
  }
  EXPECT_EQ(model.images[8].name, "seabed_0009.jpg");
  options.jitter = 0;
  const SparseModel steady = PlanSurvey(options);
  const double step = 0.25 * NominalGsd(options) * options.height;
  for (size_t i = 6; i < 9; ++i) {
    const Rigid3d& pose = steady.images[i].cam_from_world;
    const Eigen::Vector3d first = steady.images[i - 6].cam_from_world.OriginInSource();
    const Eigen::Vector3d way = pose.OriginInSource() - first;
    EXPECT_NEAR(way.x(), 0.5 * step, 1e-9);
    EXPECT_NEAR(way.y(), 0, 1e-9);
    EXPECT_NEAR(way.z(), -0.07 * options.altitude, 1e-9);
    // Image rows run against the heading, 35 degrees from the strip's.
    EXPECT_NEAR(pose.rotation.toRotationMatrix()(1, 0), -std::cos(35 * 3.14159265358979 / 180),
                1e-9);
  }
  options.revisit = options.images_per_strip + 1;
  EXPECT_NE(CheckSurveyOptions(options).find("--revisit is 4"), std::string::npos);
}

TEST(SurveyPathTest, IllegalOptionsNameThemselves) {
  SurveyOptions options = SmallSurvey();
  EXPECT_EQ(CheckSurveyOptions(options), "");
  options.forward_overlap = 1.5;
  EXPECT_NE(CheckSurveyOptions(options).find("--forward_overlap is 1.5"), std::string::npos);
  EXPECT_THROW(MakeSurveyTruth(options), UsageError);
}

TEST(LensTableTest, IsExactToTwoThousandthsOfAPixel) {
  SurveyOptions options;
  const Camera camera = PlanSurvey(options).cameras.at(1);
  const LensTable lens(PortCamera({}, camera));
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector2d pixel(Uniform(Hash(1, k)) * camera.width,
                                Uniform(Hash(2, k)) * camera.height);
    const auto back = camera.ImgFromCam(lens.Ray(pixel.x(), pixel.y())->direction);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - pixel).norm(), 2e-3);
  }
}

TEST(SurveyTest, ExactPointsLieOnTheSurfaceAndInTheirPictures) {
  const SurveyOptions options = SmallSurvey();
  const SurveyTruth truth = MakeSurveyTruth(options);
  EXPECT_GT(truth.model.points3D.size(), 800u);
  EXPECT_NEAR(truth.gsd, NominalGsd(options), 0.2 * NominalGsd(options));
  const Camera& camera = truth.model.cameras.at(1);
  for (const auto& [id, point] : truth.model.points3D) {
    EXPECT_NEAR(point.xyz.z(), truth.surface.Ground().Height(point.xyz.x(), point.xyz.y()), 1e-6);
    EXPECT_GE(point.track.size(), 2u);
    for (const auto& element : point.track) {
      const PosedImage& image = truth.model.images[element.image_id - 1];
      EXPECT_EQ(image.point3D_ids[element.point2D_idx], id);
      const Eigen::Vector2d pixel = image.points2D[element.point2D_idx];
      EXPECT_LT((*camera.ImgFromCam(image.cam_from_world * point.xyz) - pixel).norm(), 1e-9);
      // The ray of that pixel meets the surface there and nowhere before.
      const Rigid3d world_from_cam = image.cam_from_world.Inverse();
      const Eigen::Vector3d ray = world_from_cam.rotation * camera.CamFromImg(pixel)->homogeneous();
      const auto t = truth.surface.IntersectRay(world_from_cam.translation, ray, 0, 100);
      ASSERT_TRUE(t);
      EXPECT_LT((world_from_cam.translation + *t * ray - point.xyz).norm(), 0.1 * truth.gsd);
    }
  }
}

// Correlation of the pictures' brightness at the two places of every exact point.
TEST(SurveyTest, TwoPicturesShowTheSamePlaceAlike) {
  SurveyOptions options = SmallSurvey();
  options.noise = 0;
  options.turbidity = 0;
  const SurveyTruth truth = MakeSurveyTruth(options);
  const std::vector<ColorImage> pictures = Render(options, truth);
  const auto grey = [&](const SparsePoint::TrackElement& e) {
    const Eigen::Vector2d p = truth.model.images[e.image_id - 1].points2D[e.point2D_idx];
    const ColorImage& picture = pictures[e.image_id - 1];
    const int x = std::min(static_cast<int>(p.x()), options.width - 1);
    const int y = std::min(static_cast<int>(p.y()), options.height - 1);
    return static_cast<double>(picture.At(x, y, 1));
  };
  const auto correlation = [&](bool same_place) {
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (const auto& [id, point] : truth.model.points3D) {
      const double x = grey(point.track[0]);
      const double y =
          same_place ? grey(point.track[1]) : grey(truth.model.points3D.at(1 + id % 700).track[1]);
      n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
    }
    return (n * ab - a * b) / std::sqrt((n * aa - a * a) * (n * bb - b * b));
  };
  EXPECT_GT(correlation(true), 0.75);
  EXPECT_LT(correlation(false), 0.35);
}

TEST(SurveyTest, ThreadsDoNotShowAndSeedsDo) {
  SurveyOptions options = SmallSurvey();
  options.caustics = 0.5;
  options.marine_snow = 0.5;
  options.num_strips = 1;
  options.images_per_strip = 2;
  const SurveyTruth truth = MakeSurveyTruth(options);
  const std::vector<ColorImage> two = Render(options, truth);
  options.num_threads = 1;
  const std::vector<ColorImage> one = Render(options, MakeSurveyTruth(options));
  ASSERT_EQ(one.size(), 2u);
  for (size_t i = 0; i < 2; ++i) EXPECT_EQ(one[i].data, two[i].data);
  options.seed = 2;
  EXPECT_NE(Render(options, MakeSurveyTruth(options))[0].data, one[0].data);
}

TEST(SurveyTest, PicturesAreExposedLikeRealOnes) {
  for (double turbidity : {0.0, 0.3, 1.0}) {
    SurveyOptions options = SmallSurvey();
    options.turbidity = turbidity;
    options.num_strips = 1;
    options.images_per_strip = 2;
    for (const ColorImage& picture : Render(options, MakeSurveyTruth(options))) {
      EXPECT_GT(MeanGrey(picture), 40) << turbidity;
      EXPECT_LT(MeanGrey(picture), 170) << turbidity;
    }
  }
}

TEST(SurveyTest, OnlyARevisitIsWrittenDown) {
  const std::filesystem::path dir =
      std::filesystem::temp_directory_path() / ("revisit_test_" + std::to_string(getpid()));
  for (int revisit : {0, 2}) {
    SurveyOptions options = SmallSurvey();
    options.revisit = revisit;
    WriteSurveyTruth(dir, options, MakeSurveyTruth(options));
    std::ifstream file(dir / "truth" / "survey.json");
    const auto json = nlohmann::json::parse(file);
    EXPECT_EQ(json["options"].contains("revisit"), revisit > 0);
    EXPECT_EQ(json["num_images"], 6 + revisit);
    EXPECT_EQ(ReadSurveyTruth(dir).model.images.size(), static_cast<size_t>(6 + revisit));
  }
  std::filesystem::remove_all(dir);
}

TEST(SurveyTest, TruthComesBackFromDisk) {
  const SurveyOptions options = SmallSurvey();
  const SurveyTruth truth = MakeSurveyTruth(options);
  const std::filesystem::path dir =
      std::filesystem::temp_directory_path() / ("survey_test_" + std::to_string(getpid()));
  WriteSurveyTruth(dir, options, truth);
  const SurveyTruth back = ReadSurveyTruth(dir);
  EXPECT_EQ(back.gsd, truth.gsd);
  EXPECT_EQ(back.surface.Ground().Heights(), truth.surface.Ground().Heights());
  EXPECT_EQ(back.surface.Ground().Grid().MinX(), truth.surface.Ground().Grid().MinX());
  EXPECT_EQ(back.model.points3D.size(), truth.model.points3D.size());
  EXPECT_LT((back.model.images[4].cam_from_world.OriginInSource() -
             truth.model.images[4].cam_from_world.OriginInSource())
                .norm(),
            1e-9);
  std::filesystem::resize_file(dir / "truth" / "surface.bin", 1000);
  EXPECT_THROW(ReadSurveyTruth(dir), Error);
  std::filesystem::remove_all(dir);
  EXPECT_THROW(ReadSurveyTruth(dir), Error);
}

}  // namespace
}  // namespace colmap_seapoint
