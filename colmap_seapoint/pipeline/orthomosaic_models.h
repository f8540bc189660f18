// The models of automatic_reconstructor, each with a map of its own.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// WORKSPACE/map/<k> for every model with a cloud; maps that are there already, of the same inputs,
// are kept. A model that no map can be made of is named in `report`. Without --map, what earlier
// runs made is removed.
void MakeMaps(const AutomaticReconstructorOptions& options, const Workspace& workspace,
              const std::string& mapper_fingerprint, WorkspaceState* state,
              std::vector<ModelSummary>* models, RunReport* report);

}  // namespace colmap_seapoint
