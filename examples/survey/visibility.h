// Which pictures truly see a place of the surface, and how well.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "examples/survey/paths/survey_port.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {

// A place in one picture.
struct Sighting {
  double gsd = 0;             // metres a pixel there
  Eigen::Vector3d to_camera;  // unit
};

class SurfaceVisibility {
 public:
  // Keeps references: the truth must outlive it (pixels and points of its model may change).
  explicit SurfaceVisibility(const SurveyTruth& truth);

  // The pixel of a surface point in picture `image_idx`; nullopt when it lies outside the picture,
  // is hidden, is too far, or is seen more than 80 degrees from its normal. Any number of threads.
  std::optional<Eigen::Vector2d> Project(size_t image_idx, const Eigen::Vector3d& point,
                                         const Eigen::Vector3d& normal) const;

  // The pictures that may hold any of these points; the others hold none of them. Asked once for
  // points that lie close together, it spares most of a large survey's pictures.
  std::vector<size_t> PicturesAround(const std::vector<Eigen::Vector3d>& points) const;

  // Those of the pictures that see it.
  std::vector<Sighting> Sightings(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  const std::vector<size_t>& pictures) const;
  // Those of the pictures that hold any point of space within their range; what hides it is not
  // looked for.
  std::vector<Sighting> InFrames(const Eigen::Vector3d& point,
                                 const std::vector<size_t>& pictures) const;

 private:
  struct View {
    Rigid3d cam_from_world;
    Eigen::Vector3d centre;
    const PortCamera* camera;
  };
  std::optional<Eigen::Vector2d> InFrame(const View& view, const Eigen::Vector3d& point) const;
  Sighting SightingIn(const View& view, const Eigen::Vector3d& point) const;

  const Surface* surface_;
  double max_range_;
  std::map<uint32_t, PortCamera> cameras_;
  std::vector<View> views_;
};

inline constexpr double kMinParallaxDeg = 3;

// The best that two pictures can do: over all pairs of sightings whose directions are
// kMinParallaxDeg or more apart, the least of the larger GSD of the two. nullopt without such a
// pair.
std::optional<double> BestPairGsd(std::vector<Sighting> sightings);

}  // namespace colmap_seapoint
