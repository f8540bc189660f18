#include "tests/remeasuring/measured_world.h"

#include <cmath>
#include <random>
#include <string>

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 3;

std::vector<Viewpoint> Viewpoints() {
  const Camera camera = MildCamera(CameraModel::kOpenCV, 600, 400, 300);
  return {StandAt(camera, {0, 0, 0}), StandAt(camera, {0.35, 0.1, 0.01}, {3, 0, 8}),
          StandAt(camera, {-0.3, 0.2, -0.15}, {0, 4, 90}),
          StandAt(camera, {0.2, -0.3, 0.02}, {-2, 2, 180})};
}

class ModelBuilder {
 public:
  ModelBuilder(const World& world, const std::vector<Viewpoint>& viewpoints, double error)
      : world_(world), viewpoints_(viewpoints), offset_(-error, error) {
    model_.cameras[1] = viewpoints[0].camera;
    for (size_t i = 0; i < viewpoints.size(); ++i) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(i + 1);
      image.camera_id = 1;
      image.name = "img" + std::to_string(i + 1) + ".png";
      image.cam_from_world = viewpoints[i].cam_from_world;
      model_.images.push_back(image);
    }
  }

  void AddPoint(const Eigen::Vector3d& xyz) {
    const uint64_t id = model_.points3D.size() + 1;
    SparsePoint point;
    point.xyz = xyz;
    for (size_t i = 0; i < viewpoints_.size(); ++i) {
      const auto pixel = PixelOf(world_, viewpoints_[i], xyz);
      if (!pixel) continue;
      PosedImage& image = model_.images[i];
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(*pixel + Eigen::Vector2d(offset_(random_), offset_(random_)));
      image.point3D_ids.push_back(id);
    }
    if (point.track.size() >= 2) {
      model_.points3D[id] = point;
      return;
    }
    for (const SparsePoint::TrackElement& element : point.track) {
      model_.images[element.image_id - 1].point3D_ids.back() = kNoPoint3D;
    }
  }

  SparseModel Take() { return std::move(model_); }

 private:
  const World& world_;
  const std::vector<Viewpoint>& viewpoints_;
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> offset_;
  SparseModel model_;
};

}  // namespace

MeasuredWorld::MeasuredWorld(double error)
    : world_(SlantedWorld(kDepth, 25)), viewpoints_(Viewpoints()) {
  for (const Viewpoint& viewpoint : viewpoints_) {
    pictures_.push_back(LumaOf(TakePicture(world_, viewpoint)));
  }
  ModelBuilder builder(world_, viewpoints_, error);
  for (int y = 10; y < 300; y += 14) {
    for (int x = 10; x < 400; x += 14) {
      const auto xyz = SurfaceAt(world_, viewpoints_[0], Eigen::Vector2d(x, y));
      if (xyz) builder.AddPoint(*xyz);
    }
  }
  model_ = builder.Take();
}

Eigen::Vector2d MeasuredWorld::Transfer(size_t from, const Eigen::Vector2d& pixel,
                                        size_t to) const {
  const auto xyz = SurfaceAt(world_, viewpoints_[from], pixel);
  return *viewpoints_[to].camera.ImgFromCam(viewpoints_[to].cam_from_world * *xyz);
}

MeasuredErrors ErrorsOfMoved(const MeasuredWorld& world, const SparseModel& before,
                             const SparseModel& after) {
  double squared_before = 0, squared_after = 0;
  int num = 0;
  const auto pixel_in = [](const SparseModel& model, const SparsePoint::TrackElement& element) {
    return model.images[element.image_id - 1].points2D[element.point2D_idx];
  };
  for (const auto& [id, point] : after.points3D) {
    std::vector<SparsePoint::TrackElement> moved, unmoved;
    for (const SparsePoint::TrackElement& element : point.track) {
      const bool is_moved = pixel_in(before, element) != pixel_in(after, element);
      (is_moved ? moved : unmoved).push_back(element);
    }
    if (unmoved.size() != 1) continue;
    for (const SparsePoint::TrackElement& element : moved) {
      const Eigen::Vector2d truth = world.Transfer(
          unmoved[0].image_id - 1, pixel_in(after, unmoved[0]), element.image_id - 1);
      squared_before += (pixel_in(before, element) - truth).squaredNorm();
      squared_after += (pixel_in(after, element) - truth).squaredNorm();
      ++num;
    }
  }
  return {std::sqrt(squared_before / num), std::sqrt(squared_after / num)};
}

}  // namespace colmap_seapoint
