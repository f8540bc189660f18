// A survey of a level seabed with exact poses, and clouds of it with exact gaps.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// Strips along y, one picture behind the other, seen from kFlatAltitude straight down. A picture
// shows 6.4 x 4.8 units; the seabed is the plane z = 0. Named "s0_00.jpg", ...
inline constexpr double kFlatAltitude = 5, kFlatGsd = 0.02;
struct FlatSurveyOptions {
  int num_strips = 3, per_strip = 6;
  double forward = 1.6, side = 3.2;  // units from picture to picture, from strip to strip
};
SparseModel MakeFlatSurvey(const FlatSurveyOptions& options = {});
void RemoveImages(const std::set<std::string>& names, SparseModel* model);

using KeepPoint = std::function<bool(const Eigen::Vector2d&)>;

// Everything but the cloud's and pictures' faults: a point at every GSD that two pictures of the
// model see, if `keep` lets it; pictures of full texture.
CompletenessInput FlatInput(const SparseModel& model, const KeepPoint& keep);
// Pictures that hold a place that many pixels from their edges.
int TimesSeen(const SparseModel& model, const Eigen::Vector3d& place, double margin = 0);
// Area (plan) of the seabed about the model where that holds.
double AreaWhere(const SparseModel& model,
                 const std::function<bool(const Eigen::Vector3d&)>& holds);
// Area (plan) that pictures of the model see this often at least.
double AreaSeen(const SparseModel& model, int times);

PictureFacts TexturedFacts();  // of a picture of the survey

double AreaOf(const CompletenessResult& result, GapCause cause);  // of its listed gaps

}  // namespace colmap_seapoint
