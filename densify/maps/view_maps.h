// The finished cloud as one view sees it: a depth map and a normal map (ours). The cloud has every
// place once, from one pair; programs that fuse maps, as COLMAP's stereo_fusion, want it from every
// view that sees it. So samples are drawn into any picture, each as the patch of surface that it
// stands for: the square between its neighbours in its own pair's rectified frame, on the sample's
// plane. Patches of one surface join without gaps whatever the view.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/rigid3.h"
#include "densify/cloud/partial_cloud.h"
#include "densify/match/rectification.h"

namespace colmap_seapoint {

// Where a pair's samples lie: on a lattice `step` apart of the plane z = focal before `center`.
struct SampleFrame {
  Eigen::Matrix3d rect_from_world;
  Eigen::Vector3d center;  // world: camera centre of the pair's first picture
  double focal = 0;        // pixels
  double step = 1;         // pixels
};

// step: SampleStep() of the pair's first camera.
SampleFrame SampleFrameOf(const PairGeometry& geometry, int step);

// COLMAP's fusion takes the value at (column c, row r) for that of the ray through the place (c, r)
// of the camera's plane, which is the corner of the pixel, not its centre. So do these maps:
// back-projected as COLMAP does it, every depth lies on the surface.
struct ViewMaps {
  FloatImage depth;   // z in the camera's frame, model units; 0: nothing is seen there
  FloatImage normal;  // 3 channels: unit, camera's frame, towards the camera; 0, 0, 0 where missing
};

// A depth buffer. The nearest surface wins; among patches of one surface (depths within four
// samples' distance) the one whose middle is nearest. A surface seen from behind hides what lies
// beyond it but is not seen itself: no real surface is. Not for several threads at once; the same
// calls in the same order give the same maps. Memory: 17 bytes a pixel. Cost: about 0.1
// microseconds a sample in view and 10 ns a pixel that its patch may cover.
class ViewMapRenderer {
 public:
  // `camera` is a PINHOLE.
  ViewMapRenderer(const Camera& camera, const Rigid3d& cam_from_world);

  // Whether something of a sphere (world) may be in view. False is certain.
  bool MayShow(const Eigen::Vector3d& center, double radius) const;
  void Add(const SampleFrame& frame, const DensePoint* points, size_t count);
  ViewMaps Finish();

 private:
  struct Patch;
  struct PairTerms;
  struct PixelBox;
  struct Intrinsics {
    double fx, fy, cx, cy;  // pixels
  };

  // nullopt when nothing of it can be seen.
  std::optional<Patch> MakePatch(const PairTerms& pair, const DensePoint& point) const;
  std::optional<PixelBox> BoxOf(const std::array<Eigen::Vector3d, 4>& corners,
                                const PairTerms& pair, double depth) const;
  void Draw(const PairTerms& pair, const Patch& patch);

  Intrinsics lens_;
  Eigen::Matrix3d cam_from_pixel_;  // (c, r, 1) -> ray with z = 1
  Eigen::Matrix3d rotation_;        // camera from world
  Eigen::Vector3d translation_, center_;
  Eigen::Matrix<double, 4, 3> sides_;  // of the pyramid in view: unit normals inwards, camera frame
  ViewMaps maps_;
  GrayImage aside_;  // how far from its patch's middle a pixel lies, 255: at its rim
};

}  // namespace colmap_seapoint
