// WORKSPACE/report/index.html: the models of a run, and the run itself, on one page.
#pragma once

#include <vector>

#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// Of the models' pages (report/completeness/<k>/index.html) what they hold; a model without one is
// told of in the answer alone. Atomic. Throws Error when the page cannot be written.
void WriteJobPage(const Workspace& workspace, const std::vector<ModelSummary>& models,
                  const RunReport& report);

}  // namespace colmap_seapoint
