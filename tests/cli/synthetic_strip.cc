#include "tests/cli/synthetic_strip.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kMaxPictures = 24;
constexpr int kGroundWidth = kStripWidth + (kMaxPictures - 1) * kStripStep;
constexpr int kLatticeStep = 25;  // pixels between ground points

// Noise in two sizes of grain: corners everywhere, at a full range of grey.
Image<uint8_t> MakeGround() {
  std::mt19937 random(7);
  Image<uint8_t> ground(kGroundWidth, kStripHeight, 3);
  Image<float> fine(kGroundWidth, kStripHeight), coarse(kGroundWidth / 6 + 2, kStripHeight / 6 + 2);
  for (float& value : fine.data) value = static_cast<float>(random() % 256);
  for (float& value : coarse.data) value = static_cast<float>(random() % 256);
  for (int y = 0; y < kStripHeight; ++y) {
    for (int x = 0; x < kGroundWidth; ++x) {
      float sum = 0;
      for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
          sum += fine.At(std::min(x + dx, kGroundWidth - 1), std::min(y + dy, kStripHeight - 1));
        }
      }
      const float value = 0.5f * sum / 4 + 0.5f * coarse.At(x / 6, y / 6);
      for (int c = 0; c < 3; ++c) {
        ground.At(x, y, c) = static_cast<uint8_t>(value * (1.0f - 0.15f * static_cast<float>(c)));
      }
    }
  }
  return ground;
}

int NumberIn(const std::string& name) {
  const size_t end = name.find_last_of("0123456789");
  if (end == std::string::npos) return 0;
  size_t begin = end;
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0) --begin;
  return std::atoi(name.substr(begin, end + 1 - begin).c_str());
}

}  // namespace

ColorImage StripPicture(int index) {
  static const Image<uint8_t> ground = MakeGround();
  ColorImage picture(kStripWidth, kStripHeight, 3);
  for (int y = 0; y < kStripHeight; ++y) {
    const uint8_t* row = ground.Row(y) + static_cast<size_t>(index * kStripStep) * 3;
    std::copy(row, row + static_cast<size_t>(kStripWidth) * 3, picture.Row(y));
  }
  return picture;
}

void WriteStrip(const std::filesystem::path& folder, int count, const std::string& prefix) {
  std::filesystem::create_directories(folder);
  for (int i = 1; i <= count; ++i) {
    WriteImage(folder / (prefix + std::to_string(i) + ".png"), StripPicture(i));
  }
}

Rigid3d StripPose(const std::string& name, const Camera& camera) {
  Rigid3d cam_from_world;
  const double step = kStripStep * kStripRange / camera.FocalX();
  cam_from_world.translation = {-step * NumberIn(name), 0, 0};
  return cam_from_world;
}

SparseModel StripModel(int count, const std::string& prefix) {
  SparseModel model;
  Camera camera = MakeCamera(CameraModel::kPinhole, 1.2 * kStripWidth, kStripWidth, kStripHeight);
  camera.camera_id = 1;
  model.cameras[1] = camera;
  for (int i = 1; i <= count; ++i) {
    PosedImage image;
    image.image_id = static_cast<uint32_t>(i);
    image.camera_id = 1;
    image.name = prefix + std::to_string(i) + ".png";
    image.cam_from_world = StripPose(image.name, camera);
    model.images.push_back(image);
  }
  const double per_pixel = kStripRange / camera.FocalX();
  uint64_t next_id = 1;
  for (int y = kLatticeStep / 2; y < kStripHeight; y += kLatticeStep) {
    for (int x = kStripStep; x < (count + 1) * kStripStep + kStripWidth; x += kLatticeStep) {
      SparsePoint point;
      point.xyz = {(x - camera.PrincipalX()) * per_pixel, (y - camera.PrincipalY()) * per_pixel,
                   kStripRange};
      for (PosedImage& image : model.images) {
        const auto pixel = camera.ImgFromCam(image.cam_from_world * point.xyz);
        if (!pixel || !camera.InImage(*pixel)) continue;
        point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
        image.points2D.push_back(*pixel);
        image.point3D_ids.push_back(next_id);
      }
      if (!point.track.empty()) model.points3D[next_id++] = point;
    }
  }
  return model;
}

}  // namespace colmap_seapoint
