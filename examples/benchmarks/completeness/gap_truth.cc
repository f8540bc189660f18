#include "examples/benchmarks/completeness/gap_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/compare/point_index.h"
#include "densify/match/cell_grid.h"
#include "examples/survey/paths/survey_camera.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

// As demo_survey scores it, and never finer than the points lie.
constexpr double kCoveredGsd = 2, kCoveredSpacings = 1.5;
const double kMinParallax = std::cos(2 * 3.14159265358979323846 / 180);

enum class Kind { kGood, kBlurred, kLost, kRemoved, kHidden, kEdge };
// Pixels from the edge of a picture within which no window of correlation fits: seen, not measured.
constexpr double kEdgeWidth = 12;

// What no picture sees from nearer than so many times the survey's own GSD is background.
constexpr double kFar = 2;
constexpr int kScaleCells = 7;  // places of so many cells both ways tell the survey's own GSD

struct Seen {
  Kind kind;
  Eigen::Vector3d toward;
  double gsd;  // metres a pixel on the surface
};

// Of the coarser of the two good pictures whose GSD over their angle, up to 11.5 degrees, is least.
double BestPairGsd(const std::vector<Seen>& seen) {
  double least = kBeyond, gsd = kBeyond;
  for (const Seen& a : seen) {
    for (const Seen& b : seen) {
      if (a.kind != Kind::kGood || b.kind != Kind::kGood) continue;
      const double cosine = a.toward.dot(b.toward);
      if (cosine > kMinParallax) continue;
      const double coarser = std::max(a.gsd, b.gsd);
      const double error = coarser / std::min(0.2, std::acos(std::clamp(cosine, -1.0, 1.0)));
      if (error < least) gsd = coarser;
      least = std::min(least, error);
    }
  }
  return gsd;
}

bool HasPair(const std::vector<Seen>& seen, const std::set<Kind>& kinds) {
  for (size_t k = 1; k < seen.size(); ++k) {
    for (size_t m = 0; m < k; ++m) {
      if (kinds.count(seen[k].kind) && kinds.count(seen[m].kind) &&
          seen[k].toward.dot(seen[m].toward) <= kMinParallax) {
        return true;
      }
    }
  }
  return false;
}

double NearestGsd(const std::vector<Seen>& seen) {
  double nearest = kBeyond;
  for (const Seen& s : seen) nearest = std::min(nearest, s.gsd);
  return nearest;
}

bool IsAtEdge(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() < kEdgeWidth || pixel.y() < kEdgeWidth ||
         pixel.x() > camera.width - kEdgeWidth || pixel.y() > camera.height - kEdgeWidth;
}

class CellTruth {
 public:
  CellTruth(const SurveyTruth& truth, const PlantedGaps& gaps)
      : truth_(truth), gaps_(gaps), visibility_(truth) {
    for (const auto& [id, camera] : truth.model.cameras)
      cameras_.try_emplace(id, truth.port, camera);
  }

  std::vector<Seen> SeenAt(const SurfaceHit& hit) const {
    std::vector<Seen> seen;
    for (size_t i = 0; i < truth_.model.images.size(); ++i) {
      const PosedImage& image = truth_.model.images[i];
      const Eigen::Vector3d center = image.cam_from_world.OriginInSource();
      const auto pixel = cameras_.at(image.camera_id).ImgFromCam(image.cam_from_world * hit.xyz);
      const PortCamera& camera = cameras_.at(image.camera_id);
      if (!pixel || !camera.InWater().InImage(*pixel)) continue;
      if ((center - hit.xyz).norm() > truth_.max_range) continue;
      const bool is_visible = visibility_.Project(i, hit.xyz, hit.normal).has_value();
      const Eigen::Vector3d toward = (center - hit.xyz).normalized();
      const double gsd = GsdAt(camera.InWater(), image.cam_from_world * hit.xyz) /
                         std::sqrt(std::max(0.17, hit.normal.dot(toward)));
      Kind kind = is_visible ? KindOf(image.name) : Kind::kHidden;
      if (kind == Kind::kGood && IsAtEdge(camera.InWater(), *pixel)) kind = Kind::kEdge;
      seen.push_back({kind, toward, gsd});
    }
    return seen;
  }

  GapCause CauseAt(const std::vector<Seen>& seen, const Eigen::Vector2d& place) const {
    if (HasPair(seen, {Kind::kGood})) {
      for (const Disc& d : gaps_.smooth) {
        if (d.Contains(place)) return GapCause::kNoTexture;
      }
      return GapCause::kViewsDisagree;
    }
    if (HasPair(seen, {Kind::kGood, Kind::kBlurred})) return GapCause::kBadPicture;
    if (HasPair(seen, {Kind::kGood, Kind::kBlurred, Kind::kLost})) return GapCause::kPoseLost;
    const bool is_hidden = Has(seen, Kind::kHidden);
    if (is_hidden && HasPair(seen, {Kind::kGood, Kind::kBlurred, Kind::kHidden})) {
      return GapCause::kOccluded;
    }
    if (Has(seen, Kind::kGood) || Has(seen, Kind::kBlurred) || Has(seen, Kind::kEdge)) {
      return GapCause::kImagedOnce;
    }
    if (Has(seen, Kind::kLost)) return GapCause::kPoseLost;
    return is_hidden ? GapCause::kOccluded : GapCause::kNeverImaged;
  }
  bool IsPlantedAt(const Eigen::Vector2d& place) const {
    const auto contains = [&](const Disc& disc) { return disc.Contains(place); };
    return std::any_of(gaps_.smooth.begin(), gaps_.smooth.end(), contains) ||
           std::any_of(gaps_.moving.begin(), gaps_.moving.end(), contains);
  }
  static bool Has(const std::vector<Seen>& seen, Kind kind) {
    for (const Seen& s : seen) {
      if (s.kind == kind) return true;
    }
    return false;
  }

