// Points for a model that has none: COLMAP's documented way with known poses is images.txt with an
// empty points3D.txt (ours).
#pragma once

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/sequence/picture_cache.h"

namespace colmap_seapoint {

// Whether any of the model's points is seen by two of its pictures.
bool HasSharedPoints(const SparseModel& model);

// The model with a point of two views for every match that its poses confirm: before both cameras,
// at a parallax of a degree or more, within 2 pixels of both SeaPoints. Matches are those of every
// picture with its nearest ones that look the same way by 70 degrees: the first, second, fourth,
// eighth ... 64th nearest, so that video and stills both come to a baseline. Points and ids that
// were there stay. O(pictures^2) distances, and the time of 7 matchings a picture where matches are
// not stored.
SparseModel WithTriangulatedMatches(SparseModel model, PictureCache* pictures);

}  // namespace colmap_seapoint
