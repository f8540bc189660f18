#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/paths/survey_camera.h"
#include "examples/survey/paths/survey_path.h"
#include "examples/survey/render/lens_table.h"
#include "examples/survey/scene/noise.h"
#include "examples/survey/score.h"
#include "examples/survey/survey.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;

SurveyOptions SmallSurvey(SurveyPath path) {
  SurveyOptions options;
  options.path = path;
  options.width = 160;
  options.height = 120;
  options.num_strips = 1;
  options.images_per_strip = 4;
  options.num_threads = 2;
  return options;
}

Eigen::Vector3d Centre(const PosedImage& image) { return image.cam_from_world.OriginInSource(); }

Eigen::Vector3d Axis(const PosedImage& image) {
  return image.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

Eigen::Vector3d Right(const PosedImage& image) {
  return image.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitX();
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadPerDeg;
}

std::vector<PosedImage> SteadyImages(SurveyOptions options) {
  options.jitter = 0;
  return PlanSurvey(options).images;
}

TEST(SurveyPathsTest, ASwimmerLooksAheadAndDown) {
  SurveyOptions options = SmallSurvey(SurveyPath::kSwim);
  const auto images = SteadyImages(options);
  for (size_t i = 1; i < images.size(); ++i) {
    const Eigen::Vector3d way = (Centre(images[i]) - Centre(images[i - 1])).normalized();
    EXPECT_NEAR(AngleDeg(way, Axis(images[i])), 30, 1e-6);
    EXPECT_NEAR(Axis(images[i]).z(), -0.5, 1e-9);
    EXPECT_NEAR(Right(images[i]).z(), 0, 1e-9);
  }
  options.pitch_deg = 90;  // straight down: the strips
  const auto down = SteadyImages(options), strips = SteadyImages(SmallSurvey(SurveyPath::kStrips));
  for (size_t i = 0; i < down.size(); ++i) {
    EXPECT_EQ(down[i].cam_from_world.rotation.coeffs(), strips[i].cam_from_world.rotation.coeffs());
  }
}

TEST(SurveyPathsTest, RingsLookInwardsAllAround) {
  for (SurveyPath path : {SurveyPath::kCircle, SurveyPath::kStatue}) {
    SurveyOptions options = SmallSurvey(path);
    options.images_per_strip = 0;
    options.num_strips = 2;
    const auto images = SteadyImages(options);
    ASSERT_EQ(images.size(), 36u);  // 80 degrees of turn a picture's width, three quarters again
    std::set<int> quarters;
    for (const PosedImage& image : images) {
      const Eigen::Vector3d centre = Centre(image);
      // The axis meets the object's own.
      const Eigen::Vector2d side(-centre.y(), centre.x());
      EXPECT_NEAR(Axis(image).head<2>().dot(side), 0, 1e-9);
      EXPECT_LT(Axis(image).head<2>().dot(centre.head<2>()), 0);
      EXPECT_NEAR(Right(image).z(), 0, 1e-9);
      quarters.insert((centre.x() > 0) + 2 * (centre.y() > 0));
    }
    EXPECT_EQ(quarters.size(), 4u);
    options.forward_overlap = 0.98;
    EXPECT_EQ(SteadyImages(options).size(), 2 * 225u);
  }
}

TEST(SurveyPathsTest, AWallIsInspectedLevelAndUpright) {
  SurveyOptions options = SmallSurvey(SurveyPath::kWall);
  options.num_strips = 2;
  const auto images = SteadyImages(options);
  for (const PosedImage& image : images) {
    EXPECT_NEAR(AngleDeg(Axis(image), {0, 1, 0}), 0, 1e-6);
    const Eigen::Vector3d down =
        image.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitY();
    EXPECT_NEAR(AngleDeg(down, {0, 0, -1}), 0, 1e-6);
  }
  const Eigen::Vector3d sideways = Centre(images[1]) - Centre(images[0]);
  EXPECT_NEAR(sideways.x(), 0.25 * NominalGsd(options) * options.width, 1e-9);
  EXPECT_NEAR(sideways.tail<2>().norm(), 0, 1e-9);
  EXPECT_GT(Centre(images[4]).z(), Centre(images[3]).z() + 0.5);
}

TEST(SurveyPathsTest, ADiveGoesStraightDownAndSeesItsEpipole) {
  const SurveyOptions options = SmallSurvey(SurveyPath::kDescent);
  const auto images = SteadyImages(options);
  const double rise = 0.05 * options.relief;
  EXPECT_NEAR(Centre(images.front()).z() - rise, 6, 1e-9);
  EXPECT_NEAR(Centre(images.back()).z() - rise, 2, 1e-9);
  const SparseModel model = PlanSurvey(options);
  for (size_t i = 1; i < model.images.size(); ++i) {
    const auto epipole = model.cameras.at(1).ImgFromCam(model.images[i - 1].cam_from_world *
                                                        Centre(model.images[i]));
    ASSERT_TRUE(epipole);
    EXPECT_TRUE(model.cameras.at(1).InImage(*epipole));
  }
  SurveyOptions video = options;
  video.images_per_strip = 0;
  video.forward_overlap = 0.98;
  EXPECT_EQ(SteadyImages(video).size(), 56u);
}

TEST(SurveyPathsTest, RandomNamesAreTheStripsPicturesInAnotherOrder) {
  SurveyOptions options = SmallSurvey(SurveyPath::kStrips);
  options.images_per_strip = 12;
  const auto strips = PlanSurvey(options).images;
  options.path = SurveyPath::kRandom;
  const auto random = PlanSurvey(options).images;
  ASSERT_EQ(random.size(), strips.size());
  std::set<size_t> found;
  size_t num_in_place = 0;
  for (size_t i = 0; i < random.size(); ++i) {
    EXPECT_EQ(random[i].name, strips[i].name);
    EXPECT_EQ(random[i].image_id, i + 1);
    const auto same = std::find_if(strips.begin(), strips.end(), [&](const PosedImage& image) {
      return image.cam_from_world.translation == random[i].cam_from_world.translation;
    });
    ASSERT_NE(same, strips.end());
    found.insert(static_cast<size_t>(same - strips.begin()));
    num_in_place += same->name == random[i].name;
  }
  EXPECT_EQ(found.size(), strips.size());
  EXPECT_LT(num_in_place, 5u);
}

TEST(SurveyPathsTest, EverySecondPictureIsRolled) {
  SurveyOptions options = SmallSurvey(SurveyPath::kSwim);
  const auto level = PlanSurvey(options).images;
  options.roll_deg = 70;
  const auto rolled = PlanSurvey(options).images;
  for (size_t i = 0; i < level.size(); ++i) {
    EXPECT_LT((Centre(rolled[i]) - Centre(level[i])).norm(), 1e-9);
    EXPECT_NEAR(AngleDeg(Axis(rolled[i]), Axis(level[i])), 0, 1e-5);
    EXPECT_NEAR(AngleDeg(Right(rolled[i]), Right(level[i])), i % 2 == 1 ? 70 : 0, 1e-5);
  }
}

TEST(SurveyPathsTest, IllegalCombinationsNameThemselves) {
  EXPECT_THROW(ParseSurveyPath("spiral"), UsageError);
  EXPECT_EQ(ParseSurveyPath("wall"), SurveyPath::kWall);
  EXPECT_THROW(ParseSurveyCameraModel("PINHOLE"), UsageError);
  SurveyOptions options = SmallSurvey(SurveyPath::kSwim);
  options.images_per_strip = 0;
  EXPECT_NE(CheckSurveyOptions(options).find("--images_per_strip is 0"), std::string::npos);
  options = SmallSurvey(SurveyPath::kStatue);
  options.revisit = 1;
  EXPECT_NE(CheckSurveyOptions(options).find("--revisit is 1"), std::string::npos);
  options = SmallSurvey(SurveyPath::kStrips);
  options.field_of_view_deg = 120;
  EXPECT_NE(CheckSurveyOptions(options).find("--field_of_view is 120"), std::string::npos);
  options.camera_model = CameraModel::kOpenCVFisheye;
  EXPECT_EQ(CheckSurveyOptions(options), "");
}

TEST(SurveyPathsTest, TheFisheyeShowsItsFieldOfViewExactly) {
  for (double field_of_view : {90.0, 120.0, 150.0}) {
    SurveyOptions options;
    options.camera_model = CameraModel::kOpenCVFisheye;
    options.field_of_view_deg = field_of_view;
    const Camera camera = MakeSurveyCamera(options);
    const LensTable lens(PortCamera({}, camera));
    const auto left = lens.Ray(0.5, camera.PrincipalY());
    const auto right = lens.Ray(camera.width - 0.5, camera.PrincipalY());
    ASSERT_TRUE(left && right);
    EXPECT_NEAR(AngleDeg(left->direction, right->direction), field_of_view, 0.03 * field_of_view);
    int num_seen = 0;
    for (int k = 0; k < 2000; ++k) {
      const Eigen::Vector2d pixel(Uniform(Hash(1, k)) * camera.width,
                                  Uniform(Hash(2, k)) * camera.height);
      const auto ray = lens.Ray(pixel.x(), pixel.y());
      if (!ray) continue;
      ++num_seen;
      const auto back = camera.ImgFromCam(ray->direction);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - pixel).norm(), 2e-3);
    }
    EXPECT_GT(num_seen, field_of_view > 140 ? 1800 : 1999);
  }
}

