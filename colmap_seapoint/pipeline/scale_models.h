// The models of automatic_reconstructor, brought into metres before they are densified; the coded
// markers of its pictures.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/markers/marker_name.h"
#include "colmap_seapoint/pipeline/scale.h"
#include "colmap_seapoint/report/reconstruction_summary.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// What automatic_reconstructor looks for, and in which pictures.
struct MarkerSearch {
  std::vector<MarkerFamily> families;  // empty: nothing is looked for
  std::vector<RunReport::Input> pictures;
  int num_threads = -1;
};

// The stage "markers" of a workspace: found_markers.csv, made once for the same pictures and
// families. Without families, what an earlier run made is removed. Returns what was found.
std::vector<MarkerSighting> FindMarkersOnce(const MarkerSearch& search, const Workspace& workspace,
                                            WorkspaceState* state, RunReport* report);

// WORKSPACE/sparse/<k> -> WORKSPACE/sparse_scaled/<k> for every model, where `scaler` names
// sources, or the pictures' `records` hold GPS; what an earlier run has done already is taken as it
// is. Sets path, units and scaling of the models. A model that cannot be scaled stays as it is, and
// is named in the report; throws Error when none can. A model that GPS or a log cannot scale stays
// as it is, too, and its `scaling` says why. Where pictures came in, and what is measured of the
// model with them agrees with how it was scaled before, that is kept: what was made of it stays as
// it is. Without sources, removes what earlier runs with some left in sparse_scaled.
RunReport ScaleAllModels(ModelScalerOptions scaler, const PictureRecords& records,
                         const Workspace& workspace, const std::string& mapper_fingerprint,
                         WorkspaceState* state, std::vector<ModelSummary>* models);

}  // namespace colmap_seapoint
