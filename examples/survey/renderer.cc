#include "examples/survey/renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr int kLensStep = 4;  // pixels
constexpr double kFarT = 1e3;

// Two strobes fore and aft of the camera, aimed down; metres in the camera frame.
const Eigen::Vector3d kStrobes[] = {{0.12, -0.55, -0.05}, {-0.12, 0.55, -0.05}};
constexpr float kAmbient = 0.35f;  // of the light at the planned altitude

}  // namespace

LensTable::LensTable(const Camera& camera) : nodes_x_(camera.width / kLensStep + 2) {
  const int nodes_y = camera.height / kLensStep + 2;
  nodes_.reserve(static_cast<size_t>(nodes_x_) * static_cast<size_t>(nodes_y));
  for (int j = 0; j < nodes_y; ++j) {
    for (int i = 0; i < nodes_x_; ++i) {
      const auto ray = camera.CamFromImg({double(i * kLensStep), double(j * kLensStep)});
      SEAPOINT_CHECK(ray.has_value());
      nodes_.push_back(*ray);
    }
  }
}

Eigen::Vector3d LensTable::Ray(double x, double y) const {
  const int i = static_cast<int>(x) / kLensStep, j = static_cast<int>(y) / kLensStep;
  const double u = x / kLensStep - i, v = y / kLensStep - j;
  const Eigen::Vector2d* top = nodes_.data() + j * nodes_x_ + i;
  const Eigen::Vector2d* bottom = top + nodes_x_;
  const Eigen::Vector2d ray =
      (1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * bottom[0] + u * bottom[1]);
  return ray.homogeneous();
}

Renderer::Renderer(const SurveyOptions& options, const Camera& camera, const HeightField& field,
                   AlbedoMap* albedo)
    : options_(options),
      camera_(camera),
      field_(&field),
      albedo_(albedo),
      lens_(camera),
      water_(MakeWater(options.turbidity, options.width)),
      gain_(ChooseGain()) {}

// Grey ground below the vehicle comes out at about a fifth of white; the white balance takes most
// of the water's colour away, as cameras do.
Eigen::Array3f Renderer::ChooseGain() const {
  constexpr float kGround = 0.24f, kTarget = 0.20f, kBalance = 0.8f;
  const float way = 2 * static_cast<float>(options_.altitude);
  const Eigen::Array3f seen = (-water_.attenuation * way).exp();
  const Eigen::Array3f balanced = seen.pow(kBalance) * std::pow(seen(1), 1 - kBalance);
  return kTarget / kGround / balanced;
}

// How much of the sky a place sees: dark in clefts and beside boulders.
float Renderer::OpenSky(const Eigen::Vector3d& point) const {
  constexpr double kOffsets[8][2] = {{.05, .01},  {-.01, .05}, {-.05, -.01}, {.01, -.05},
                                     {.02, -.02}, {.02, .02},  {-.02, .02},  {-.02, -.02}};
  double higher = 0;
  for (const auto& offset : kOffsets) {
    const double rise = field_->Height(point.x() + offset[0], point.y() + offset[1]) - point.z();
    higher += std::clamp(rise / std::hypot(offset[0], offset[1]), -0.3, 2.5);
  }
  return static_cast<float>(1 / (1 + 1.1 * std::max(0.0, higher / 8)));
}

Eigen::Array3f Renderer::Illumination(const Rigid3d& world_from_cam, const Eigen::Vector3d& point,
                                      const Eigen::Vector3d& normal, uint64_t seed) const {
  const float open = OpenSky(point);
  Eigen::Array3f light = Eigen::Array3f::Zero();
  for (const Eigen::Vector3d& strobe : kStrobes) {
    const Eigen::Vector3d to_light = world_from_cam * strobe - point;
    const double distance = to_light.norm();
    const double lambert = std::max(0.0, normal.dot(to_light)) / distance;
    const Eigen::Vector3d axis = -(world_from_cam.rotation * Eigen::Vector3d::UnitZ());
    const double beam = std::max(0.0, axis.dot(to_light) / distance);
    const double falloff = std::pow(options_.altitude / distance, 2) * beam;
    light += static_cast<float>(0.5 * (1 - kAmbient) * lambert * falloff) *
             (-water_.attenuation * static_cast<float>(distance)).exp();
  }
  float sky = kAmbient * (0.4f + 0.6f * static_cast<float>(normal.z()));
  if (options_.caustics > 0) {
    sky *= 1 + static_cast<float>(options_.caustics);
    sky *= Caustics(point, options_.caustics, seed);
  }
  light += sky * (-water_.attenuation * static_cast<float>(options_.altitude)).exp();
  return light * open;
}

