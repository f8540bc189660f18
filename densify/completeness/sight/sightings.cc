#include "densify/completeness/sight/sightings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr double kDegPerRad = 180 / 3.14159265358979323846;
const double kMinCosine = std::cos(80 / kDegPerRad);
// Of the depth, and in cells of the ground: a predicted surface may be off by that without being
// hidden.
constexpr double kHiddenShare = 0.01, kHiddenCells = 3;

constexpr double kMaxParallax = 0.2;  // radians
// Pixels from a place to the edge of a picture that a window of correlation asks for.
constexpr double kWindow = 12;

bool IsAtEdge(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() < kWindow || pixel.y() < kWindow || pixel.x() > camera.width - kWindow ||
         pixel.y() > camera.height - kWindow;
}

SightKind KindOf(const SightContext& context, int image_idx, const Eigen::Vector2d& pixel,
                 double depth, double slack, uint8_t* texture) {
  const auto i = static_cast<size_t>(image_idx);
  const PictureFacts& facts = (*context.facts)[i];
  const size_t cell = facts.Empty() ? 0 : facts.CellAt(pixel.x(), pixel.y());
  const uint8_t flags = facts.Empty() ? 0 : facts.flags[cell];
  *texture = facts.Empty() ? kUnknownTexture : facts.texture[cell];
  if (flags & kMaskedCell) return SightKind::kMasked;
  if (ShowsAnother((*context.depths)[i], pixel, depth, slack)) return SightKind::kHidden;
  return facts.is_bad || (flags & kBadlyExposedCell) ? SightKind::kBad : SightKind::kGood;
}

using IsUsable = std::function<bool(SightKind)>;

// Whether two of the usable ones see the place from two sides.
bool HasPair(const std::vector<Sight>& sights, double min_parallax_deg, const IsUsable& is_usable) {
  const double max_cosine = std::cos(min_parallax_deg / kDegPerRad);
  for (size_t k = 1; k < sights.size(); ++k) {
    if (!is_usable(sights[k].kind)) continue;
    for (size_t m = 0; m < k; ++m) {
      if (is_usable(sights[m].kind) && sights[m].toward.dot(sights[k].toward) <= max_cosine) {
        return true;
      }
    }
  }
  return false;
}

bool IsSharp(SightKind kind) { return kind == SightKind::kGood || kind == SightKind::kEdge; }
bool IsGood(SightKind kind) { return kind == SightKind::kGood; }
bool IsSeen(SightKind kind) { return kind == SightKind::kGood || kind == SightKind::kBad; }

int Count(const std::vector<Sight>& sights, SightKind kind) {
  return static_cast<int>(
      std::count_if(sights.begin(), sights.end(), [&](const Sight& s) { return s.kind == kind; }));
}

}  // namespace

std::vector<Sight> SightsOf(const SightContext& context, const std::vector<int>& candidates,
                            const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
  std::vector<Sight> sights;
  const double normal_length = normal.norm();
  for (const int image_idx : candidates) {
    const SurveyView& view = (*context.views)[static_cast<size_t>(image_idx)];
    const Eigen::Vector3d to_camera = view.center - place;
    const double distance = to_camera.norm();
    const auto pixel = view.Project(place);
    if (!pixel) continue;
    Sight sight;
    const double depth = view.rotation.row(2).dot(place) + view.translation.z();
    const double facing = normal.dot(to_camera) / (distance * normal_length);
    const double cosine = std::max(kMinCosine, facing);
    const double across = view.GsdAt(place);
    // A cell of depths holds a piece of a tilted surface from its nearest to its farthest end.
    const double within_cell = kDepthCell * across * std::sqrt(1 - cosine * cosine) / cosine;
    const double slack = kHiddenShare * depth + kHiddenCells * context.cell_side + within_cell;
    sight.kind = KindOf(context, image_idx, *pixel, depth, slack, &sight.texture);
    if (sight.kind != SightKind::kMasked) {
      if (facing < kMinCosine) sight.kind = SightKind::kHidden;
      if (sight.kind != SightKind::kHidden && IsAtEdge(*view.camera, *pixel)) {
        sight.kind = SightKind::kEdge;
      }
    }
    sight.across = across;
    sight.gsd = across / std::sqrt(cosine);
    sight.toward = to_camera / distance;
    sights.push_back(sight);
  }
  return sights;
}

