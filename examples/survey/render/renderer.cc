#include "examples/survey/render/renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr double kFarT = 1e3;
constexpr size_t kMaxAlbedoBytes = size_t{768} << 20;

// Two strobes fore and aft of the camera, aimed down; metres in the camera frame.
const Eigen::Vector3d kStrobes[] = {{0.12, -0.55, -0.05}, {-0.12, 0.55, -0.05}};
constexpr float kBlackPrint = 0.04f, kWhitePrint = 0.75f;  // albedo of the boards
constexpr float kAmbient = 0.35f;                          // of the light at the planned altitude

AlbedoMap GroundColours(const Surface& surface, const Seabed& seabed) {
  const GridSpec& grid = surface.Ground().Grid();
  return AlbedoMap(seabed, grid.MinX(), grid.MinY(), grid.MaxX(), grid.MaxY(), kMaxAlbedoBytes);
}

// The object wears the seabed's colours of another place. Around it they close: over this share of
// the way its first columns come out of what lies behind the last one.
constexpr double kObjectTexture = 500;  // metres away, in x and y
constexpr double kClosingShare = 0.125;

double WayAround(const Sheet& object) { return (object.NumX() - 1) * object.Step(); }

std::unique_ptr<AlbedoMap> ObjectColours(const Sheet& object, const Seabed& seabed,
                                         int num_threads) {
  if (object.Empty()) return nullptr;
  const double min = kObjectTexture, max_y = min + object.NumY() * object.Step(),
               max_x = min + object.Step() + (1 + kClosingShare) * WayAround(object);
  auto colours = std::make_unique<AlbedoMap>(seabed, min, min, max_x, max_y, kMaxAlbedoBytes);
  colours->Prepare(min, min, max_x, max_y, num_threads);
  return colours;
}

Eigen::Array3f ColourAt(const AlbedoMap& colours, double x, double y) {
  const Albedo albedo = colours.At(x, y);
  return {albedo.red, albedo.green, albedo.blue};
}

// Grey ground below the vehicle comes out at about a fifth of white; the white balance takes most
// of the water's colour away, as cameras do.
Eigen::Array3f ChooseGain(const SurveyOptions& options, const Water& water) {
  constexpr float kGround = 0.24f, kTarget = 0.20f, kBalance = 0.8f;
  const float way = 2 * static_cast<float>(options.altitude);
  const Eigen::Array3f seen = (-water.attenuation * way).exp();
  const Eigen::Array3f balanced = seen.pow(kBalance) * std::pow(seen(1), 1 - kBalance);
  return kTarget / kGround / balanced;
}

// Where the distance changes from picture to picture, so does the exposure: green comes to the
// same mean in all.
void ChooseExposure(FloatImage* linear) {
  constexpr double kMean = 0.15, kMin = 0.3, kMax = 8;
  double sum = 0;
  for (size_t k = 1; k < linear->data.size(); k += 3) sum += static_cast<double>(linear->data[k]);
  const double mean = 3 * sum / static_cast<double>(linear->data.size());
  const auto factor = static_cast<float>(std::clamp(kMean / std::max(mean, 1e-6), kMin, kMax));
  for (float& value : linear->data) value *= factor;
}

}  // namespace

Renderer::Renderer(const SurveyOptions& options, const Camera& camera, const Surface& surface,
                   const std::vector<MarkerBoard>& boards, const Seabed& seabed)
    : options_(options),
      camera_(options.port, camera),
      surface_(&surface),
      boards_(&boards),
      ground_colours_(GroundColours(surface, seabed)),
      object_colours_(ObjectColours(surface.Object(), seabed, options.num_threads)),
      lens_(camera_),
      water_(MakeWater(options.turbidity, options.width)),
      gain_(ChooseGain(options, water_)) {}

// How much of the sky a place sees: dark in clefts and beside boulders.
float Renderer::OpenSky(const SurfaceHit& hit) const {
  if (hit.part == SurfacePart::kObject) return 1;
  const Eigen::Vector3d point = surface_->InGround(hit.xyz);
  constexpr double kOffsets[8][2] = {{.05, .01},  {-.01, .05}, {-.05, -.01}, {.01, -.05},
                                     {.02, -.02}, {.02, .02},  {-.02, .02},  {-.02, -.02}};
  double higher = 0;
  for (const auto& offset : kOffsets) {
    const double rise =
        surface_->Ground().Height(point.x() + offset[0], point.y() + offset[1]) - point.z();
    higher += std::clamp(rise / std::hypot(offset[0], offset[1]), -0.3, 2.5);
  }
  return static_cast<float>(1 / (1 + 1.1 * std::max(0.0, higher / 8)));
}

