// The whole survey with its exact truth, in memory and on disk.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/paths/survey_options.h"
#include "examples/survey/scene/boards.h"
#include "examples/survey/scene/surface.h"

namespace colmap_seapoint {

struct SurveyTruth {
  SparseModel model;  // exact cameras; some exact points with the pictures that see them
  Surface surface;    // exact surface, in the model's frame
  PortOptions port;   // what the pictures were taken through; the model's camera is as in water
  std::vector<MarkerBoard> boards;  // with coded markers; a part of the surface too
  double gsd = 0;                   // metres a pixel: mean over all that the pictures show (GsdAt)
  double max_range = std::numeric_limits<double>::infinity();  // metres; farther counts as unseen
};

// Cameras, surface and points; no picture yet. `more`: pictures of a second dive over the same
// ground, which follow those of the survey. Throws UsageError for illegal options.
SurveyTruth MakeSurveyTruth(const SurveyOptions& options, std::vector<PosedImage> more = {});

// Calls `take` with every picture, in order. The same bytes for any number of threads.
void RenderSurvey(const SurveyOptions& options, const SurveyTruth& truth,
                  const std::function<void(const PosedImage&, ColorImage&&)>& take);

// Layout of a survey's folder:
//   images/                 the pictures
//   truth/sparse/           cameras.txt, images.txt, points3D.txt
//   truth/surface.bin       heights, float32 little-endian, row by row from min y
//   truth/surface.json      first node, number of nodes, cell size; a wall's turn
//   truth/object.bin        x, y, z of the object's nodes, float32, row by row, if there is one
//   truth/survey.json       options and gsd; coded markers, if there are any
//   truth/bars.csv          exact lengths between these, as --scale_bars_path takes them
void WriteSurveyTruth(const std::filesystem::path& dir, const SurveyOptions& options,
                      const SurveyTruth& truth);

// Throws Error when the folder is no survey, or is damaged.
SurveyTruth ReadSurveyTruth(const std::filesystem::path& dir);

}  // namespace colmap_seapoint
