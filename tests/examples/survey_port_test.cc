// Rays through a port against plane geometry of its own: sums of sideways ways for a flat one,
// impact parameters about the centre for a dome, and bisection.
#include "examples/survey/paths/survey_port.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "examples/survey/paths/survey_path.h"
#include "examples/survey/render/lens_table.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {
namespace {

double Bisect(double low, double high, const std::function<double(double)>& rising) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (rising(middle) > 0 ? high : low) = middle;
  }
  return low;
}

// Sine of the angle in air, from the normal, at which light from a place comes through a flat port:
// the place lies `depth` before the pupil along the normal and `aside` of it.
double SineThroughFlat(const PortOptions& port, double depth, double aside) {
  return Bisect(0, 1, [&](double sine) {
    const auto tangent = [&](double index) {
      return sine / index / std::sqrt(1 - sine * sine / index / index);
    };
    return port.distance * tangent(1) + port.thickness * tangent(kGlassIndex) +
           (depth - port.distance - port.thickness) * tangent(kWaterIndex) - aside;
  });
}

// The angle in air, from the axis (pupil to the dome's centre, `off` metres), for a place in
// coordinates of that plane about the centre. n times the impact parameter is the same in air,
// glass and water.
double AngleThroughDome(const PortOptions& port, double off, double along, double aside) {
  return Bisect(0, 3.14, [&](double angle) {
    const double impact = -off * std::sin(angle);
    const double inner = port.radius - port.thickness, outer = port.radius;
    const double in_glass =
        angle - std::asin(impact / inner) + std::asin(impact / kGlassIndex / inner);
    const double in_water = in_glass - std::asin(impact / kGlassIndex / outer) +
                            std::asin(impact / kWaterIndex / outer);
    return along * std::sin(in_water) - aside * std::cos(in_water) - impact / kWaterIndex;
  });
}

// The direction in air by the above, for any port.
Eigen::Vector3d Independent(const PortOptions& port, const Eigen::Vector3d& point) {
  const double tilt = port.tilt_deg * 3.14159265358979323846 / 180;
  const Eigen::Vector3d centre(port.sideways, 0, port.decentring);
  const bool is_flat = port.kind == PortKind::kFlat;
  const Eigen::Vector3d axis = is_flat ? Eigen::Vector3d(std::sin(tilt), 0, std::cos(tilt))
                                       : Eigen::Vector3d(centre.normalized());
  const double depth = point.dot(axis);
  const Eigen::Vector3d aside = point - depth * axis;
  const double angle =
      is_flat ? std::asin(SineThroughFlat(port, depth, aside.norm()))
              : AngleThroughDome(port, centre.norm(), depth - centre.norm(), aside.norm());
  return std::cos(angle) * axis + std::sin(angle) * aside.normalized();
}

// The survey's camera with what a flat port makes longer made shorter, by hand.
Camera LensBehind(const PortOptions& port, Camera lens) {
  if (port.kind != PortKind::kFlat) return lens;
  for (const size_t k : {0, 1, 6, 7}) lens.params[k] /= kWaterIndex;
  lens.params[4] /= kWaterIndex * kWaterIndex;
  lens.params[5] /= kWaterIndex * kWaterIndex * kWaterIndex * kWaterIndex;
  return lens;
}

SurveyOptions ThroughPort(PortKind kind, double tilt_deg, double decentring, double sideways) {
  SurveyOptions options;
  options.width = 800;
  options.height = 600;
  options.images_per_strip = 3;
  options.num_threads = 1;
  options.port.kind = kind;
  options.port.tilt_deg = tilt_deg;
  options.port.decentring = decentring;
  options.port.sideways = sideways;
  return options;
}

const SurveyOptions kSurveys[] = {
    ThroughPort(PortKind::kFlat, 0, 0, 0), ThroughPort(PortKind::kFlat, 5, 0, 0),
    ThroughPort(PortKind::kDome, 0, 0.01, 0), ThroughPort(PortKind::kDome, 0, -0.015, 0.004)};

TEST(SurveyPortTest, GroundPointsAppearWherePlaneGeometryHasThem) {
  for (const SurveyOptions& options : kSurveys) {
    const SurveyTruth truth = MakeSurveyTruth(options);
    ASSERT_GT(truth.model.points3D.size(), 400u);
    const Camera lens = LensBehind(options.port, truth.model.cameras.at(1));
    const LensTable table(PortCamera(options.port, truth.model.cameras.at(1)));
    for (const PosedImage& image : truth.model.images) {
      for (size_t k = 0; k < image.points2D.size(); ++k) {
        const Eigen::Vector3d& xyz = truth.model.points3D.at(image.point3D_ids[k]).xyz;
        const Eigen::Vector3d in_cam = image.cam_from_world * xyz;
        const auto pixel = lens.ImgFromCam(Independent(options.port, in_cam));
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - image.points2D[k]).norm(), 1e-6);
        // The renderer's ray of that pixel meets the point.
        const auto ray = table.Ray(pixel->x(), pixel->y());
        ASSERT_TRUE(ray);
        const Eigen::Vector3d met = ray->origin + (in_cam.z() - ray->origin.z()) * ray->direction;
        EXPECT_LT((met - in_cam).norm(), 4e-3 * truth.gsd);
      }
    }
  }
}

// No pinhole sees what a flat port shows: nearer points on one ray of the far field lie elsewhere.
TEST(SurveyPortTest, RaysDoNotMeetInOnePoint) {
  const Camera camera = PlanSurvey(SurveyOptions()).cameras.at(1);
  PortOptions port;
  const Eigen::Vector3d direction(0.45, 0.3, 1);
  const auto move = [&](const PortOptions& through) {
    const PortCamera behind(through, camera);
    return (*behind.ImgFromCam(1 * direction) - *behind.ImgFromCam(8 * direction)).norm();
  };
  EXPECT_LT(move(port), 1e-9);
  port.kind = PortKind::kDome;
  EXPECT_LT(move(port), 1e-9);
  port.kind = PortKind::kFlat;
  EXPECT_GT(move(port), 1);
}

TEST(SurveyPortTest, BehindTheGlassIsNothing) {
  PortOptions port;
  port.kind = PortKind::kFlat;
  const Camera camera = PlanSurvey(SurveyOptions()).cameras.at(1);
  EXPECT_FALSE(PortCamera(port, camera).ImgFromCam({0, 0, 0.02}));
  EXPECT_FALSE(PortCamera(port, camera).ImgFromCam({0, 0, -1}));
  EXPECT_FALSE(PortCamera(port, camera).ImgFromCam({10, 0, 0.1}));
  port.kind = PortKind::kDome;
  EXPECT_FALSE(PortCamera(port, camera).ImgFromCam({0, 0, 0.05}));
  EXPECT_FALSE(PortCamera(port, camera).ImgFromCam({0.01, 0, -1}));
}

TEST(SurveyPortTest, FisheyeThroughAnyPortComesBack) {
  SurveyOptions options;
  options.camera_model = CameraModel::kOpenCVFisheye;
  options.field_of_view_deg = 75;
  const Camera camera = PlanSurvey(options).cameras.at(1);
  for (const SurveyOptions& survey : kSurveys) {
    const PortCamera behind(survey.port, camera);
    for (double x : {10.0, 500.0, 1300.0}) {
      const auto ray = behind.Ray({x, 400});
      ASSERT_TRUE(ray);
      for (double far : {0.3, 3.0}) {
        const auto back = behind.ImgFromCam(ray->origin + far * ray->direction);
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Eigen::Vector2d(x, 400)).norm(), 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
