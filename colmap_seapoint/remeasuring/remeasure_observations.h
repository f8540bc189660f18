// Each observation of a model's points is measured again before the last adjustment (ours).
//
// SeaPoints are found in each picture alone, so that two of them are seldom the same place to
// better than half a pixel, and the less the more the pictures differ: what ties neighbouring
// strips together is measured worst, and long surveys bend. Here a point is what its best picture
// shows around its SeaPoint, and all others are asked where they show the same, by least-squares
// matching with the warp that the model itself predicts (feature/remeasuring).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Reads a picture of the model, grey; called for each at most twice, from several threads. A size
// that is not its camera's leaves the picture's observations as they are.
using GrayPictureReader = std::function<GrayImage(const PosedImage&)>;

struct RemeasuringOptions {
  // An observation farther from where its point is found shows something else, and is taken out.
  double max_move = 4;  // pixels
  // An observation that is known worse than this (a standard deviation, pixels; kMaxPatchSigma at
  // most) is taken out. Errors of what is known worse have a long tail, and bend long strips: of
  // 1,000 pictures the camera centres were 13.8 mm off with 0.15, and 3.4 with 0.06.
  double max_sigma = 0.06;
  int num_threads = -1;  // -1 = all
  // A picture's mask, 0 where it shows what is not to be used; empty where it has none. Null: there
  // are no masks. What a mask hides is not measured in, and observations near it stay as they are.
  GrayPictureReader read_mask;
  // By image_id: from which on a picture's observations are but predicted (extend_tracks.h). They
  // are never a reference, and are taken out where they are not measured, or a pixel beside where
  // they should be. A picture that is not named has none.
  std::map<uint32_t, size_t> first_predicted;
  double max_predicted_move = 1;  // pixels
};

// What became of the observations of triangulated points.
struct RemeasuringCounts {
  size_t references = 0;  // stay as they are: what the others are measured against
  size_t moved = 0;
  // Stay as they are: at a picture's or mask's border, or in a picture of another size.
  size_t unmeasured = 0;
  // Taken out: see PatchMatchStatus for the first three.
  size_t unlike = 0;
  size_t diverged = 0;
  size_t unsure = 0;
  size_t elsewhere = 0;  // farther than max_move
  size_t twice = 0;      // a second one in the same picture
  size_t unseen = 0;     // predicted, and not to be measured there
  size_t alone = 0;      // the others of their track are out
  size_t removed_points = 0;
};

struct Remeasurement {
  SparseModel model;
  RemeasuringCounts counts;
  std::vector<std::string> of_other_size;  // names of pictures, in the order of the model
};

// The model with its observations moved or taken out, and without the points that have fewer than
// two left; poses, points' places and lenses stay, as does what has no point. The same bytes for
// any number of threads. What `read` throws is thrown on: a disk that is gone must not lead to
// other poses than the next run finds. Memory: one picture a thread, about 360 bytes a point and 40
// an observation. About 12 microseconds an observation, decoding of pictures aside.
Remeasurement RemeasureObservations(const RemeasuringOptions& options, const SparseModel& model,
                                    const GrayPictureReader& read);

}  // namespace colmap_seapoint
