// The models of automatic_reconstructor, brought into metres before they are densified.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/pipeline/scale.h"
#include "colmap_seapoint/pipeline/stage_runner.h"
#include "colmap_seapoint/pipeline/workspace.h"
#include "colmap_seapoint/report/reconstruction_summary.h"

namespace colmap_seapoint {

// WORKSPACE/sparse/<k> -> WORKSPACE/sparse_scaled/<k> for every model, where `scaler` names
// sources, or the pictures' `records` hold GPS; what an earlier run has done already is taken as it
// is. Sets path, units and scaling of the models. A model that cannot be scaled stays as it is, and
// is named in the report; throws Error when none can. A model that GPS or a log cannot scale stays
// as it is, too, and its `scaling` says why. Without sources, removes what earlier runs with some
// left in sparse_scaled.
RunReport ScaleAllModels(ModelScalerOptions scaler, const PictureRecords& records,
                         const Workspace& workspace, const std::string& mapper_fingerprint,
                         WorkspaceState* state, std::vector<ModelSummary>* models);

}  // namespace colmap_seapoint
