// Which pictures see a place, how, and what follows for why nothing came out there.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "densify/completeness/sight/lost_pictures.h"
#include "densify/completeness/sight/picture_facts.h"
#include "densify/completeness/sight/survey_views.h"
#include "densify/completeness/surface/gap_cause.h"

namespace colmap_seapoint {

// Of pictures that nobody has looked at.
inline constexpr uint8_t kUnknownTexture = 255;

// kHidden: something stands before the place, or its surface is turned away. kEdge: so near to the
// picture's edge that nothing can be matched there.
enum class SightKind : uint8_t { kGood, kBad, kHidden, kMasked, kEdge };

struct Sight {
  SightKind kind = SightKind::kGood;
  uint8_t texture = 0;     // as in PictureFacts
  double gsd = 0;          // units a pixel on the surface, mean of both directions
  double across = 0;       // units a pixel across the line of sight
  Eigen::Vector3d toward;  // unit, from the place to the camera
};

// What all judgements share. Everything is owned by the caller.
struct SightContext {
  const std::vector<SurveyView>* views;
  const std::vector<DepthCells>* depths;
  const std::vector<PictureFacts>* facts;  // by image_idx; Empty(): not looked at
  const LostSight* lost;
  double cell_side = 1;  // units
  double min_parallax_deg = 2;
};

// `normal` need not be of unit length. The pictures that hold the place within their range, in the
// order of `candidates`. A surface at more than 80 degrees from its normal is hidden.
std::vector<Sight> SightsOf(const SightContext& context, const std::vector<int>& candidates,
                            const Eigen::Vector3d& place, const Eigen::Vector3d& normal);

// Largest angle between two good ones, degrees; 0 for fewer than two.
double ParallaxDeg(const std::vector<Sight>& sights);
// Good ones.
int NumGood(const std::vector<Sight>& sights);
// GSD of the coarser one of the two good pictures, be it at their edges, that measure the place
// best: whose GSD over their parallax, which counts up to 11.5 degrees as in densification, is the
// least. nullopt where no two see it `min_parallax_deg` apart.
std::optional<double> PairGsd(const std::vector<Sight>& sights, double min_parallax_deg);
// Of all but the masked ones; infinite for none.
double NearestGsd(const std::vector<Sight>& sights);
// As if the place were level, of all but the masked ones: how far away it lies, whatever its own
// slope is. `up`: unit. Infinite for none.
double LevelGsd(const std::vector<Sight>& sights, const Eigen::Vector3d& up);
// Median of the good ones'; kUnknownTexture for fewer than two.
uint8_t MedianTexture(const std::vector<Sight>& sights);
// Whether two pictures, be they blurred, see the place from two sides.
bool IsSeenFromTwoSides(const std::vector<Sight>& sights, double min_parallax_deg);

// Whether no two good pictures see the place from two sides, but bad ones make up for it: what is
// measured in blurred pictures is not to be trusted.
bool NeedsBadPictures(const SightContext& context, const std::vector<Sight>& sights);

// The best cause: the first thing that would have had to be otherwise. kViewsDisagree where two
// good pictures see it from two sides, whatever they show (survey_limits.h). kNone when no picture
// holds the place, not even a hidden, masked or lost one.
GapCause CauseOf(const SightContext& context, const std::vector<Sight>& sights,
                 const Eigen::Vector3d& place);

}  // namespace colmap_seapoint
