// Ray-cast pictures of the scene, exactly through the lens model.
#pragma once

#include <memory>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/paths/survey_path.h"
#include "examples/survey/render/lens_table.h"
#include "examples/survey/render/water.h"
#include "examples/survey/scene/boards.h"
#include "examples/survey/scene/seabed.h"
#include "examples/survey/scene/surface.h"

namespace colmap_seapoint {

class Renderer {
 public:
  // Keeps references: surface, boards and seabed must outlive the renderer.
  Renderer(const SurveyOptions& options, const Camera& camera, const Surface& surface,
           const std::vector<MarkerBoard>& boards, const Seabed& seabed);

  // The same bytes for any number of threads.
  ColorImage Render(const PosedImage& image, int num_threads);

 private:
  // Of one picture.
  struct View {
    Rigid3d world_from_cam, ground_from_cam;
    uint64_t seed;
    Rectangle coloured;  // of the ground: colours are there for it
  };
  View Prepare(const PosedImage& image, int num_threads);
  Eigen::Array3f PixelLight(const View& view, int x, int y) const;
  Eigen::Array3f GroundColour(const Eigen::Vector2d& place) const;  // metres, the ground's frame
  Eigen::Array3f ObjectColour(const Eigen::Vector2d& place) const;  // metres on the sheet
  Eigen::Array3f MeanAlbedo(const View& view, int x, int y, const SurfaceHit& hit) const;
  Eigen::Vector2d GroundPlace(const View& view, const WaterRay& cam_ray,
                              const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  Eigen::Array2i SamplesOf(const View& view, int x, int y, const SurfaceHit& hit) const;
  Eigen::Array3f Illumination(const View& view, const SurfaceHit& hit) const;
  float OpenSky(const SurfaceHit& hit) const;

  const SurveyOptions options_;
  const PortCamera camera_;
  const Surface* surface_;
  const std::vector<MarkerBoard>* boards_;
  AlbedoMap ground_colours_;
  std::unique_ptr<AlbedoMap> object_colours_;
  LensTable lens_;
  Water water_;
  Eigen::Array3f gain_;  // exposure and white balance, the same for all pictures
};

}  // namespace colmap_seapoint