// Four rays a pixel. The smooth ground around `point` says where they meet the surface; where it
// does not (edges), they are traced from the camera.
Eigen::Array3f Renderer::MeanAlbedo(const Rigid3d& world_from_cam, int x, int y,
                                    const Eigen::Vector3d& point,
                                    const Eigen::Vector3d& normal) const {
  const Eigen::Vector3d& origin = world_from_cam.translation;
  const double plane = normal.dot(point - origin);
  const double tolerance = 0.02 * field_->Grid().step;
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d ray = world_from_cam.rotation * lens_.Ray(x + (k % 2 == 0 ? 0.25 : 0.75),
                                                                    y + (k < 2 ? 0.25 : 0.75));
    const double approach = normal.dot(ray);
    double t = plane / approach;
    bool converged = false;
    for (int iteration = 0; iteration < 3 && approach < -0.05 && !converged; ++iteration) {
      const double error = origin.z() + t * ray.z() -
                           field_->Height(origin.x() + t * ray.x(), origin.y() + t * ray.y());
      t -= error * normal.z() / approach;
      converged = std::abs(error) < tolerance;
    }
    if (!converged) t = field_->IntersectRay(origin, ray, 0, kFarT).value_or(plane / approach);
    const Albedo albedo = albedo_->At(origin.x() + t * ray.x(), origin.y() + t * ray.y());
    sum += Eigen::Array3f(albedo.red, albedo.green, albedo.blue);
  }
  return 0.25f * sum;
}

Eigen::Array3f Renderer::PixelLight(const Rigid3d& world_from_cam, int x, int y,
                                    uint64_t seed) const {
  const Eigen::Vector3d& origin = world_from_cam.translation;
  const Eigen::Vector3d cam_ray = lens_.Ray(x + 0.5, y + 0.5);
  const Eigen::Vector3d ray = world_from_cam.rotation * cam_ray;
  const auto t = field_->IntersectRay(origin, ray, 0, kFarT);
  SEAPOINT_CHECK(t.has_value());  // the field covers every footprint
  const Eigen::Vector3d point = origin + *t * ray;
  const Eigen::Vector3d normal = field_->Normal(point.x(), point.y());

  const float distance = static_cast<float>((point - origin).norm());
  const Eigen::Array3f transmission = (-water_.attenuation * distance).exp();
  const Eigen::Array3f albedo = MeanAlbedo(world_from_cam, x, y, point, normal);
  const Eigen::Array3f direct =
      albedo * Illumination(world_from_cam, point, normal, seed) * transmission;
  const float cosine = static_cast<float>(1 / cam_ray.norm());
  const Eigen::Array3f veil = water_.veil * (1 - transmission.square()) * (0.4f + 0.6f * cosine);
  const float vignette = cosine * cosine * cosine;
  return (direct + veil * transmission) * gain_ * vignette;
}

ColorImage Renderer::Render(const PosedImage& image, int num_threads) {
  const Rectangle box = Footprint(camera_, image.cam_from_world, field_->MinHeight() - 0.01);
  albedo_->Prepare(box.min_x, box.min_y, box.max_x, box.max_y, num_threads);
  const Rigid3d world_from_cam = image.cam_from_world.Inverse();
  const uint64_t seed = Hash(static_cast<uint64_t>(options_.seed), 5003, image.image_id);
  FloatImage linear(camera_.width, camera_.height, 3);
  ParallelFor(num_threads, camera_.height, [&](int64_t y) {
    float* row = linear.Row(static_cast<int>(y));
    for (int x = 0; x < camera_.width; ++x) {
      const Eigen::Array3f light = PixelLight(world_from_cam, x, static_cast<int>(y), seed);
      std::copy_n(light.data(), 3, row + 3 * x);
    }
  });
  ScatterForward(water_, &linear);
  AddMarineSnow(options_.marine_snow, seed, &linear);
  return Expose(linear, options_.noise, Hash(seed, 1), num_threads);
}

}  // namespace colmap_seapoint
