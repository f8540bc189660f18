// An estimated model and its dense cloud against the exact surface.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/survey.h"

namespace colmap_seapoint {

struct ScoreOptions {
  bool truth_poses = false;  // the model is in the truth's frame already: no alignment
  bool refine = false;       // fit the aligned cloud to the surface as well; not the official score
  int num_threads = -1;
};

struct SurveyScore {
  double gsd = 0;  // metres
  bool refined = false;
  // Alignment: a similarity on the camera centres of pictures with the same name.
  int num_images = 0;
  int num_registered = 0;
  double centre_rms = 0, centre_max = 0;  // metres
  double scale = 1;                       // truth over model
  // Accuracy: distance of every point to the nearest point of the surface.
  size_t num_points = 0;
  double share_1gsd = 0, share_2gsd = 0, share_4gsd = 0;
  double median_gsd = 0, mean_gsd = 0;  // in GSD; distances count as at most 64 GSD
  // Coverage: share of the twice-seen surface (by area) that has a point nearby.
  double twice_seen_m2 = 0;
  double coverage_2gsd = 0, coverage_4gsd = 0;
  // Density: points within 4 GSD of the surface, over its covered, twice-seen area.
  double points_per_gsd2 = 0, points_per_cm2 = 0;
  double redundancy = 0;  // mean number of such points in an occupied cell of 1 GSD (x, y)
};

// `points` in the model's frame. Throws Error when the cloud is empty or the model cannot be
// aligned (fewer than 3 pictures in common). A million points take seconds; memory is about 40
// bytes a point beside the surface's own.
SurveyScore ScoreSurvey(const SurveyTruth& truth, const SparseModel& model,
                        std::vector<Eigen::Vector3f> points, const ScoreOptions& options);

std::string ScoreJson(const SurveyScore& score);
std::string ScoreTable(const SurveyScore& score);

}  // namespace colmap_seapoint
