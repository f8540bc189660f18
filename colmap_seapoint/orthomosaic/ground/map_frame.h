// The plane of a map, and what is right and up on it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/files/model_units.h"

namespace colmap_seapoint {

enum class MapPlane {
  kAuto,   // kModel where the model knows what is up and the scene is no wall, else kFitted
  kModel,  // z of the model is up
  kFitted  // the best plane of the cloud
};

struct MapFrameOptions {
  MapPlane plane = MapPlane::kAuto;
  // What the map is seen along, towards the eye, in the cloud's frame; decides over `plane`.
  std::optional<Eigen::Vector3d> towards_eye;
  // What points to the upper edge of the map, in the cloud's frame.
  std::optional<Eigen::Vector3d> up;
};

enum class PlaneKind { kLevel, kFitted, kWall, kGiven };

struct MapFrame {
  Rigid3d map_from_cloud;  // map: x right, y up on the map, z towards the eye: heights
  PlaneKind kind = PlaneKind::kFitted;
  bool is_north_up = false;  // y is the north of the model's own frame, x its east
  std::string text;          // one sentence for people: which plane, what is up
};

// `sample`: points of the cloud, one at least. The best plane goes through most of them, whatever
// the rest does, and is seen from the cameras' side. Where the model tells no north, the pictures'
// own upright is up on the map if they agree on one, else the longer side lies to the right; of
// a wall in a level model, up is up. Throws Error for directions that are zero, or parallel.
MapFrame FindMapFrame(const MapFrameOptions& options, const SparseModel& model,
                      const std::vector<Eigen::Vector3d>& sample,
                      const std::optional<ModelUnits>& units);

}  // namespace colmap_seapoint
