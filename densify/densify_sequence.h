// The spine of densification (paper 2.2, Figure 3): pair by pair along the track, only what is new.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "densify/partial_densification_options.h"
#include "densify/sequence/picture_source.h"
#include "densify/sequence_report.h"

namespace colmap_seapoint {

// Raise it whenever the same model, pictures and options give another cloud than before;
// tests/densify/densification_version_test.cc fails until it is.
inline constexpr char kDensificationVersion[] = "9";

// Densifies the model's pictures in the natural order of their names ("2" before "10"), then, with
// options.completion, what any two of them see and no pair has covered (ours). With a rig, its
// right pictures are no part of that track, and a picture's pair is completed by its simultaneous
// right one, where there is one that can be read (paper 4). Clouds are in the model's frame.
//
// A picture that cannot be read is left out and named in the report; the rest goes on. Throws what
// `source` and the callbacks throw, but for Error from ReadPicture and ReadSeaPoints. The same
// clouds and rows, but for their seconds, for any num_threads, with or without `debug`. Memory does
// not grow with the number of pictures but for some bytes a cell (packed_footprint.h).
SequenceReport DensifySequence(const SparseModel& model, PictureSource* source,
                               const PartialDensificationOptions& options, int num_threads,
                               const SequenceCallbacks& callbacks, const StereoRig& rig = {});

}  // namespace colmap_seapoint
