#include "colmap_seapoint/joining/join_models.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <set>
#include <vector>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/joining/link_evidence.h"
#include "colmap_seapoint/joining/merge_models.h"

namespace colmap_seapoint {
namespace {

constexpr double kGoodError = 0.5;  // pixels
constexpr double kMaxErrorRatio = 1.5;
constexpr double kMaxErrorOfLink = 4;  // times the limit of the median
constexpr double kMinShareKept = 0.8;

struct Errors {
  std::vector<double> across, within;  // of each observation, pixels
};

// By whether both models see the point.
Errors ErrorsOf(const SparseModel& model, const std::set<uint64_t>& links) {
  Errors errors;
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const auto point = model.points3D.find(image.point3D_ids[i]);
      if (point == model.points3D.end()) continue;
      const auto shown = camera.ImgFromCam(image.cam_from_world * point->second.xyz);
      const double error =
          shown ? (*shown - image.points2D[i]).norm() : std::numeric_limits<double>::infinity();
      (links.count(point->first) > 0 ? errors.across : errors.within).push_back(error);
    }
  }
  return errors;
}

std::string Text(const char* format, double first, double second) {
  char text[160];
  std::snprintf(text, sizeof(text), format, first, second);
  return text;
}

// What the adjusted model says against the join; "" when nothing does.
std::string Tension(const Errors& errors) {
  if (errors.across.empty()) return "no point is left that both see";
  std::vector<double> across = errors.across, within = errors.within;
  const double middle_across = UpperMedian(across);
  const double middle_within = within.empty() ? 0 : UpperMedian(within);
  const double limit = std::max(kGoodError, kMaxErrorRatio * middle_within);
  if (!(middle_across <= limit)) {
    return Text("adjusted as one, what both see is off by %.2f px, the rest by %.2f px",
                middle_across, middle_within);
  }
  const auto num_kept = std::count_if(errors.across.begin(), errors.across.end(),
                                      [&](double e) { return e <= kMaxErrorOfLink * limit; });
  const double share = static_cast<double>(num_kept) / static_cast<double>(errors.across.size());
  if (share >= kMinShareKept) return "";
  return Text("adjusted as one, %.0f %% of what both see is off by more than %.1f px",
              100 * (1 - share), kMaxErrorOfLink * limit);
}

BundleAdjustmentOptions AdjustmentOf(const JoinOptions& options, const SparseModel& model) {
  BundleAdjustmentOptions adjustment;
  adjustment.refine_principal_point = options.refine_principal_point;
  // The links must show their errors, not be passed over.
  adjustment.last_loss.reset();
  adjustment.num_threads = options.num_threads;
  if (!options.refine_lens) adjustment.lenses = AllLensesHeld(model);
  return adjustment;
}

}  // namespace

JoinedModel JoinModels(const ColmapDatabase& database, const SparseModel& a, const SparseModel& b,
                       const JoinOptions& options) {
  const ModelLinks links = FindModelLinks(database, a, b);
  if (links.links.empty()) return {{}, "no match between them"};
  const auto consensus = FindLinkConsensus(a, b, links.links);
  if (!consensus) return {{}, "their matches agree on no way to join them"};
  const LinkEvidence evidence = WeighLinks(a, b, links, *consensus);
  const std::string doubt = Doubt(evidence, *consensus);
  if (!doubt.empty()) return {{}, doubt};
  MergedModel merged = MergeModels(a, b, links.links, *consensus);
  auto adjusted = AdjustBundle(AdjustmentOf(options, merged.model), merged.model);
  if (!adjusted) return {{}, "they cannot be adjusted as one"};
  const std::string tension = Tension(ErrorsOf(*adjusted, merged.links));
  if (!tension.empty()) return {{}, tension};
  return {std::move(adjusted), "by " + std::to_string(merged.links.size()) + " points in " +
                                   std::to_string(evidence.num_pictures_a) + " and " +
                                   std::to_string(evidence.num_pictures_b) + " pictures"};
}

}  // namespace colmap_seapoint
