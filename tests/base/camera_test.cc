#include "colmap_seapoint/base/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <utility>
#include <vector>

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

Camera TestCamera(CameraModel model, const std::vector<double>& distortion, bool off_centre = true,
                  double focal = 900) {
  Camera camera = MakeCamera(model, focal, 1360, 1024);
  const CameraModelInfo* info = FindCameraModel(static_cast<int>(model));
  const size_t first = info->has_single_focal ? 3 : 4;
  if (model == CameraModel::kEquirectangular) return camera;  // has nothing else
  if (off_centre) {
    camera.params[first - 2] += 11.5;
    camera.params[first - 1] -= 7.25;
    if (!info->has_single_focal) camera.params[1] = 1.01 * focal;
  }
  for (size_t i = 0; i < distortion.size(); ++i) camera.params[first + i] = distortion[i];
  return camera;
}

Eigen::Vector3d Direction(double angle_deg, double azimuth_deg) {
  const double angle = angle_deg * kPi / 180, azimuth = azimuth_deg * kPi / 180;
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
          std::cos(angle)};
}

// Largest error of ray -> pixel -> ray in units of the plane z = 1.
double WorstRoundTrip(const Camera& camera, double max_angle_deg) {
  double worst = 0;
  for (double angle = 0; angle <= max_angle_deg; angle += max_angle_deg / 23) {
    for (double azimuth = 0; azimuth < 360; azimuth += 17) {
      const Eigen::Vector3d ray = 3.5 * Direction(angle, azimuth);
      const auto pixel = camera.ImgFromCam(ray);
      if (!pixel) return std::numeric_limits<double>::infinity();
      const auto back = camera.CamFromImg(*pixel);
      if (!back) return std::numeric_limits<double>::infinity();
      worst = std::max(worst, (*back - ray.head<2>() / ray.z()).norm());
    }
  }
  return worst;
}

struct RoundTrip {
  CameraModel model;
  std::vector<double> distortion;
  double max_angle_deg;
};

class CameraRoundTripTest : public testing::TestWithParam<RoundTrip> {};

