#include "examples/benchmarks/completeness/gap_truth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/compare/point_index.h"
#include "examples/survey/paths/survey_camera.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

// As demo_survey scores it, and never finer than the points lie.
constexpr double kCoveredGsd = 2, kCoveredSpacings = 1.5;
const double kMinParallax = std::cos(2 * 3.14159265358979323846 / 180);

enum class Kind { kGood, kBlurred, kLost, kRemoved, kHidden };

// What no two good pictures see from two sides, and none from nearer than so many times the
// survey's own GSD, is background.
constexpr double kFarForOne = 2;
// Where of what two see less than half as much is covered as at the survey's own GSD and nearer.
constexpr double kFar = 1.1 * 1.1 * 1.1 * 1.1, kWindow = 1.1 * 1.1 * 1.1, kMostlyNothing = 0.5;
constexpr double kMinAreaShare = 0.005;
constexpr int kScaleStep = 7;  // every so many cells both ways tell the survey's own GSD

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
      seen.push_back({is_visible ? KindOf(image.name) : Kind::kHidden, toward, gsd});
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
    if (Has(seen, Kind::kGood) || Has(seen, Kind::kBlurred)) return GapCause::kImagedOnce;
    if (Has(seen, Kind::kLost)) return GapCause::kPoseLost;
    return is_hidden ? GapCause::kOccluded : GapCause::kNeverImaged;
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

double AreaOf(const SurveyTruth& truth, const GapTruth& result, const Eigen::Vector2d& place) {
  return result.side * result.side /
         std::max(0.1, truth.surface.Ground().Normal(place.x(), place.y()).z());
}

// Median over the points that the survey's pictures can give: near places give more of them.
double SurveyGsd(const SurveyTruth& truth, const CellTruth& cells, const GapTruth& result) {
  std::map<double, double> weights;
  double total = 0;
  for (int j = 0; j < result.ny; j += kScaleStep) {
    for (int i = 0; i < result.nx; i += kScaleStep) {
      const Eigen::Vector2d place = result.Place(i, j);
      const double gsd = BestPairGsd(cells.SeenAt(truth.surface.GroundAt(place.x(), place.y())));
      if (gsd == kBeyond) continue;
      const double weight = AreaOf(truth, result, place) / (gsd * gsd);
      weights[gsd] += weight;
      total += weight;
    }
  }
  double below = 0;
  for (const auto& [gsd, weight] : weights) {
    below += weight;
    if (2 * below >= total) return gsd;
  }
  return kBeyond;
}

// What decides whether a cell is background.
struct Distance {
  double gsd = 0;  // of the nearest picture
  bool has_pair = false;
};

double LimitOfSight(double survey_gsd, const GapTruth& result,
                    const std::vector<Distance>& distances) {
  const auto covered_between = [&](double from, double to) {
    std::pair<double, double> areas;  // all, covered
    for (size_t k = 0; k < distances.size(); ++k) {
      const TruthCell& cell = result.cells[k];
      if (!cell.is_expected || !distances[k].has_pair) continue;
      if (distances[k].gsd <= from || distances[k].gsd > to) continue;
      areas.first += cell.area;
      areas.second += cell.is_covered ? cell.area : 0;
    }
    return areas;
  };
  const auto all = covered_between(0, kBeyond), near = covered_between(0, survey_gsd);
  for (double from = kFar * survey_gsd; from < 400 * survey_gsd; from *= 1.1) {
    const auto [seen, covered] = covered_between(from, kWindow * from);
    if (seen < kMinAreaShare * all.first) continue;
    if (covered / seen < kMostlyNothing * near.second / near.first) return from;
  }
  return kBeyond;
}

void LeaveOutBackground(double survey_gsd, const std::vector<Distance>& distances,
                        GapTruth* result) {
  const double limit = LimitOfSight(survey_gsd, *result, distances);
  const double limit_for_one = std::min(limit, kFarForOne * survey_gsd);
  for (size_t k = 0; k < distances.size(); ++k) {
    if (distances[k].gsd <= (distances[k].has_pair ? limit : limit_for_one)) continue;
    result->cells[k].is_expected = result->cells[k].is_covered = false;
  }
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

GapTruth MeasureGapTruth(const SurveyTruth& truth, const PlantedGaps& gaps, double spacing,
                         double step, const std::vector<Eigen::Vector3f>& points, int num_threads) {
  const GridSpec& grid = truth.surface.Ground().Grid();
  GapTruth result;
  result.side = 2 * spacing;
  result.min_x = grid.MinX();
  result.min_y = grid.MinY();
  result.nx = static_cast<int>((grid.MaxX() - grid.MinX()) / result.side);
  result.ny = static_cast<int>((grid.MaxY() - grid.MinY()) / result.side);
  result.cells.resize(static_cast<size_t>(result.nx) * static_cast<size_t>(result.ny));
  PointVector places;
  for (const Eigen::Vector3f& p : points) places.push_back(p.cast<double>());
  const PointIndex index(places);
  const CellTruth cell_truth(truth, gaps);
  const double survey_gsd = SurveyGsd(truth, cell_truth, result);
  std::vector<Distance> distances(result.cells.size());
  ParallelFor(num_threads, result.ny, [&](int64_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < result.nx; ++i) {
      const Eigen::Vector2d place = result.Place(i, j);
      const SurfaceHit hit = truth.surface.GroundAt(place.x(), place.y());
      TruthCell& cell = result.At(i, j);
      const std::vector<Seen> seen = cell_truth.SeenAt(hit);
      cell.is_expected = !seen.empty();
      if (!cell.is_expected) continue;
      cell.area = AreaOf(truth, result, place);
      double squared = kBeyond;
      index.Nearest(hit.xyz, NearestOf::kAnyPoint, &squared);
      const double pair_gsd = BestPairGsd(seen);
      const bool has_pair = pair_gsd < kBeyond;
      distances[static_cast<size_t>(j * result.nx + i)] = {NearestGsd(seen), has_pair};
      const double gsd = std::max(survey_gsd, has_pair ? pair_gsd : 0);
      const double radius =
          std::max(kCoveredGsd * gsd, kCoveredSpacings * std::max(spacing, gsd * step));
      cell.is_covered = squared <= radius * radius;
      if (!cell.is_covered) cell.cause = cell_truth.CauseAt(seen, place);
    }
  });
  LeaveOutBackground(survey_gsd, distances, &result);
  MarkGaps(100 * spacing * spacing, &result);
  return result;
}

}  // namespace colmap_seapoint
