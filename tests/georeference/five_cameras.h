// Five cameras in a model, for tests of what measures it.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "colmap_seapoint/georeference/scale_measurements.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {

// Their centres as `centre_of` places them, from 0 to 4; not turned. The pictures are img1.jpg to
// img5.jpg, of 1200 x 900 pixels.
class FiveCameras : public testing::Test {
 protected:
  explicit FiveCameras(Eigen::Vector3d (*centre_of)(uint32_t)) {
    Camera camera = MakeCamera(CameraModel::kPinhole, 1000, 1200, 900);
    camera.camera_id = 1;
    model_.cameras[1] = camera;
    for (uint32_t i = 0; i < 5; ++i) {
      PosedImage image;
      image.image_id = i + 1;
      image.camera_id = 1;
      image.name = "img" + std::to_string(i + 1) + ".jpg";
      image.cam_from_world.translation = -centre_of(i);
      model_.images.push_back(image);
    }
  }

  std::string Table(const std::string& name, const std::string& text) {
    WriteBytes(dir_ / name, text);
    return (dir_ / name).string();
  }

  TempDir dir_;
  SparseModel model_;
  ScaleSources sources_;
  std::vector<MarkerSighting> sightings_;
  RunReport report_;
};

}  // namespace colmap_seapoint
