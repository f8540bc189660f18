// The first half of automatic_reconstructor: SeaPoints and matches of all pictures, and what is
// tried for those that nothing ties to the others.
#pragma once

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

FeatureExtractorOptions ExtractorOptions(const AutomaticReconstructorOptions& options,
                                         const Workspace& workspace);

// Extracts and matches; untied pictures and their partners get SI-SeaPoints beside their own
// (mapping/second_chance.h), and what is untied then is matched by views from above
// (pairing/tilted_pairs.h). Where neither ties anything, all is as if it had not been tried: a
// picture of the deck must not change what is known of the dive. `database_stage` began the
// database. What an earlier run found is not looked for again as long as the pictures are the same.
void ExtractAndTie(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                   const PictureSet& pictures, const Stage& database_stage,
                   ColmapDatabase* database, WorkspaceState* state, RunReport* report);

}  // namespace colmap_seapoint
