#include "tests/joining/two_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

Camera TestCamera() {
  Camera camera = MakeCamera(CameraModel::kSimplePinhole, 800, 800, 600);
  camera.camera_id = 1;
  return camera;
}

FeatureMatches Alike(const std::vector<int>& looks1, const std::vector<int>& looks2) {
  FeatureMatches matches;
  for (uint32_t i = 0; i < looks1.size(); ++i) {
    const auto found = std::find(looks2.begin(), looks2.end(), looks1[i]);
    if (found == looks2.end()) continue;
    matches.push_back({i, static_cast<uint32_t>(found - looks2.begin())});
  }
  return matches;
}

}  // namespace

std::vector<GroundPoint> StrewnGround(double x0, double x1, double y0, double y1, int count,
                                      int first_looks, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<GroundPoint> ground;
  for (int i = 0; i < count; ++i) {
    const double x = x0 + (x1 - x0) * uniform(random), y = y0 + (y1 - y0) * uniform(random);
    ground.push_back({{x, y, 2 - 0.3 * uniform(random)}, first_looks + i});
  }
  return ground;
}

PosedImage PictureAt(uint32_t image_id, double x, double y) {
  PosedImage image;
  image.image_id = image_id;
  image.camera_id = 1;
  image.name = "img" + std::to_string(image_id) + ".jpg";
  const double turn = 2 * static_cast<double>(image_id % 3);
  image.cam_from_world =
      StandAt(TestCamera(), {x, y, 0}, {turn, 3 - turn, 2 * turn}).cam_from_world;
  return image;
}

TestModel SeenBy(std::vector<PosedImage> images, const std::vector<GroundPoint>& ground) {
  TestModel seen;
  seen.model.cameras[1] = TestCamera();
  const Camera camera = TestCamera();
  for (size_t k = 0; k < ground.size(); ++k) {
    SparsePoint point;
    point.xyz = ground[k].xyz;
    std::vector<PosedImage*> viewers;
    for (PosedImage& image : images) {
      const auto pixel = camera.ImgFromCam(image.cam_from_world * point.xyz);
      if (!pixel || !camera.InImage(*pixel)) continue;
      point.track.push_back({image.image_id, static_cast<uint32_t>(image.points2D.size())});
      image.points2D.push_back(*pixel);
      image.point3D_ids.push_back(kNoPoint3D);
      seen.looks[image.image_id].push_back(ground[k].looks);
      viewers.push_back(&image);
    }
    if (viewers.size() < 2) continue;
    for (PosedImage* image : viewers) image->point3D_ids.back() = k + 1;
    seen.model.points3D[k + 1] = point;
  }
  seen.model.images = std::move(images);
  return seen;
}

Similarity3d OtherFrame() {
  Similarity3d frame;
  frame.scale = 3.7;
  frame.rotation = Eigen::AngleAxisd(1.9, Eigen::Vector3d(0.3, -0.8, 0.5).normalized());
  frame.translation = {12, -4, 7};
  return frame;
}

void WriteDatabase(const TestModel& a, const TestModel& b, const std::filesystem::path& path) {
  std::filesystem::remove(path);
  ColmapDatabase database(path, ColmapDatabase::Mode::kCreateIfMissing);
  DatabaseTransaction transaction(&database);
  const uint32_t camera_id = AddCamera(&database, a.model.cameras.at(1));
  std::map<uint32_t, std::vector<int>> looks = a.looks;
  looks.insert(b.looks.begin(), b.looks.end());
  std::map<uint32_t, const PosedImage*> images;
  for (const TestModel* model : {&a, &b}) {
    for (const PosedImage& image : model->model.images) images[image.image_id] = &image;
  }
  for (const auto& [id, image] : images) {
    Features features;
    for (const Eigen::Vector2d& pixel : image->points2D) {
      features.points.emplace_back();
      features.points.back().x = static_cast<float>(pixel.x());
      features.points.back().y = static_cast<float>(pixel.y());
    }
    features.descriptors.resize(features.points.size());
    ASSERT_EQ(AddImage(&database, image->name, camera_id), id);
    WriteFeatures(&database, id, features, "survey");
  }
  for (const auto& [id1, looks1] : looks) {
    for (const auto& [id2, looks2] : looks) {
      if (id1 >= id2) continue;
      TwoViewGeometry geometry;
      geometry.inliers = Alike(looks1, looks2);
      geometry.config =
          geometry.inliers.empty() ? TwoViewConfig::kDegenerate : TwoViewConfig::kUncalibrated;
      if (!geometry.inliers.empty()) geometry.F = Eigen::Matrix3d::Identity();
      WriteMatches(&database, id1, id2, geometry.inliers, geometry);
    }
  }
  transaction.Commit();
}

}  // namespace colmap_seapoint
