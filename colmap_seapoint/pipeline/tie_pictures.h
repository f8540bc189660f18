// Pictures that the second chance has not tied either, matched by views from above (ours).
#pragma once

#include <set>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/pipeline/stage_runner.h"
#include "colmap_seapoint/pipeline/workspace.h"

namespace colmap_seapoint {

// pairing/tilted_pairs.h for the pictures of the second chance, a tilt after the other, as long as
// they hang together in more than one group. Once for the same `inputs`, which tell which SeaPoints
// and matches there are. Says what it has tied, and adds its seconds to `report`.
void TiePictures(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                 const std::set<std::string>& second_chance_names, const std::string& inputs,
                 ColmapDatabase* database, WorkspaceState* state, RunReport* report);

}  // namespace colmap_seapoint
