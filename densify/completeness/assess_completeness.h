// "Did we cover it all, and where must we go back?" (ours; what the paper's clouds are made for.)
//
// From any COLMAP model, any cloud in its frame, and what was measured in the pictures:
//   1. the cloud becomes cells of the surface (ground.h), and is drawn into every picture with a
//   depth
//      buffer (survey_views.h): what is covered;
//   2. every cell that is not covered is looked at from all pictures (sightings.h): which of them
//   see
//      it, hidden or not, sharp or not, from how many sides; so why it is missing (judge_ground.h);
//   3. what nobody imaged inside the survey's outline is added (outline.h), and the causes go back
//   into
//      the pictures' own cells (picture_records.h);
//   4. missing cells become gaps with a pass that closes each (gap_regions.h, closing_pass.h).
// Nothing is interpolated: the predicted surface only says where a gap is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "densify/completeness/completeness_options.h"
#include "densify/completeness/gaps/closing_pass.h"
#include "densify/completeness/gaps/gap_ids.h"
#include "densify/completeness/picture_records.h"

namespace colmap_seapoint {

// Raise it whenever the same inputs and options give another answer than before.
inline constexpr char kCompletenessVersion[] = "5";

struct ConfidentPoint {
  SurfacePoint place;
  float confidence = 1;
  std::array<uint32_t, 2> pictures = {};  // image_idx of those it is from; for the self check alone
};

// A gap of an earlier report on the same frame.
struct FormerOutline {
  int id = 0;
  LayerKey layer;
  std::vector<std::vector<Eigen::Vector3d>> rings;  // world
};

// The same in the plan of its layer.
FormerGap InPlan(const FormerOutline& outline, const PlanFrame& frame);

struct CompletenessInput {
  const SparseModel* model = nullptr;  // with points and their ids by image (ModelContent)
  // Calls its argument for every point of the cloud, in order. Called twice.
  std::function<void(const std::function<void(const ConfidentPoint&)>&)> for_each_point;
  uint64_t num_points = 0;
  // The plan for a sample of the cloud; empty: the world's own.
  std::function<PlanFrame(const std::vector<Eigen::Vector3d>&)> frame_of;
  std::vector<PictureFacts> facts;           // by image_idx; Empty(): nobody has looked at it
  std::vector<std::string> lost;             // names of pictures that are in no model
  std::vector<std::string> posed_elsewhere;  // and of those that are in another one
  AskedArea asked;                    // in the map's plan; Empty(): the outline of what was imaged
  std::vector<FormerOutline> former;  // gaps of the report before, for their ids
  int last_id = 0;                    // the largest id ever given
};

struct Gap {
  int id = 0;
  GapRegion region;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world
  std::vector<std::vector<Eigen::Vector3d>> outline;   // region.rings, world, on the surface
  std::vector<int> pictures;                           // image_idx, nearest first, up to 5
  ClosingPass pass;
  double AreaPerLength() const { return region.area / pass.length; }
};

// What as many points as a spacing asks for cover (ground.h).
struct CoverageAt {
  double spacing = 0;  // units
  double area = 0;     // units^2, of what is expected
  double share = 0;    // of the expected area
};

// What came of hiding pictures from the report (densify/self_check).
struct SelfCheck {
  int num_folds = 0;       // 0: nothing was checked
  double hidden_area = 0;  // units^2 of covered surface that went with the pictures, over all folds
  double beyond_share = 0;  // of it: beyond the outline of what was left, which nobody can miss
  double found_share = 0;   // of the rest: said to be missing
  double false_share = 0;   // of what was said to be missing in addition: no part of the survey
  // Said over true area that is missing, less 1: root of the mean square over the folds.
  double area_error = 0;
};

struct CompletenessResult {
  // Of the sample of the cloud that is in a picture: small when cloud and model do not belong
  // together. Below kMinBelonging nothing else is filled.
  double belonging_share = 0;
  // Of the asked area, which holds too many cells of two wanted spacings: nothing else is filled.
  bool is_area_too_large = false;
  double gsd = 0;                      // units a pixel: median of the better pair's
  double spacing = 0;                  // units
  double expected_area = 0;            // units^2, along the surface
  std::array<CoverageAt, 3> coverage;  // at the spacing, at 2 and at 4 times it
  // Of the share at the wanted spacing, +-: what is thin (ground.h), which another threshold would
  // have judged otherwise; and with a self check how wrong the area of what is missing was where
  // the survey itself could tell. What is wrong with the cloud is not in it.
  double share_tolerance = 0;
  SelfCheck self_check;  // num_folds 0: not asked for, or too few pictures
  std::array<double, kNumGapCauses> missing_area = {};  // by cause; all cells, also of small gaps
  double mean_views = 0, median_parallax_deg = 0;       // of covered cells
  double points_per_area = 0;                           // units^-2, of covered cells
  Ground ground;
  std::vector<PictureRecord> records;  // by image_idx
  std::vector<LostRun> lost_runs;
  double unlisted_area = 0;      // of what is missing in gaps too small to go back to
  std::vector<Gap> gaps;         // ranked: most area for a unit of length first
  std::vector<RouteStop> route;  // over `gaps`
  int last_id = 0;               // the largest that was ever given
  double route_length = 0;       // passes and ways between, units
};
inline constexpr double kMinBelonging = 0.5;

// The same for any number of threads. Memory: 24 bytes a cell of the ground, 2 a depth cell of
// every picture; the cloud is streamed.
CompletenessResult AssessCompleteness(const CompletenessInput& input,
                                      const CompletenessOptions& options, int num_threads);

}  // namespace colmap_seapoint
