// Pictures that show a point, but in which no SeaPoint was matched to it, are asked for it too
// (ours).
//
// Of the pictures that show a place, matching finds it in half: tracks are short, and few lead from
// one strip to the next. What is missing is what holds the lens and a long strip straight: with
// exact tracks of 1,000 pictures out and back and 0.035 pixels of noise, camera centres were 110 mm
// off with the tracks that matching gave and 33 mm with those that the pictures hold. A posed model
// predicts the missing ones to a pixel, and least-squares matching measures them
// (remeasure_observations.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct TrackExtensionOptions {
  // Of a picture, with those it has: one that has as many already gets none.
  size_t max_observations = 1500;
  int num_threads = -1;  // -1 = all; never changes a result
};

// How many pairs of coordinates each picture of a model has, by image_id.
std::map<uint32_t, size_t> NumPoints2D(const SparseModel& model);

// Adds the observations that the model predicts, behind those that a picture has: of points that
// pictures which see the same things observe, from no less than two thirds of the least distance
// that they are observed from, and 45 degrees at most from one of these rays. What hides them is
// not asked: measuring tells. Where there are too many, an even sample of the points is taken. The
// same for any number of threads. Some 0.1 microseconds for each point of each such picture.
void ExtendTracks(const TrackExtensionOptions& options, SparseModel* model);

// Takes the observations from `num_points2D` on out again, which no database knows of, and the
// points that have fewer than two left.
void DropExtensions(const std::map<uint32_t, size_t>& num_points2D, SparseModel* model);

}  // namespace colmap_seapoint
