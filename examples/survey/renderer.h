// Ray-cast pictures of the seabed, exactly through the lens model.
#pragma once

#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/scene/height_field.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/scene/water.h"
#include "examples/survey/survey_path.h"

namespace colmap_seapoint {

// Directions in the camera frame by pixel: the exact inverse of the lens on a 4-pixel lattice,
// bilinear between (better than 0.002 px).
class LensTable {
 public:
  explicit LensTable(const Camera& camera);
  Eigen::Vector3d Ray(double x, double y) const;  // z = 1

 private:
  int nodes_x_ = 0;
  std::vector<Eigen::Vector2d> nodes_;
};

class Renderer {
 public:
  // Keeps references: field and albedo must outlive the renderer.
  Renderer(const SurveyOptions& options, const Camera& camera, const HeightField& field,
           AlbedoMap* albedo);

  // The same bytes for any number of threads.
  ColorImage Render(const PosedImage& image, int num_threads);

 private:
  Eigen::Array3f PixelLight(const Rigid3d& world_from_cam, int x, int y, uint64_t seed) const;
  Eigen::Array3f MeanAlbedo(const Rigid3d& world_from_cam, int x, int y,
                            const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  Eigen::Array3f Illumination(const Rigid3d& world_from_cam, const Eigen::Vector3d& point,
                              const Eigen::Vector3d& normal, uint64_t seed) const;
  float OpenSky(const Eigen::Vector3d& point) const;
  Eigen::Array3f ChooseGain() const;

  const SurveyOptions options_;
  const Camera camera_;
  const HeightField* field_;
  AlbedoMap* albedo_;
  LensTable lens_;
  Water water_;
  Eigen::Array3f gain_;  // exposure and white balance, the same for all pictures
};

}  // namespace colmap_seapoint
