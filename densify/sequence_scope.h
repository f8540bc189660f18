// Densification of a part of a survey: of the pictures that came in since an earlier run, or of a
// block (ours). Internal.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"
#include "densify/overlap/earlier_surface.h"
#include "densify/partial_densification_options.h"
#include "densify/sequence/picture_source.h"
#include "densify/sequence_report.h"

namespace colmap_seapoint {

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