 private:
  Kind KindOf(const std::string& name) const {
    if (gaps_.removed.count(name)) return Kind::kRemoved;
    if (gaps_.lost.count(name)) return Kind::kLost;
    return gaps_.blurred.count(name) ? Kind::kBlurred : Kind::kGood;
  }

  const SurveyTruth& truth_;
  const PlantedGaps& gaps_;
  SurfaceVisibility visibility_;
  std::map<uint32_t, PortCamera> cameras_;
};

// Along the surface, of a square of that side on the plan.
double AreaOf(const SurveyTruth& truth, double side, const Eigen::Vector2d& place) {
  return side * side / std::max(0.1, truth.surface.Ground().Normal(place.x(), place.y()).z());
}

// Median over the points that the survey's pictures can give: near places give more of them.
double SurveyGsd(const SurveyTruth& truth, const CellTruth& cells) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  const double side = kScaleCells * 2 * truth.gsd;
  std::map<double, double> weights;
  double total = 0;
  for (double y = grid.MinY() + 0.5 * side; y < grid.MaxY(); y += side) {
    for (double x = grid.MinX() + 0.5 * side; x < grid.MaxX(); x += side) {
      const double gsd = BestPairGsd(cells.SeenAt(truth.surface.GroundAt(x, y)));
      if (gsd == kBeyond) continue;
      const double weight = AreaOf(truth, side, {x, y}) / (gsd * gsd);
      weights[gsd] += weight;
      total += weight;
    }
  }
  double below = 0;
  for (const auto& [gsd, weight] : weights) {
    below += weight;
    if (2 * below >= total) return gsd;
  }
  return truth.gsd;
}

void MarkGaps(double min_area, GapTruth* result) {
  std::vector<int> stack, part;
  std::vector<bool> is_done(result->cells.size(), false);
  for (size_t start = 0; start < result->cells.size(); ++start) {
    const TruthCell& first = result->cells[start];
    if (is_done[start] || !first.is_expected || first.is_covered) continue;
    part.assign(1, static_cast<int>(start));
    is_done[start] = true;
    double area = 0;
    for (size_t k = 0; k < part.size(); ++k) {
      const int at = part[k], i = at % result->nx, j = at / result->nx;
      area += result->cells[static_cast<size_t>(at)].area;
      for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (i + di < 0 || i + di >= result->nx || j + dj < 0 || j + dj >= result->ny) continue;
        const auto next = static_cast<size_t>(at + di + dj * result->nx);
        const TruthCell& cell = result->cells[next];
        if (is_done[next] || !cell.is_expected || cell.is_covered || cell.cause != first.cause) {
          continue;
        }
        is_done[next] = true;
        part.push_back(static_cast<int>(next));
      }
    }
    if (area < min_area) continue;
    for (const int at : part) result->cells[static_cast<size_t>(at)].is_gap = true;
  }
}

}  // namespace

GapTruth MeasureGapTruth(const SurveyTruth& truth, const PlantedGaps& gaps,
                         const std::vector<Eigen::Vector3f>& points, int num_threads) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  const CellTruth cell_truth(truth, gaps);
  const int step = SampleStep(truth.model.cameras.begin()->second, 0);
  GapTruth result;
  result.survey_gsd = SurveyGsd(truth, cell_truth);
  result.spacing = result.survey_gsd * step;
  result.side = 2 * result.spacing;
  result.min_x = grid.MinX();
  result.min_y = grid.MinY();
  result.nx = static_cast<int>((grid.MaxX() - grid.MinX()) / result.side);
  result.ny = static_cast<int>((grid.MaxY() - grid.MinY()) / result.side);
  result.cells.resize(static_cast<size_t>(result.nx) * static_cast<size_t>(result.ny));
  PointVector places;
  for (const Eigen::Vector3f& p : points) places.push_back(p.cast<double>());
  const PointIndex index(places);
  ParallelFor(num_threads, result.ny, [&](int64_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < result.nx; ++i) {
      const Eigen::Vector2d place = result.Place(i, j);
      const SurfaceHit hit = truth.surface.GroundAt(place.x(), place.y());
      TruthCell& cell = result.At(i, j);
      const std::vector<Seen> seen = cell_truth.SeenAt(hit);
      if (seen.empty()) continue;
      cell.area = AreaOf(truth, result.side, place);
      double squared = kBeyond;
      index.Nearest(hit.xyz, NearestOf::kAnyPoint, &squared);
      const double pair_gsd = BestPairGsd(seen);
      const double gsd = std::max(result.survey_gsd, pair_gsd < kBeyond ? pair_gsd : 0);
      const double radius = std::max(kCoveredGsd, kCoveredSpacings * step) * gsd;
      cell.is_covered = squared <= radius * radius;
      cell.is_expected = cell.is_covered || NearestGsd(seen) <= kFar * result.survey_gsd;
      if (cell.is_covered) continue;
      cell.cause = cell_truth.CauseAt(seen, place);
      cell.is_planted = cell_truth.IsPlantedAt(place);
    }
  });
  MarkGaps(100 * result.spacing * result.spacing, &result);
  return result;
}

}  // namespace colmap_seapoint