double ParallaxDeg(const std::vector<Sight>& sights) {
  double min_cosine = 1;
  for (size_t k = 1; k < sights.size(); ++k) {
    for (size_t m = 0; m < k; ++m) {
      if (sights[k].kind != SightKind::kGood || sights[m].kind != SightKind::kGood) continue;
      min_cosine = std::min(min_cosine, sights[m].toward.dot(sights[k].toward));
    }
  }
  return std::acos(std::clamp(min_cosine, -1.0, 1.0)) * kDegPerRad;
}

int NumGood(const std::vector<Sight>& sights) { return Count(sights, SightKind::kGood); }

std::optional<double> PairGsd(const std::vector<Sight>& sights, double min_parallax_deg) {
  const double max_cosine = std::cos(min_parallax_deg / kDegPerRad);
  double least = std::numeric_limits<double>::infinity(), gsd = 0;
  for (size_t k = 1; k < sights.size(); ++k) {
    for (size_t m = 0; m < k; ++m) {
      if (!IsSharp(sights[k].kind) || !IsSharp(sights[m].kind)) continue;
      const double cosine = sights[m].toward.dot(sights[k].toward);
      if (cosine > max_cosine) continue;
      const double coarser = std::max(sights[k].gsd, sights[m].gsd);
      // The chord between the two directions: the angle in radians, nearly.
      const double parallax = std::min(kMaxParallax, std::sqrt(2 - 2 * cosine));
      if (coarser >= least * parallax) continue;
      least = coarser / parallax;
      gsd = coarser;
    }
  }
  if (gsd == 0) return std::nullopt;
  return gsd;
}

double NearestGsd(const std::vector<Sight>& sights) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sight& s : sights) {
    if (s.kind != SightKind::kMasked) nearest = std::min(nearest, s.gsd);
  }
  return nearest;
}

bool IsSeenFromTwoSides(const std::vector<Sight>& sights, double min_parallax_deg) {
  return HasPair(sights, min_parallax_deg, IsSeen);
}

double LevelGsd(const std::vector<Sight>& sights, const Eigen::Vector3d& up) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sight& s : sights) {
    if (s.kind == SightKind::kMasked) continue;
    const double cosine = std::max(kMinCosine, up.dot(s.toward));
    nearest = std::min(nearest, s.across / std::sqrt(cosine));
  }
  return nearest;
}

uint8_t MedianTexture(const std::vector<Sight>& sights) {
  std::vector<double> texture;
  for (const Sight& s : sights) {
    if (s.kind == SightKind::kGood) texture.push_back(s.texture);
  }
  if (texture.size() < 2) return kUnknownTexture;
  return static_cast<uint8_t>(UpperMedian(std::move(texture)));
}

bool NeedsBadPictures(const SightContext& context, const std::vector<Sight>& sights) {
  return !HasPair(sights, context.min_parallax_deg, IsGood) &&
         HasPair(sights, context.min_parallax_deg, IsSeen);
}

GapCause CauseOf(const SightContext& context, const std::vector<Sight>& sights,
                 const Eigen::Vector3d& place) {
  const double angle = context.min_parallax_deg;
  const bool has_hidden = Count(sights, SightKind::kHidden) > 0;
  const bool has_masked = Count(sights, SightKind::kMasked) > 0;
  const int num_good = NumGood(sights);
  if (HasPair(sights, angle, IsGood)) return GapCause::kViewsDisagree;
  if (HasPair(sights, angle, IsSeen)) return GapCause::kBadPicture;
  if (context.lost->RunThatSaw(place) >= 0) return GapCause::kPoseLost;
  if (has_hidden && HasPair(sights, angle, [](SightKind k) {
        return k == SightKind::kGood || k == SightKind::kBad || k == SightKind::kHidden;
      })) {
    return GapCause::kOccluded;
  }
  if (has_masked && num_good < 2) return GapCause::kOutOfArea;
  if (num_good >= 2) return GapCause::kSmallParallax;
  if (num_good + Count(sights, SightKind::kBad) + Count(sights, SightKind::kEdge) >= 1) {
    return GapCause::kImagedOnce;
  }
  return has_hidden ? GapCause::kOccluded : GapCause::kNone;
}

}  // namespace colmap_seapoint
