#include "tests/markers/marker_world.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "colmap_seapoint/markers/marker_codes.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kRays = 4;

// 0 (black) to 1; nullopt beside the marker and its margin of one cell.
std::optional<double> Shade(const PlaneMarker& marker, const Eigen::Vector3d& place) {
  const double c = std::cos(marker.turn), s = std::sin(marker.turn);
  const Eigen::Vector3d d = (place - marker.centre) / marker.size;
  double x = c * d.x() + s * d.y();
  const double y = c * d.y() - s * d.x();
  if (marker.is_mirrored) x = -x;
  const int cells = NumCells(marker.name.family);
  const double margin = 0.5 + 1.0 / cells;
  if (std::max(std::abs(x), std::abs(y)) > margin) return std::nullopt;
  return IsWhiteCell(marker.name, static_cast<int>(std::floor((x + 0.5) * cells)),
                     static_cast<int>(std::floor((y + 0.5) * cells)))
             ? 1.0
             : 0.0;
}

double GreyAt(const std::vector<PlaneMarker>& markers, const NoiseTexture& texture,
              const Eigen::Vector3d& place) {
  for (const PlaneMarker& marker : markers) {
    if (const auto shade = Shade(marker, place)) return 30 + 170 * *shade;
  }
  return 100 + 40 * texture.At(place);
}

FloatImage Blurred(const FloatImage& picture) {
  FloatImage result = picture;
  for (int y = 1; y + 1 < picture.height; ++y) {
    for (int x = 1; x + 1 < picture.width; ++x) {
      float sum = 0;
      for (int k = 0; k < 9; ++k) sum += picture.At(x + k % 3 - 1, y + k / 3 - 1);
      result.At(x, y) = sum / 9;
    }
  }
  return result;
}

}  // namespace

Eigen::Vector3d PlaneMarker::Corner(int k) const {
  const double angle = turn + 3.14159265358979323846 * (0.25 + 0.5 * k);
  return centre + size / std::sqrt(2.0) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
}

GrayImage MarkerPicture(const std::vector<PlaneMarker>& markers, const Camera& camera,
                        const Rigid3d& cam_from_world, const Water& water) {
  const NoiseTexture texture(3, 0.1, 4);
  const Eigen::Vector3d origin = cam_from_world.OriginInSource();
  const double depth = markers.empty() ? 2 : markers[0].centre.z();
  FloatImage light(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kRays * kRays; ++k) {
        const auto ray =
            camera.CamFromImg({x + (k % kRays + 0.5) / kRays, y + (k / kRays + 0.5) / kRays});
        if (!ray) continue;
        const Eigen::Vector3d direction =
            cam_from_world.rotation.conjugate() * Eigen::Vector3d(ray->x(), ray->y(), 1);
        sum += GreyAt(markers, texture, origin + (depth - origin.z()) / direction.z() * direction);
      }
      light.At(x, y) = static_cast<float>(sum / (kRays * kRays));
    }
  }
  for (int pass = 0; pass < water.blur; ++pass) light = Blurred(light);
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  GrayImage picture(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double factor = 1 - water.uneven * x / camera.width;
      const double value = factor * (100 + water.contrast * (double{light.At(x, y)} - 100)) +
                           water.noise * noise(random);
      picture.At(x, y) = static_cast<uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return picture;
}

}  // namespace colmap_seapoint
