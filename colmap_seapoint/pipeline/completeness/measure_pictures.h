// What the pictures of a model themselves tell, each read once.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "densify/completeness/sight/picture_facts.h"

namespace colmap_seapoint {

struct PictureFolders {
  std::filesystem::path images;
  std::string masks;                 // "" = none
  std::filesystem::path facts_file;  // facts_file.h; "" = nothing is kept
};

struct PictureMeasures {  // by image_idx
  std::vector<PictureFacts> facts;
  std::vector<double> brightness;  // mean level; -1: unknown
};

// Judged (JudgePictures). A picture that cannot be read is left out by name, and counts as a bad
// one. What the facts file holds of a picture that has not changed is taken from there, and all
// that is known now is written to it. `done(k)`: k pictures are; from any thread, one at a time.
// Throws Error when none can be read.
PictureMeasures MeasurePictures(const SparseModel& model, const PictureFolders& folders,
                                int num_threads, const std::function<void(int64_t)>& done,
                                RunReport* report);

}  // namespace colmap_seapoint