// Every path: exact points on the surface, and of the picture's own brightness at their pixels.
class AnyPathTest : public testing::TestWithParam<SurveyPath> {};

TEST_P(AnyPathTest, TruthIsExactAndComesBackFromDisk) {
  const SurveyOptions options = SmallSurvey(GetParam());
  const SurveyTruth truth = MakeSurveyTruth(options);
  ASSERT_GT(truth.model.points3D.size(), 200u);
  const Camera& camera = truth.model.cameras.at(1);
  for (const auto& [id, point] : truth.model.points3D) {
    EXPECT_LT(truth.surface.Distance(point.xyz, 1), 1e-6);
    for (const auto& element : point.track) {
      const PosedImage& image = truth.model.images[element.image_id - 1];
      const Eigen::Vector2d pixel = image.points2D[element.point2D_idx];
      EXPECT_LT((*camera.ImgFromCam(image.cam_from_world * point.xyz) - pixel).norm(), 1e-9);
      EXPECT_LE((Centre(image) - point.xyz).norm(), truth.max_range);
    }
  }
  const std::filesystem::path dir =
      std::filesystem::temp_directory_path() /
      ("survey_paths_" + SurveyPathName(GetParam()) + std::to_string(getpid()));
  WriteSurveyTruth(dir, options, truth);
  const SurveyTruth back = ReadSurveyTruth(dir);
  std::filesystem::remove_all(dir);
  EXPECT_EQ(back.max_range, truth.max_range);
  EXPECT_EQ(back.surface.Object().Empty(), GetParam() != SurveyPath::kStatue);
  for (const auto& [id, point] : truth.model.points3D) {
    EXPECT_LT(back.surface.Distance(point.xyz, 1), 1e-6);
  }
}

