// Models without pictures, for what is decided by poses and points alone: cameras above a field of
// points, each point tracked by every camera whose picture it lies in.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

class SurveyModel {
 public:
  // 60 degrees wide.
  static Camera TestCamera() { return MakeCamera(CameraModel::kPinhole, 350, 400, 300); }
  static constexpr double kDepth = 2;
  static constexpr double kWidth = kDepth * 400 / 350;  // of a picture on the ground

  // image_id 7, 8, ...: image_idx + 7.
  void Add(const std::string& name, const Viewpoint& viewpoint) {
    model_.cameras[1] = TestCamera();
    PosedImage image;
    image.image_id = static_cast<uint32_t>(7 + model_.images.size());
    image.camera_id = 1;
    image.name = name;
    image.cam_from_world = viewpoint.cam_from_world;
    model_.images.push_back(image);
  }
  void AddAbove(const std::string& name, double x, double y = 0) {
    Add(name, StandAt(TestCamera(), {x, y, 0}));
  }

  // On a lattice of the ground, or anywhere; what one camera sees is kept as the mapper drops it.
  SparseModel WithPoints(const std::vector<Eigen::Vector3d>& points) const {
    SparseModel model = model_;
    uint64_t id = 0;
    for (const Eigen::Vector3d& xyz : points) {
      SparsePoint point;
      point.xyz = xyz;
      std::vector<size_t> seen_by;
      for (size_t i = 0; i < model.images.size(); ++i) {
        const auto pixel = TestCamera().ImgFromCam(model.images[i].cam_from_world * xyz);
        if (pixel && TestCamera().InImage(*pixel)) seen_by.push_back(i);
      }
      if (seen_by.size() < 2) continue;
      ++id;
      for (const size_t i : seen_by) {
        point.track.push_back(
            {model.images[i].image_id, static_cast<uint32_t>(model.images[i].point3D_ids.size())});
        model.images[i].point3D_ids.push_back(id);
      }
      model.points3D[id] = point;
    }
    return model;
  }
  SparseModel WithGround(double spacing = 0.1) const {
    std::vector<Eigen::Vector3d> points;
    for (double x = -4; x < 16; x += spacing) {
      for (double y = -3; y < 3; y += spacing) points.push_back({x, y, kDepth});
    }
    return WithPoints(points);
  }

 private:
  SparseModel model_;
};

}  // namespace colmap_seapoint
