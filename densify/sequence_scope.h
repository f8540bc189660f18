// Densification of a part of a survey: of the pictures that came in since an earlier run, or of a
// block (ours). Internal.
#pragma once

#include "densify/densify_sequence.h"
#include "densify/overlap/earlier_surface.h"

namespace colmap_seapoint {

// Which pictures of a model begin pairs. Any picture may complete a pair.
struct SequenceScope {
  EarlierSurface earlier;
  int block = 1, num_blocks = 1;  // of the track, cut into parts of as many pictures
};

// Whether a cloud of these options can be added to, or made block by block: it takes the completion
// pass, which knows what is covered.
bool CanBeDensifiedInParts(const PartialDensificationOptions& options);

// As DensifySequence(). Where an earlier run left a surface, the pairs of the pictures that came in
// since, for what that surface lacks. Of a block, those that its pictures begin: blocks know
// nothing of each other, and their clouds overlap by what pictures on both sides of a border show
// (colmap_seapoint/merging).
SequenceReport DensifyInScope(const SparseModel& model, PictureSource* source,
                              const PartialDensificationOptions& options, int num_threads,
                              const SequenceCallbacks& callbacks, const StereoRig& rig,
                              const SequenceScope& scope);

}  // namespace colmap_seapoint