TEST_P(AnyPathTest, TheExactPointsScoreAsExact) {
  const SurveyTruth truth = MakeSurveyTruth(SmallSurvey(GetParam()));
  std::vector<Eigen::Vector3f> points;
  for (const auto& [id, point] : truth.model.points3D) points.push_back(point.xyz.cast<float>());
  ScoreOptions options;
  options.truth_poses = true;
  const SurveyScore score = ScoreSurvey(truth, truth.model, {points, {}}, options);
  EXPECT_EQ(score.accuracy.share_1gsd, 1);
  EXPECT_EQ(score.own_accuracy.share_1gsd, 1);
  EXPECT_GT(score.parallax_seen_m2, 0);
  EXPECT_LE(score.parallax_seen_m2, score.twice_seen_m2 * (1 + 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Paths, AnyPathTest,
                         testing::Values(SurveyPath::kStrips, SurveyPath::kRandom,
                                         SurveyPath::kSwim, SurveyPath::kCircle,
                                         SurveyPath::kStatue, SurveyPath::kWall,
                                         SurveyPath::kDescent),
                         [](const auto& path) { return SurveyPathName(path.param); });

struct Agreement {
  int count = 0;           // of exact points that two of the first three pictures show
  double correlation = 0;  // of the brightness at their two pixels
};

// Pictures and truth are made of one scene: brightness at the two pixels of an exact point agrees.
Agreement AgreementOfPictures(const SurveyOptions& options) {
  constexpr uint32_t kNumPictures = 3;
  SurveyTruth truth = MakeSurveyTruth(options);
  truth.model.images.resize(std::min<size_t>(truth.model.images.size(), kNumPictures));
  std::vector<ColorImage> pictures;
  RenderSurvey(options, truth, [&](const PosedImage&, ColorImage&& picture) {
    pictures.push_back(std::move(picture));
  });
  const auto grey = [&](const SparsePoint::TrackElement& e) {
    const Eigen::Vector2d p = truth.model.images[e.image_id - 1].points2D[e.point2D_idx];
    return static_cast<double>(
        pictures[e.image_id - 1].At(std::min(static_cast<int>(p.x()), options.width - 1),
                                    std::min(static_cast<int>(p.y()), options.height - 1), 1));
  };
  Agreement agreement;
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (const auto& [id, point] : truth.model.points3D) {
    const auto &first = point.track[0], &second = point.track[1];
    if (first.image_id > kNumPictures || second.image_id > kNumPictures) continue;
    const double x = grey(first), y = grey(second);
    a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
    ++agreement.count;
  }
  const double n = agreement.count;
  agreement.correlation = (n * ab - a * b) / std::sqrt((n * aa - a * a) * (n * bb - b * b));
  return agreement;
}

SurveyOptions ClearSurvey(SurveyPath path) {
  SurveyOptions options = SmallSurvey(path);
  options.width = 320;
  options.height = 240;
  options.turbidity = 0;
  options.noise = 0;
  return options;
}

TEST(SurveyPathsTest, TwoPicturesShowTheSamePlaceAlikeOnEveryPath) {
  for (SurveyPath path : {SurveyPath::kSwim, SurveyPath::kCircle, SurveyPath::kStatue,
                          SurveyPath::kWall, SurveyPath::kDescent}) {
    SurveyOptions options = ClearSurvey(path);
    if (path == SurveyPath::kCircle || path == SurveyPath::kStatue) options.images_per_strip = 24;
    const Agreement agreement = AgreementOfPictures(options);
    ASSERT_GT(agreement.count, 100) << SurveyPathName(path);
    EXPECT_GT(agreement.correlation, 0.6) << SurveyPathName(path);
  }
}

TEST(SurveyPathsTest, PicturesOfAWideFisheyeShowTheSamePlaceAlike) {
  for (double field_of_view : {120.0, 150.0}) {
    SurveyOptions options = ClearSurvey(SurveyPath::kStrips);
    options.camera_model = CameraModel::kOpenCVFisheye;
    options.field_of_view_deg = field_of_view;
    const Agreement agreement = AgreementOfPictures(options);
    ASSERT_GT(agreement.count, 100) << field_of_view;
    EXPECT_GT(agreement.correlation, 0.6) << field_of_view;
  }
}

TEST(SurveyPathsTest, AWideFisheyeHasBlackCorners) {
  SurveyOptions options = SmallSurvey(SurveyPath::kStrips);
  options.camera_model = CameraModel::kOpenCVFisheye;
  options.field_of_view_deg = 150;
  options.images_per_strip = 1;
  options.noise = 0;
  RenderSurvey(options, MakeSurveyTruth(options), [&](const PosedImage&, ColorImage&& picture) {
    EXPECT_LT(picture.At(0, 0, 1), 5);
    EXPECT_GT(picture.At(options.width / 2, options.height / 2, 1), 20);
  });
}

// The statue's colours close around it: where its map begins and ends, straight before the first
// picture, brightness changes no more than beside it.
TEST(SurveyPathsTest, AStatueHasNoSeam) {
  SurveyOptions options = ClearSurvey(SurveyPath::kStatue);
  options.width = 640;
  options.height = 480;
  options.jitter = 0;
  SurveyTruth truth = MakeSurveyTruth(options);
  truth.model.images.resize(1);
  const Camera& camera = truth.model.cameras.at(1);
  const PosedImage& image = truth.model.images[0];
  const auto change = [&](const ColorImage& picture, double side) {  // across `side`, metres
    double sum = 0;
    for (double z = 0.2; z < 0.98; z += 0.01) {
      double grey[2];
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector3d target(0, side + (k == 0 ? -0.004 : 0.004),
                                     z * StatueHeight(options));
        const Eigen::Vector3d origin(10, target.y(), target.z());
        const auto hit = truth.surface.Trace(origin, {-1, 0, 0}, 0, 20);
        const auto pixel = camera.ImgFromCam(image.cam_from_world * hit->xyz);
        grey[k] = picture.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()), 1);
      }
      sum += std::abs(grey[1] - grey[0]);
    }
    return sum;
  };
  RenderSurvey(options, truth, [&](const PosedImage&, ColorImage&& picture) {
    double beside = 0;
    for (double side : {-0.16, -0.12, -0.08, -0.04, 0.04, 0.08, 0.12, 0.16}) {
      beside = std::max(beside, change(picture, side));
    }
    EXPECT_GT(beside, 0);
    EXPECT_LT(change(picture, 0), 1.4 * beside);  // with a seam: 1.75
  });
}

TEST(BestPairGsdTest, IsOfTheBestTwoWithParallax) {
  const auto at = [](double gsd, double angle_deg) {
    const double angle = angle_deg * kRadPerDeg;
    return Sighting{gsd, Eigen::Vector3d(std::sin(angle), 0, std::cos(angle))};
  };
  EXPECT_FALSE(BestPairGsd({}));
  EXPECT_FALSE(BestPairGsd({at(1, 0)}));
  EXPECT_FALSE(BestPairGsd({at(1, 0), at(2, 2.9)}));
  EXPECT_EQ(BestPairGsd({at(1, 0), at(2, 3.1)}), 2);
  EXPECT_EQ(BestPairGsd({at(5, 20), at(1, 0), at(2, 1), at(3, 4.5)}), 3);
}

}  // namespace
}  // namespace colmap_seapoint