TEST_P(CameraRoundTripTest, ComesBack) {
  const RoundTrip& param = GetParam();
  EXPECT_LT(WorstRoundTrip(TestCamera(param.model, param.distortion), param.max_angle_deg), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    AllModels, CameraRoundTripTest,
    testing::Values(
        RoundTrip{CameraModel::kSimplePinhole, {}, 80}, RoundTrip{CameraModel::kPinhole, {}, 80},
        RoundTrip{CameraModel::kSimpleRadial, {-0.2}, 50},
        RoundTrip{CameraModel::kSimpleRadial, {0.9}, 60},
        RoundTrip{CameraModel::kRadial, {-0.35, 0.12}, 45},
        RoundTrip{CameraModel::kOpenCV, {-0.28, 0.09, 2e-3, -1.5e-3}, 42},
        RoundTrip{CameraModel::kOpenCV, {0.4, 0.3, 1e-2, 1e-2}, 45},
        RoundTrip{CameraModel::kOpenCVFisheye, {0.05, -0.02, 0.01, -0.002}, 80},
        RoundTrip{CameraModel::kOpenCVFisheye, {0, 0, 0, 0}, 89},
        RoundTrip{CameraModel::kFullOpenCV, {0.3, 0.1, 1e-3, 1e-3, 0.02, 0.6, 0.2, 0.03}, 55},
        RoundTrip{CameraModel::kFov, {0.9}, 80}, RoundTrip{CameraModel::kFov, {1.6}, 80},
        RoundTrip{CameraModel::kFov, {1e-2}, 60}, RoundTrip{CameraModel::kFov, {9.9e-3}, 60},
        RoundTrip{CameraModel::kFov, {1e-7}, 60}, RoundTrip{CameraModel::kFov, {0}, 60},
        RoundTrip{CameraModel::kSimpleRadialFisheye, {0.08}, 85},
        RoundTrip{CameraModel::kRadialFisheye, {0.05, -0.01}, 80},
        RoundTrip{CameraModel::kThinPrismFisheye,
                  {0.03, -0.01, 1e-3, -2e-3, 0.004, -0.001, 2e-3, 1e-3},
                  70},
        RoundTrip{CameraModel::kRadTanThinPrismFisheye,
                  {0.03, -0.01, 4e-3, -1e-3, 5e-4, -1e-4, 2e-3, -3e-3, 2e-3, -1e-3, 3e-3, 5e-4},
                  70},
        RoundTrip{CameraModel::kSimpleDivision, {-0.25}, 80},
        RoundTrip{CameraModel::kSimpleDivision, {0.2}, 45},
        RoundTrip{CameraModel::kDivision, {-0.4}, 80}, RoundTrip{CameraModel::kDivision, {0}, 80},
        RoundTrip{CameraModel::kSimpleFisheye, {}, 89}, RoundTrip{CameraModel::kFisheye, {}, 89},
        RoundTrip{CameraModel::kEucm, {0.6, 1.2}, 80}, RoundTrip{CameraModel::kEucm, {0, 1}, 80},
        RoundTrip{CameraModel::kEquirectangular, {}, 89}));

// What a camera sees at (x, y), it sees at (k x, k y) in a picture k times as large.
TEST_P(CameraRoundTripTest, ScaledByHalfOrThreefoldItSeesTheSame) {
  const RoundTrip& param = GetParam();
  const Camera camera = TestCamera(param.model, param.distortion);
  for (const double k : {0.5, 3.0}) {
    const Camera scaled = ScaledCamera(camera, static_cast<int>(k * camera.width),
                                       static_cast<int>(k * camera.height));
    EXPECT_EQ(scaled.width, k * camera.width);
    EXPECT_EQ(scaled.height, k * camera.height);
    for (double azimuth = 0; azimuth < 360; azimuth += 40) {
      const Eigen::Vector3d ray = Direction(0.7 * param.max_angle_deg, azimuth);
      const Eigen::Vector2d pixel = *camera.ImgFromCam(ray);
      EXPECT_LT((*scaled.ImgFromCam(ray) - k * pixel).norm(), 1e-9);
      EXPECT_LT((*scaled.CamFromImg(k * pixel) - *camera.CamFromImg(pixel)).norm(), 1e-8);
    }
  }
}

void ExpectSamePixels(const Camera& camera, bool fisheye, double max_angle_deg) {
  std::vector<cv::Point3d> points;
  for (double angle = 0; angle <= max_angle_deg; angle += max_angle_deg / 12) {
    for (double azimuth = 0; azimuth < 360; azimuth += 31) {
      const Eigen::Vector3d p = 2 * Direction(angle, azimuth);
      points.emplace_back(p.x(), p.y(), p.z());
    }
  }
  const cv::Mat k = (cv::Mat_<double>(3, 3) << camera.FocalX(), 0, camera.PrincipalX(), 0,
                     camera.FocalY(), camera.PrincipalY(), 0, 0, 1);
  // COLMAP and OpenCV both order k1 k2 p1 p2 k3 ... k6.
  const std::vector<double> distortion(camera.params.begin() + 4, camera.params.end());
  const cv::Mat zero = cv::Mat::zeros(3, 1, CV_64F);
  std::vector<cv::Point2d> expected;
  if (fisheye) {
    cv::fisheye::projectPoints(points, expected, zero, zero, k, distortion);
  } else {
    cv::projectPoints(points, zero, zero, k, distortion, expected);
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.ImgFromCam({points[i].x, points[i].y, points[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), expected[i].y, 1e-9);
  }
}

TEST(CameraTest, MatchesOpenCV) {
  ExpectSamePixels(TestCamera(CameraModel::kOpenCV, {-0.28, 0.09, 2e-3, -1.5e-3}), false, 40);
  ExpectSamePixels(
      TestCamera(CameraModel::kFullOpenCV, {0.3, 0.1, 1e-3, -2e-3, 0.02, 0.6, 0.2, 0.03}), false,
      50);
  ExpectSamePixels(TestCamera(CameraModel::kOpenCVFisheye, {0.05, -0.02, 0.01, -0.002}), true, 75);
}

TEST(CameraTest, ScaledSizes) {
  EXPECT_TRUE(AreScaledSizes(1360, 1024, 1360, 1024));
  EXPECT_TRUE(AreScaledSizes(1360, 1024, 680, 512));
  EXPECT_TRUE(AreScaledSizes(680, 512, 1360, 1024));
  // 4000 x 3000 in thirds, rounded, cut and rounded up; 1500 on the longer side.
  for (const int width : {1333, 1334}) EXPECT_TRUE(AreScaledSizes(4000, 3000, width, 1000));
  EXPECT_TRUE(AreScaledSizes(4003, 3001, 1500, 1125));
  EXPECT_FALSE(AreScaledSizes(4000, 3000, 1330, 1000));
  EXPECT_FALSE(AreScaledSizes(1360, 1024, 1024, 1360));  // turned
  EXPECT_FALSE(AreScaledSizes(1360, 1024, 1360, 1023));  // cut
  EXPECT_FALSE(AreScaledSizes(1360, 1024, 1359, 1024));
  EXPECT_FALSE(AreScaledSizes(1360, 1024, 1300, 1100));
  EXPECT_FALSE(AreScaledSizes(1920, 1080, 640, 480));
  EXPECT_FALSE(AreScaledSizes(0, 0, 640, 480));
}

TEST(CameraTest, ScalingWithRoundedSidesKeepsBothAxesExact) {
  const Camera camera = TestCamera(CameraModel::kPinhole, {});
  const Camera scaled = ScaledCamera(camera, 401, 302);
  const Eigen::Vector3d ray(0.3, -0.2, 1);
  const Eigen::Vector2d pixel = *camera.ImgFromCam(ray);
  EXPECT_NEAR(scaled.ImgFromCam(ray)->x(), pixel.x() * 401 / 1360, 1e-9);
  EXPECT_NEAR(scaled.ImgFromCam(ray)->y(), pixel.y() * 302 / 1024, 1e-9);
}

TEST(CameraTest, KnownValues) {
  const Camera radial = TestCamera(CameraModel::kRadial, {0.1, 0.01}, false, 1000);
  // r2 = 0.25: 1 + 0.1 * 0.25 + 0.01 * 0.0625 = 1.025625
  const auto pixel = radial.ImgFromCam({0.6, 0.8, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 680 + 1000 * 0.3 * 1.025625, 1e-9);
  EXPECT_NEAR(pixel->y(), 512 + 1000 * 0.4 * 1.025625, 1e-9);

  const Camera equidistant = TestCamera(CameraModel::kOpenCVFisheye, {}, false, 400);
  const auto sixty = equidistant.ImgFromCam(Direction(60, 90));
  ASSERT_TRUE(sixty);
  EXPECT_NEAR(sixty->x(), 680, 1e-9);
  EXPECT_NEAR(sixty->y(), 512 + 400 * kPi / 3, 1e-9);

  const Camera fov = TestCamera(CameraModel::kFov, {1.0}, false, 500);
  const auto forty_five = fov.ImgFromCam({1, 0, 1});
  ASSERT_TRUE(forty_five);
  EXPECT_NEAR(forty_five->x(), 680 + 500 * std::atan(2 * std::tan(0.5)), 1e-9);
  // Near zero COLMAP's series holds, sign and all: 1 + w^2 r^2 / 3 - w^2 / 12.
  const Camera flat = TestCamera(CameraModel::kFov, {5e-3}, false, 500);
  EXPECT_NEAR(flat.ImgFromCam({1, 0, 1})->x(), 680 + 500 * (1 + 25e-6 / 3 - 25e-6 / 12), 1e-9);
}

// By hand from the definitions that COLMAP's source states.
TEST(CameraTest, KnownValuesOfTheNewerModels) {
  // Division: x = p / (1 + k |p|^2) holds the picture's p; here p = (0.5, 0): 0.5 / 0.9 = 0.5556.
  const Camera division = TestCamera(CameraModel::kDivision, {-0.4}, false, 1000);
  EXPECT_NEAR(division.ImgFromCam({0.5 / 0.9, 0, 1})->x(), 680 + 1000 * 0.5, 1e-9);
  EXPECT_EQ(TestCamera(CameraModel::kSimpleDivision, {0.5}, false).ImgFromCam({1, 1, 1}),
            std::nullopt);  // 4 k r^2 > 1
  // 1 / (0.6 sqrt(1.2 * 0.25 + 1) + 0.4)
  const Camera eucm = TestCamera(CameraModel::kEucm, {0.6, 1.2}, false, 1000);
  EXPECT_NEAR(eucm.ImgFromCam({0, 1, 2})->y(), 512 + 1000 * 0.5 / (0.6 * std::sqrt(1.3) + 0.4),
              1e-9);
  const Camera fisheye = TestCamera(CameraModel::kSimpleFisheye, {}, false, 400);
  EXPECT_NEAR(fisheye.ImgFromCam(Direction(60, 0))->x(), 680 + 400 * kPi / 3, 1e-9);
  // theta = atan(0.5); radial first, then p0 (along x), s0 and s1 of the point so found.
  const Camera aria = TestCamera(CameraModel::kRadTanThinPrismFisheye,
                                 {0.1, 0, 0, 0, 0, 0, 0.01, 0, 0.02, 0.03, 0, 0}, false, 1000);
  const double theta = std::atan(0.5), x = theta * (1 + 0.1 * theta * theta), r2 = x * x;
  EXPECT_NEAR(aria.ImgFromCam({0.5, 0, 1})->x(),
              680 + 1000 * (x + 0.01 * 3 * r2 + 0.02 * r2 + 0.03 * r2 * r2), 1e-9);
  EXPECT_NEAR(aria.ImgFromCam({0.5, 0, 1})->y(), 512, 1e-9);
  // The whole sphere: 45 degrees to the right is an eighth of the width, 45 down a quarter of the
  // height.
  const Camera sphere = MakeCamera(CameraModel::kEquirectangular, 900, 1600, 800);
  EXPECT_NEAR(sphere.ImgFromCam({1, 0, 1})->x(), 1000, 1e-9);
  EXPECT_NEAR(sphere.ImgFromCam({0, 3, 3})->y(), 600, 1e-9);
  EXPECT_NEAR(sphere.ImgFromCam({1, std::sqrt(2.0), 1})->y(), 600, 1e-9);
  EXPECT_EQ(sphere.CamFromImg({1300, 400}), std::nullopt);  // behind
}

TEST(CameraTest, BehindOrNotFiniteIsNothing) {
  for (int id = 0; id <= 17; ++id) {
    const Camera camera = MakeCamera(static_cast<CameraModel>(id), 900, 1360, 1024);
    EXPECT_FALSE(camera.ImgFromCam({0.1, 0.1, -1}));
    EXPECT_FALSE(camera.ImgFromCam({0.1, 0.1, 0}));
    EXPECT_FALSE(camera.ImgFromCam({std::nan(""), 0.1, 1}));
    EXPECT_FALSE(camera.CamFromImg({std::nan(""), 0}));
    const auto axis = camera.CamFromImg({680, 512});
    ASSERT_TRUE(axis);
    EXPECT_LT(axis->norm(), 1e-12);
  }
}

TEST(CameraTest, PixelsThatNoRayReachesAreNothing) {
  // r (1 - 0.2 r^2) peaks at r = 1.29 with 0.86: no ray lands 1.0 focal lengths off the axis.
  const Camera barrel = TestCamera(CameraModel::kSimpleRadial, {-0.2}, false, 100);
  EXPECT_FALSE(barrel.CamFromImg({680 + 100, 512}));
  EXPECT_TRUE(barrel.CamFromImg({680 + 86, 512}));
  // An equidistant fisheye sees sideways at 90 degrees.
  const Camera fisheye = TestCamera(CameraModel::kSimpleRadialFisheye, {0}, false, 100);
  EXPECT_TRUE(fisheye.CamFromImg({680 + 156, 512}));
  EXPECT_FALSE(fisheye.CamFromImg({680 + 158, 512}));
}

TEST(CameraTest, FoldedLensGivesTheRayNearestTheAxis) {
  // Folds at r = 1, rises again beyond 3: the cubic has up to three solutions, one is real optics.
  const Camera camera = TestCamera(CameraModel::kRadial, {-0.37, 0.0222}, false, 100);
  for (double r = 0.05; r < 0.95; r += 0.05) {
    const auto pixel = camera.ImgFromCam({r, 0, 1});
    const auto back = camera.CamFromImg(*pixel);
    ASSERT_TRUE(back) << r;
    EXPECT_NEAR(back->x(), r, 1e-8);
  }
}

TEST(CameraTest, ModelTable) {
  for (int id = 0; id <= 17; ++id) {
    const CameraModelInfo* info = FindCameraModel(id);
    ASSERT_NE(info, nullptr);
    EXPECT_EQ(static_cast<int>(info->model), id);
    EXPECT_EQ(FindCameraModel(std::string(info->name)), info);
    const Camera camera = MakeCamera(info->model, 900, 1360, 1024);
    EXPECT_EQ(camera.params.size(), static_cast<size_t>(info->num_params));
    if (info->model != CameraModel::kEquirectangular) {
      EXPECT_EQ(camera.FocalX(), 900);
      EXPECT_EQ(camera.FocalY(), 900);
    }
    EXPECT_EQ(camera.PrincipalX(), 680);
    EXPECT_EQ(camera.PrincipalY(), 512);
  }
  EXPECT_EQ(FindCameraModel(-1), nullptr);
  EXPECT_EQ(FindCameraModel(18), nullptr);
  EXPECT_EQ(FindCameraModel("UNKNOWN"), nullptr);
  EXPECT_EQ(CameraModelNames().substr(0, 23), "SIMPLE_PINHOLE, PINHOLE");
}

}  // namespace
}  // namespace colmap_seapoint