Eigen::Array3f Renderer::Illumination(const View& view, const SurfaceHit& hit) const {
  const Rigid3d& world_from_cam = view.world_from_cam;
  const Eigen::Vector3d &point = hit.xyz, &normal = hit.normal;
  const float open = OpenSky(hit);
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
  // Overhangs get what the ground throws back.
  float sky = kAmbient * std::max(0.15f, 0.4f + 0.6f * static_cast<float>(normal.z()));
  if (options_.caustics > 0) {
    sky *= 1 + static_cast<float>(options_.caustics);
    sky *= Caustics(point, options_.caustics, view.seed);
  }
  light += sky * (-water_.attenuation * static_cast<float>(options_.altitude)).exp();
  return light * open;
}

// Where a ray through the pixel of `point` meets the ground. The smooth ground around the point
// says so; where it does not (edges), the ray is traced from the camera. All in the ground's frame.
Eigen::Vector2d Renderer::GroundPlace(const View& view, const WaterRay& cam_ray,
                                      const Eigen::Vector3d& point,
                                      const Eigen::Vector3d& normal) const {
  const HeightField& ground = surface_->Ground();
  const Eigen::Vector3d origin = view.ground_from_cam * cam_ray.origin;
  const double plane = normal.dot(point - origin);
  const double tolerance = 0.02 * surface_->CellSize();
  const Eigen::Vector3d ray = view.ground_from_cam.rotation * cam_ray.direction;
  const double approach = normal.dot(ray);
  double t = plane / approach;
  bool converged = false;
  for (int iteration = 0; iteration < 3 && approach < -0.05 && !converged; ++iteration) {
    const double error = origin.z() + t * ray.z() -
                         ground.Height(origin.x() + t * ray.x(), origin.y() + t * ray.y());
    t -= error * normal.z() / approach;
    converged = std::abs(error) < tolerance;
  }
  if (!converged) t = ground.IntersectRay(origin, ray, 0, kFarT).value_or(plane / approach);
  return {std::clamp(origin.x() + t * ray.x(), view.coloured.min_x, view.coloured.max_x),
          std::clamp(origin.y() + t * ray.y(), view.coloured.min_y, view.coloured.max_y)};
}

// Rays a pixel, across and down: two, and where the pixel covers many nodes, two for each of them.
Eigen::Array2i Renderer::SamplesOf(const View& view, int x, int y, const SurfaceHit& hit) const {
  if (!ShowsOpenWater(options_)) return {2, 2};
  constexpr int kMost = 16;
  Eigen::Array2i samples(2, 2);
  for (int axis = 0; axis < 2; ++axis) {
    const auto next = lens_.Ray(x + (axis == 0 ? 1.5 : 0.5), y + (axis == 1 ? 1.5 : 0.5));
    if (!next) continue;
    const Eigen::Vector3d origin = view.world_from_cam * next->origin;
    const Eigen::Vector3d ray = view.world_from_cam.rotation * next->direction;
    const double t =
        hit.normal.dot(hit.xyz - origin) / std::min(hit.normal.dot(ray), -1e-3 * ray.norm());
    const double way = (origin + t * ray - hit.xyz).norm() / surface_->CellSize();
    samples[axis] = static_cast<int>(std::clamp(std::ceil(2 * way), 2.0, double{kMost}));
  }
  return samples;
}

Eigen::Array3f Renderer::GroundColour(const Eigen::Vector2d& place) const {
  for (const MarkerBoard& board : *boards_) {
    const auto shade = board.ShadeAt(place.x(), place.y());
    if (shade) return Eigen::Array3f::Constant(kBlackPrint + *shade * (kWhitePrint - kBlackPrint));
  }
  return ColourAt(ground_colours_, place.x(), place.y());
}

Eigen::Array3f Renderer::ObjectColour(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d texture = place.array() + kObjectTexture;
  const Eigen::Array3f here = ColourAt(*object_colours_, texture.x(), texture.y());
  const double around = WayAround(surface_->Object()), closing = kClosingShare * around;
  if (place.x() >= closing) return here;
  const Eigen::Array3f behind = ColourAt(*object_colours_, texture.x() + around, texture.y());
  return behind + static_cast<float>(place.x() / closing) * (here - behind);
}

Eigen::Array3f Renderer::MeanAlbedo(const View& view, int x, int y, const SurfaceHit& hit) const {
  const bool is_object = hit.part == SurfacePart::kObject;
  const Eigen::Array2i samples = SamplesOf(view, x, y, hit);
  const Eigen::Vector3d point = surface_->InGround(hit.xyz);
  const Eigen::Vector3d normal =
      surface_->WorldFromGround().rotation.vec().isZero(0)
          ? hit.normal
          : Eigen::Vector3d(surface_->WorldFromGround().rotation.conjugate() * hit.normal);
  Eigen::Array3f sum = Eigen::Array3f::Zero();
  for (int k = 0; k < samples.prod(); ++k) {
    const auto cam_ray =
        lens_.Ray(x + (k % samples[0] + 0.5) / samples[0], y + (k / samples[0] + 0.5) / samples[1]);
    Eigen::Vector2d place = hit.texture;
    if (cam_ray && is_object) {
      const auto there = surface_->Object().IntersectRay(
          view.world_from_cam * cam_ray->origin, view.world_from_cam.rotation * cam_ray->direction,
          0.5 * hit.t, 1.5 * hit.t);
      if (there) place = surface_->Object().Step() * there->lattice;
    } else if (cam_ray) {
      place = GroundPlace(view, *cam_ray, point, normal);
    }
    sum += is_object ? ObjectColour(place) : GroundColour(place);
  }
  return 1.0f / static_cast<float>(samples.prod()) * sum;
}

