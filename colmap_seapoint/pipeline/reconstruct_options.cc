#include "colmap_seapoint/pipeline/reconstruct_options.h"

#include <filesystem>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/georeference/scale_measurements.h"
#include "colmap_seapoint/pictures/read_rig.h"
#include "colmap_seapoint/workspace/output_paths.h"

namespace colmap_seapoint {

void AutomaticReconstructorOptions::Bind(OptionTable* table) {
  table->AddRequired("image_path", &image_path,
                     "folder of the pictures (JPEG, PNG, TIFF, HEIC, RAW), sub-folders included; "
                     "or a video, or a folder of clips");
  table->AddRequired(
      "workspace_path", &workspace_path,
      "folder for database.db, sparse/, dense/, map/ and report/; created when missing");
  table->Add("colmap_path", &colmap_path, "the colmap program: a path, or a name on PATH", "ours");
  table->Add("colmap_timeout", &colmap_timeout,
             "seconds that one run of colmap may take before it is stopped; 0 = no limit", "ours",
             0, 1e8);
  table->Add(
      kQualityOption, &quality,
      "what posing may cost. field: a coarse mapper, or global_mapper where this COLMAP has "
      "it, for all that the lens adjustment mends afterwards; survey: the mapper adjusts "
      "more often; archive: COLMAP's own adjustments, twice the SeaPoints, SIFT beside rBRIEF",
      "ours", {"field", "survey", "archive"});
  table->Add("matcher", &matcher,
             "which pairs are tried; auto = all pairs of up to " +
                 std::to_string(kMaxImagesForAllPairs) + " pictures, else sequential",
             "ours", {"auto", "sequential", "exhaustive"});
  table->Add("adjust_principal_point", &adjust_principal_point,
             "after mapping, adjust every model once more with the principal point free; not with "
             "--ImageReader.camera_params or --Mapper.ba_refine_*",
             "ours");
  table->Add("join_models", &join_models,
             "make one of two models where verified matches between them can be trusted; 0 where "
             "places look so alike that it joins what does not belong together",
             "ours");
  BindField(table);
  table->Add("map", &makes_map,
             "make relief and orthomosaic of every model, in map/; 0 = none, and those of earlier "
             "runs are removed",
             "ours");
  table->Add("rig", &rig, kRigHelp, "paper 4");
  table->Add("mask_path", &reader.mask_path, "the same as --ImageReader.mask_path", "COLMAP");
  scale.Bind(table);
  frames.Bind(table);
  reader.Bind(table);
  extraction.Bind(table);
  pairs.Bind(table);
  matching.Bind(table);
  densification.Bind(table);
  map.Bind(table, "Orthomosaic.");
  table->Add("completeness", &report_completeness,
             "at the end, report what the clouds cover and where to go back to, in "
             "report/completeness/",
             "ours");
  completeness.Bind(table);
  run.Bind(table);
  table->MarkOutput("workspace_path");
}

// On a boat: a disk, a battery, pictures that are still coming.
void AutomaticReconstructorOptions::BindField(OptionTable* table) {
  table->Add(
      "check_disk", &check_disk,
      "end where the disk has by far too little room for what is left, and nothing that can be "
      "made again is left to remove; with --watch, wait for room; 0 = go on all the same",
      "ours");
  table->Add("estimate_only", &estimate_only,
             "say what the job will take in time, disk and memory, as JSON, and do nothing",
             "ours");
  table->Add("pause_on_battery", &pause_on_battery,
             "work pauses while the battery is discharged and holds so many per cent or less, and "
             "goes on when the machine has power again; 0 = never",
             "ours", 0, 100);
  table->Add("watch", &watch,
             "take in pictures as they come into --image_path, say when their overlap drops, and "
             "keep map and page up to date; Ctrl-C: no more will come, make the whole of it",
             "ours");
  table->Add("watch_idle", &watch_idle,
             "with --watch: seconds without a new picture after which no more are expected; 0 = "
             "until Ctrl-C",
             "ours", 0, 1e6);
}

void AutomaticReconstructorOptions::Preset() {
  reader.Preset();
  if (quality != "archive") return;
  extraction.min_num_features *= 2;
  extraction.max_num_features *= 2;
  extraction.descriptor = "sift";
}

ForeignOptions AutomaticReconstructorOptions::Foreign() {
  return {"Mapper",
          "handed on to colmap ('colmap mapper -h' lists them); Mapper.num_threads is 1 unless "
          "given, since the mapper's result differs from run to run with more",
          &mapper};
}

namespace {

// What a watch makes would come in as pictures.
bool IsBelow(const std::string& path, const std::string& folder) {
  std::error_code ignored;
  const auto relative = std::filesystem::weakly_canonical(path, ignored)
                            .lexically_relative(std::filesystem::weakly_canonical(folder, ignored));
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

void AutomaticReconstructorOptions::Check() const {
  CheckOutputPaths(*this);
  for (const std::string& problem :
       {reader.Check(), extraction.Check(), densification.Check(), CheckRig(rig), scale.Check()}) {
    if (!problem.empty()) throw UsageError(problem);
  }
  const std::string map_problem = map.Check();
  if (!map_problem.empty()) throw UsageError("--Orthomosaic." + map_problem);
  if (!std::filesystem::exists(image_path)) {
    throw Error(image_path, "there is no such folder or video", "check --image_path");
  }
  if (watch && !std::filesystem::is_directory(image_path)) {
    throw UsageError("--watch: " + image_path + " is no folder that pictures could come into");
  }
  if (watch && IsBelow(workspace_path, image_path)) {
    throw UsageError("--watch: --workspace_path " + workspace_path +
                     " lies in the folder that is watched; choose one beside it");
  }
  CheckRigFolders(rig, image_path);
  CheckScaleTables(scale);
}

bool GivesRefinement(const AutomaticReconstructorOptions& options) {
  const auto refinement = options.mapper.lower_bound("Mapper.ba_refine");
  return refinement != options.mapper.end() && refinement->first.rfind("Mapper.ba_refine", 0) == 0;
}

}  // namespace colmap_seapoint
