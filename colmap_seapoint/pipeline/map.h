// The stage between matches and the dense cloud: the unmodified `colmap mapper`, and what we adjust
// of its models.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/mapping/run_mapper.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

struct MappingPlan {
  ColmapProgram colmap;
  MapperJob job;                 // but for the pictures, which are known once they are matched
  std::filesystem::path sparse;  // where the models are put when all of them are made
};

// Checks what mapping needs before any work is done. Throws Error when there is no COLMAP,
// UsageError for a --Mapper option that it does not know.
MappingPlan PlanMapping(const AutomaticReconstructorOptions& options, const Workspace& workspace);

struct Mapping {
  std::string fingerprint;                    // of all that the models depend on
  std::vector<std::filesystem::path> models;  // ours in WORKSPACE/sparse, in natural order
  std::vector<RunReport::Stage> seconds;
};

// The models in WORKSPACE/sparse: those that are there, if nothing changed, or new ones in place of
// them. What else is in that folder stays, and is not among them. Throws Error when no two pictures
// show the same place, when a model of somebody else's has a number for its name, and as RunMapper
// does.
Mapping MapPictures(MappingPlan plan, const ColmapDatabase& database, WorkspaceState* state);

}  // namespace colmap_seapoint
