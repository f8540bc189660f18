// The models of automatic_reconstructor, each densified into a folder of its own.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// WORKSPACE/dense/<k> for every model; clouds that are there already, of the same inputs, are kept.
// A model that gives no point is left out of `report`; throws Error when none gives one.
void DensifyModels(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                   const std::string& mapper_fingerprint, ColmapDatabase* database,
                   WorkspaceState* state, std::vector<ModelSummary>* models, RunReport* report);

}  // namespace colmap_seapoint
