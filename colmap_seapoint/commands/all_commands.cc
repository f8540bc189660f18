#include "colmap_seapoint/commands/automatic_reconstructor.h"
#include "colmap_seapoint/commands/cloud_comparer.h"
#include "colmap_seapoint/commands/command.h"
#include "colmap_seapoint/commands/feature_extractor.h"
#include "colmap_seapoint/commands/matchers.h"
#include "colmap_seapoint/commands/model_scaler.h"
#include "colmap_seapoint/commands/partial_densifier.h"

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
      MakeCommand("model_scaler", "COLMAP model and cloud -> metres, from scale bars and positions",
                  RunModelScaler),
      MakeCommand("partial_densifier", "COLMAP model and pictures -> one dense cloud",
                  RunPartialDensifier),
      MakeCommand("cloud_comparer", "two clouds in one frame -> accuracy, completeness, density",
                  RunCloudComparer),
      MakeCommand("automatic_reconstructor", "a folder of pictures -> dense clouds, all in one",
                  RunAutomaticReconstructor),
  };
}

}  // namespace colmap_seapoint
