// The order of a model's pictures along the track of the camera (paper 2.5: successive views
// overlap most).
#pragma once

#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/sequence/covisibility.h"

namespace colmap_seapoint {

// Triangulated points that successive pictures share, summed along an order: what makes it a track.
int64_t Continuity(const SparseModel& model, const std::vector<int>& order);

// All image_idx: in the natural order of the pictures' names ("2" before "10"), as cameras count.
// Ours: where names tell no track (drawn at random, strips of several cameras shuffled), in the
// order of a walk over the model. It starts at the first name and goes on to the picture that
// shares most points with the present one, ties by name; where none is left, to the first name that
// is. The names' order stands when it keeps half of that walk's continuity.
std::vector<int> OrderPictures(const SparseModel& model, const Covisibility& covisibility);

}  // namespace colmap_seapoint
