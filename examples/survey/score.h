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
  bool refine = false;       // fit the aligned cloud to the ground as well; not the official score
  int num_threads = -1;
};

struct ScoredCloud {
  std::vector<Eigen::Vector3f> points;  // model's frame
  // By point, in the model's unit a pixel: the mean over the pictures that made it (view_gsd.h).
  // Empty when these are not known.
  std::vector<float> view_gsd;
};

// Distances of all points, in GSD of one kind; each counts as at most 64 mean GSD.
struct AccuracyScore {
  double share_1gsd = 0, share_2gsd = 0, share_4gsd = 0;
  double median_gsd = 0, mean_gsd = 0;
};

struct SurveyScore {
  double gsd = 0;  // metres, the survey's mean
  bool refined = false;
  // Alignment: a similarity on the camera centres of pictures with the same name.
  int num_images = 0;
  int num_registered = 0;
  double centre_rms = 0, centre_max = 0;  // metres
  double scale = 1;                       // truth over model
  // Accuracy: distance of every point to the nearest point of the surface, in the mean GSD; in the
  // point's own, which is the best that two pictures that hold it can do (BestPairGsd); and in that
  // of the pictures that made it. The three are alike where all pictures are taken from one height.
  size_t num_points = 0;
  AccuracyScore accuracy, own_accuracy, view_accuracy;
  bool has_views = false;  // else view_accuracy means nothing
  // Coverage: share of the twice-seen surface (by area) that has a point nearby, in mean GSD.
  double twice_seen_m2 = 0;
  double coverage_2gsd = 0, coverage_4gsd = 0;
  // The same of what two pictures see kMinParallaxDeg apart, in GSD of the best such pair.
  double parallax_seen_m2 = 0;
  double parallax_coverage_2gsd = 0, parallax_coverage_4gsd = 0;
  // Density: points within 4 GSD of the surface, over its covered, twice-seen area.
  double points_per_gsd2 = 0, points_per_cm2 = 0;
  // Mean number of such points in an occupied cell of 1 GSD: x, y of the ground; with an object,
  // x, y and z. The same in cells of the points' own GSD: near places are sampled more densely.
  double redundancy = 0, own_redundancy = 0;
};

// Throws Error when the cloud is empty or the model cannot be aligned (fewer than 3 pictures in
// common). A million points take seconds; memory is about 120 bytes a point beside the surface's
// own.
SurveyScore ScoreSurvey(const SurveyTruth& truth, const SparseModel& model, ScoredCloud cloud,
                        const ScoreOptions& options);

std::string ScoreJson(const SurveyScore& score);
std::string ScoreTable(const SurveyScore& score);

}  // namespace colmap_seapoint
