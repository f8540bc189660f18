// What the feature benchmark measures on a pair of pictures of a demo survey, whose cameras and
// surface are known exactly.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "densify/match/cell_grid.h"
#include "densify/overlap/influence_mask.h"
#include "examples/survey/survey.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {

// How far from its true place a point may lie, pixels.
inline constexpr double kMaxPointError = 2;

class SurveyOracle {
 public:
  // Keeps a reference: the truth must outlive the oracle.
  explicit SurveyOracle(const SurveyTruth& truth);

  // Throws Error when the survey has no picture of that name.
  size_t ImageIdx(const std::string& name) const;
  const Camera& CameraOf(size_t image_idx) const;

  // Where a pixel of picture `from` lies in picture `to`, hidden there or not; nullopt when its ray
  // misses the surface, or the place is behind the other camera.
  std::optional<Eigen::Vector2d> Transfer(size_t from, const Eigen::Vector2d& pixel,
                                          size_t to) const;
  // The same, but nullopt also for what lies outside picture `to` or is hidden in it.
  std::optional<Eigen::Vector2d> TransferVisible(size_t from, const Eigen::Vector2d& pixel,
                                                 size_t to) const;

 private:
  std::optional<SurfaceHit> SurfacePoint(size_t image_idx, const Eigen::Vector2d& pixel) const;

  const SurveyTruth* truth_;
  SurfaceVisibility visibility_;
};

// Share of the matches whose point in picture 2 lies within kMaxPointError of the true place of the
// point in picture 1; NaN without matches. A match of a hidden place counts by its error alone.
double MatchPrecision(const SurveyOracle& oracle, size_t image1, size_t image2,
                      const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                      const FeatureMatches& matches);

// Share of the points of picture 1 that are visible in picture 2 and have one of its points within
// kMaxPointError of their true place; NaN when none is visible.
double Repeatability(const SurveyOracle& oracle, size_t image1, size_t image2,
                     const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2);

// 1 in the cells of picture `image2` whose centre shows a place that is visible in `image1` too.
std::vector<uint8_t> TrulyShared(const SurveyOracle& oracle, size_t image2, size_t image1,
                                 const CellGrid& grid);

struct OverlapScore {
  double true_overlap = 0;  // share of picture 2 that is truly shared
  double error = 0;         // the mask's overlap rate minus that
  double textured = 0;      // share of the shared cells that are textured; NaN: none is shared
  double recall = 0;     // share of the shared, textured cells that are marked; NaN: no such cell
  double precision = 0;  // share of the marked cells that are shared; NaN: none is marked
};

// `shared`, `textured`: by cell of the mask's grid.
OverlapScore ScoreOverlap(const InfluenceMask& mask, const std::vector<uint8_t>& shared,
                          const std::vector<uint8_t>& textured);

}  // namespace colmap_seapoint
