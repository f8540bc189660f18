#include "tests/orthomosaic/map_world.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2, kTableDepth = 1.7, kSpacing = 0.0064;

World TableWorld() {
  return World(
      {{{0, 0, kDepth}, {20, 0, 0}, {0, 20, 0}}, {{0, 0, kTableDepth}, {0.2, 0, 0}, {0, 0.15, 0}}},
      NoiseTexture(7, 0.24, 3));
}

ColorImage Darkened(ColorImage picture, double gain) {
  for (uint8_t& value : picture.data) {
    value = ScreenOf(static_cast<float>(gain) * LightOf(static_cast<float>(value)));
  }
  return picture;
}

void AddPoint(const MapWorld& world, const Eigen::Vector3d& place, CloudWriter* cloud) {
  for (const Viewpoint& viewpoint : world.Viewpoints()) {
    if (place.x() > 0.9 || !PixelOf(world.world, viewpoint, place)) continue;
    CloudPoint point;
    point.xyz = place.cast<float>();
    point.normal = -Eigen::Vector3f::UnitZ();
    cloud->Add(point, nullptr, 0);
    return;
  }
}

void WriteCloud(const MapWorld& world) {
  CloudWriter cloud(world.cloud_path);
  for (double x = -1.5; x < 1.5; x += kSpacing) {
    for (double y = -1.2; y < 1.2; y += kSpacing) {
      AddPoint(world, {x, y, kDepth}, &cloud);
      if (std::abs(x) < 0.2 && std::abs(y) < 0.15) AddPoint(world, {x, y, kTableDepth}, &cloud);
    }
  }
  cloud.Finish();
}

}  // namespace

std::vector<Viewpoint> MapWorld::Viewpoints() const {
  std::vector<Viewpoint> viewpoints;
  for (const PosedImage& image : model.images) {
    viewpoints.push_back({model.cameras.at(image.camera_id), image.cam_from_world});
  }
  return viewpoints;
}

MapWorld MakeMapWorld(const std::filesystem::path& folder,
                      const std::function<double(size_t)>& gain) {
  MapWorld world{TableWorld(), {}, {}, folder / "fused.ply", 0.008};
  world.model.cameras[1] = MildCamera(CameraModel::kRadial, 250, 200, 150);
  world.model.cameras[1].camera_id = 1;
  for (size_t i = 0; i < 6; ++i) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(i + 1);
    image.camera_id = 1;
    image.name = std::to_string(i) + ".png";
    const double x = 0.5 * (static_cast<double>(i % 3) - 1), y = i < 3 ? -0.3 : 0.3;
    const Viewpoint viewpoint = StandAt(world.model.cameras[1], {x, y, 0}, {3, -4, 2.0 * (i % 2)});
    image.cam_from_world = viewpoint.cam_from_world;
    world.model.images.push_back(image);
    world.pictures.push_back(PictureOf(Darkened(TakePicture(world.world, viewpoint), gain(i))));
  }
  WriteCloud(world);
  return world;
}

}  // namespace colmap_seapoint
