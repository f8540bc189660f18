// What the clouds of automatic_reconstructor cover, and what is missing.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// WORKSPACE/report/completeness/<k> for every model with a cloud; reports that are there already,
// of the same inputs, are kept. The answers come into the models' summaries. A model that cannot be
// judged ends nothing: its answer says why. With --completeness 0 nothing is done, and what earlier
// runs left is removed.
void ReportCompletenessOfModels(const AutomaticReconstructorOptions& options,
                                const Workspace& workspace, const std::string& mapper_fingerprint,
                                WorkspaceState* state, std::vector<ModelSummary>* models,
                                RunReport* report);

}  // namespace colmap_seapoint
