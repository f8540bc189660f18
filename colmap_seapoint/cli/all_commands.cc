#include "colmap_seapoint/cli/command.h"
#include "colmap_seapoint/merging/cloud_merger.h"
#include "colmap_seapoint/pipeline/cloud_exporter.h"
#include "colmap_seapoint/pipeline/compare.h"
#include "colmap_seapoint/pipeline/completeness/completeness_reporter.h"
#include "colmap_seapoint/pipeline/densify.h"
#include "colmap_seapoint/pipeline/extract.h"
#include "colmap_seapoint/pipeline/markers/marker_finder.h"
#include "colmap_seapoint/pipeline/markers/print_markers.h"
#include "colmap_seapoint/pipeline/match.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_maker.h"
#include "colmap_seapoint/pipeline/scale.h"
#include "colmap_seapoint/rendering/render_cloud.h"
#include "colmap_seapoint/watch/watch_survey.h"

namespace colmap_seapoint {

std::vector<Command> AllCommands() {
  return {
      MakeCommand("feature_extractor", "find SeaPoints in pictures, into a COLMAP database",
                  RunFeatureExtractor),
      MakeCommand("sequential_matcher",
                  "match each picture with those that follow, and look like, it",
                  RunSequentialMatcher),
      MakeCommand("exhaustive_matcher", "match every picture with every other one",
                  RunExhaustiveMatcher),
      MakeCommand("spatial_matcher", "match each picture with those taken near it",
                  RunSpatialMatcher),
      MakeCommand("marker_finder", "find coded markers in pictures, into a table", RunMarkerFinder),
      MakeCommand("marker_sheet", "coded markers and scale bars to print, as a PDF",
                  RunPrintMarkers),
      MakeCommand("model_scaler", "COLMAP model and cloud -> metres, from scale bars and positions",
                  RunModelScaler),
      MakeCommand("partial_densifier", "COLMAP model and pictures -> one dense cloud",
                  RunPartialDensifier),
      MakeCommand("cloud_comparer", "two clouds in one frame -> accuracy, completeness, density",
                  RunCloudComparer),
      MakeCommand("cloud_merger", "clouds of the blocks of a survey -> one, without duplicates",
                  RunCloudMerger),
      MakeCommand("cloud_exporter", "a cloud -> LAS or LAZ, where it lies on the Earth",
                  RunCloudExporter),
      MakeCommand("orthomosaic", "model, pictures and cloud -> relief and orthomosaic, as GeoTIFFs",
                  RunOrthomosaic),
      MakeCommand("completeness_reporter",
                  "what a cloud covers, what is missing, why, and a route that closes it",
                  RunCompletenessReporter),
      MakeCommand("render_cloud", "a cloud -> a picture of it, from above or as a camera saw it",
                  RunCloudRenderer),
      MakeCommand("automatic_reconstructor", "a folder of pictures -> dense clouds, all in one",
                  ReconstructOrWatch),
  };
}

}  // namespace colmap_seapoint