Eigen::Array3f Renderer::PixelLight(const View& view, int x, int y) const {
  const auto cam_ray = lens_.Ray(x + 0.5, y + 0.5);
  if (!cam_ray) return Eigen::Array3f::Zero();
  const bool is_open = ShowsOpenWater(options_);
  const Eigen::Vector3d origin = view.world_from_cam * cam_ray->origin;
  const auto hit =
      surface_->Trace(origin, view.world_from_cam.rotation * cam_ray->direction, 0, kFarT);
  SEAPOINT_CHECK(hit || is_open);  // the field covers every footprint
  const float cosine = static_cast<float>(1 / cam_ray->direction.norm());
  const float vignette = camera_.InWater().model == CameraModel::kOpenCVFisheye
                             ? std::sqrt(cosine)
                             : cosine * cosine * cosine;
  const double range = MaxRange(options_);
  const float distance = hit ? static_cast<float>((hit->xyz - origin).norm()) : 0.0f;
  if (!hit || (is_open && distance >= kFadeOut * range)) return water_.open * gain_ * vignette;

  const Eigen::Array3f transmission = (-water_.attenuation * distance).exp();
  const Eigen::Array3f albedo = MeanAlbedo(view, x, y, *hit);
  const Eigen::Array3f direct = albedo * Illumination(view, *hit) * transmission;
  const Eigen::Array3f veil = water_.veil * (1 - transmission.square()) * (0.4f + 0.6f * cosine);
  const Eigen::Array3f light = (direct + veil * transmission) * gain_ * vignette;
  if (!is_open) return light;
  const float fade =
      SmoothStep(static_cast<float>(range), static_cast<float>(kFadeOut * range), distance);
  return light * (1 - fade) + water_.open * (1 - transmission * (1 - fade)) * gain_ * vignette;
}

Renderer::View Renderer::Prepare(const PosedImage& image, int num_threads) {
  View view;
  view.world_from_cam = image.cam_from_world.Inverse();
  const Rigid3d& world_from_ground = surface_->WorldFromGround();
  const bool is_turned = !world_from_ground.rotation.vec().isZero(0);
  const Rigid3d cam_from_ground =
      is_turned ? image.cam_from_world * world_from_ground : image.cam_from_world;
  view.ground_from_cam = is_turned ? cam_from_ground.Inverse() : view.world_from_cam;
  view.seed = Hash(static_cast<uint64_t>(options_.seed), 5003, image.image_id);
  view.coloured = Footprint(camera_, cam_from_ground, surface_->Ground().MinHeight() - 0.01,
                            kFadeOut * MaxRange(options_));
  const GridSpec& grid = surface_->Ground().Grid();
  view.coloured.min_x = std::clamp(view.coloured.min_x, grid.MinX(), grid.MaxX());
  view.coloured.max_x = std::clamp(view.coloured.max_x, grid.MinX(), grid.MaxX());
  view.coloured.min_y = std::clamp(view.coloured.min_y, grid.MinY(), grid.MaxY());
  view.coloured.max_y = std::clamp(view.coloured.max_y, grid.MinY(), grid.MaxY());
  ground_colours_.Prepare(view.coloured.min_x, view.coloured.min_y, view.coloured.max_x,
                          view.coloured.max_y, num_threads);
  return view;
}

ColorImage Renderer::Render(const PosedImage& image, int num_threads) {
  const View view = Prepare(image, num_threads);
  FloatImage linear(camera_.InWater().width, camera_.InWater().height, 3);
  ParallelFor(num_threads, camera_.InWater().height, [&](int64_t y) {
    float* row = linear.Row(static_cast<int>(y));
    for (int x = 0; x < camera_.InWater().width; ++x) {
      const Eigen::Array3f light = PixelLight(view, x, static_cast<int>(y));
      std::copy_n(light.data(), 3, row + 3 * x);
    }
  });
  ScatterForward(water_, &linear);
  if (ShowsOpenWater(options_)) ChooseExposure(&linear);
  AddMarineSnow(options_.marine_snow, view.seed, &linear);
  return Expose(linear, options_.noise, Hash(view.seed, 1), num_threads);
}

}  // namespace colmap_seapoint
