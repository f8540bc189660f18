// Where coded markers lie in a model, and how large they are there, from where its pictures show
// them (ours).
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

struct MarkerPlace {
  std::string problem;  // why it has no place, a sentence without its subject; empty: it has one
  size_t num_seen = 0;  // sightings in the model's pictures
  size_t num_used = 0;
  double rms_pixels = 0;                                 // of the used ones' centres
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();         // of its centre, model's frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of xyz, model units squared
  double side = 0;        // of its black square, model units: the mean of four
  double side_sigma = 0;  // its standard deviation, model units
};

// Every marker that the table holds. A marker has a place when the rays of more than half of its
// sightings, in two pictures at least, meet to `max_error` pixels, and its corners form a square
// there. It has none when it was found once only, when the sightings that are left over meet at a
// second place (two prints of one marker), when all of them are mirror images, or when no picture
// of them is in the model. Pictures of another size than the model's camera are scaled to it.
// What is found in no picture is not in the result.
std::map<MarkerName, MarkerPlace> PlaceMarkers(const SparseModel& model,
                                               const std::vector<MarkerSighting>& sightings,
                                               double max_error);

}  // namespace colmap_seapoint
