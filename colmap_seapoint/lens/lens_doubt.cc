#include "colmap_seapoint/lens/lens_doubt.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "colmap_seapoint/adjustment/equations/lens_jacobian.h"

namespace colmap_seapoint {
namespace {

constexpr double kSigmas = 2;
constexpr double kKnownGsd = 1;
constexpr double kMinCorrelation = 0.5;

// What a person calls a parameter of a lens.
std::string NameOf(CameraModel model, size_t param) {
  const auto num_focals = static_cast<size_t>(NumFocals(model));
  if (param < num_focals) return "the focal length";
  if (param < num_focals + 2) return "the principal point";
  return "the distortion";
}

}  // namespace

LensDoubt DoubtOf(const BundleAdjustment& adjustment, const GroundFrame& frame,
                  double forms_curvature) {
  const double curvature = std::max(kSigmas * adjustment.centre_sigma, forms_curvature);
  LensDoubt doubt;
  doubt.bend = BendInGsd(curvature, adjustment.model, frame);
  double strongest = kMinCorrelation;
  for (const auto& [id, correlations] : adjustment.centre_correlations) {
    for (size_t k = 0; k < correlations.size(); ++k) {
      if (!(std::abs(correlations[k]) > strongest)) continue;
      strongest = std::abs(correlations[k]);
      doubt.trades_with = NameOf(adjustment.model.cameras.at(id).model, k);
    }
  }
  return doubt;
}

std::string Say(const LensDoubt& doubt) {
  char near[100], whole[60];
  std::snprintf(near, sizeof(near),
                "the ground may be bent by %.1f GSD over 5 times the camera's distance",
                doubt.bend.near);
  if (doubt.bend.whole <= kKnownGsd) return near;
  std::snprintf(whole, sizeof(whole), ", by %.0f over the whole survey", doubt.bend.whole);
  const std::string text =
      near + (doubt.bend.whole > doubt.bend.near ? std::string(whole) : std::string());
  const std::string trade =
      doubt.trades_with.empty() ? "" : " (it trades places with " + doubt.trades_with + ")";
  return text + trade +
         "; positions (GPS, a log), a strip crosswise, the camera turned by 90 degrees, or a lens "
         "calibrated in water would tell";
}

}  // namespace colmap_seapoint
