#include "densify/completeness/assess_completeness.h"

#include <algorithm>
#include <cmath>

#include "densify/completeness/gaps/merge_gaps.h"
#include "densify/completeness/judge_ground.h"
#include "densify/completeness/judge_survey.h"
#include "densify/completeness/survey_scale.h"
#include "densify/match/cell_grid.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNumNearest = 5;
// The areas that gaps are made of: (10 wanted spacings)^2 and more, and a square of 4 spacings fits
// into them.
constexpr double kMinGapSpacings = 10;
constexpr int kMinGapCells = 2;

double StepOf(const SparseModel& model, const CompletenessOptions& options) {
  std::vector<double> steps;
  for (const PosedImage& image : model.images) {
    steps.push_back(SampleStep(model.cameras.at(image.camera_id), options.step));
  }
  return MedianOf(std::move(steps));
}

// Area that is covered when squares of `size` cells, above 1, are asked for the points of
// `spacing`.
double CoveredArea(int size, double spacing, GroundLayer* layer) {
  struct Block {
    double area = 0, covered = 0;
    int64_t count = 0;
  };
  TiledGrid<Block> blocks;
  const auto block_of = [&](int at) { return at >= 0 ? at / size : -1 - (-1 - at) / size; };
  layer->cells.ForEach([&](int x, int y, const GroundCell& cell) {
    if (!cell.is_expected) return;
    Block& block = blocks.At(block_of(x), block_of(y));
    block.area += cell.area;
    block.count += cell.count;
    if (cell.is_covered) block.covered += cell.area;
  });
  double covered = 0;
  blocks.ForEach([&](int, int, const Block& block) {
    const bool is_enough =
        static_cast<double>(block.count) >= kCoveredShare * WantedPoints(block.area, spacing);
    covered += is_enough ? block.area : block.covered;
  });
  return covered;
}

void MeasureCoverage(double covered, CompletenessResult* result) {
  for (size_t k = 0; k < result->coverage.size(); ++k) {
    const int size = 1 << k;
    CoverageAt& at = result->coverage[k];
    at.spacing = size * result->spacing;
    at.area = k == 0 ? covered : 0;
    for (auto& [key, layer] : result->ground.layers) {
      if (k > 0) at.area += CoveredArea(size, at.spacing, &layer);
    }
    if (result->expected_area > 0) at.share = at.area / result->expected_area;
  }
}

void Measure(CompletenessResult* result) {
  double views = 0, points = 0, covered = 0, thin = 0;
  int64_t num_sampled = 0;
  std::vector<double> parallax;
  for (auto& [key, layer] : result->ground.layers) {
    layer.cells.ForEach([&](int x, int y, const GroundCell& cell) {
      if (!cell.is_expected) return;
      result->expected_area += cell.area;
      if (!cell.is_covered) {
        thin += cell.is_thin ? cell.area : 0;
        result->missing_area[static_cast<size_t>(cell.cause)] += cell.area;
        return;
      }
      covered += cell.area;
      points += cell.count;
      if (cell.num_views == 0 || !IsSampledCell(x, y)) return;
      views += cell.num_views;
      ++num_sampled;
      parallax.push_back(cell.parallax_deg);
    });
  }
  if (num_sampled > 0) result->mean_views = views / static_cast<double>(num_sampled);
  result->median_parallax_deg = MedianOf(std::move(parallax));
  if (covered > 0) result->points_per_area = points / covered;
  if (result->expected_area > 0) result->share_tolerance = thin / result->expected_area;
  MeasureCoverage(covered, result);
}

std::vector<int> NearestPictures(const std::vector<SurveyView>& views,
                                 const Eigen::Vector3d& place) {
  std::vector<int> order(views.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto distance = [&](int i) {
    return (views[static_cast<size_t>(i)].center - place).squaredNorm();
  };
  const size_t count = std::min(kNumNearest, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](int a, int b) {
                      const double da = distance(a), db = distance(b);
                      return da != db ? da < db : a < b;
                    });
  order.resize(count);
  return order;
}

std::vector<std::vector<Eigen::Vector3d>> OutlineOf(const Ground& ground, const GapRegion& region) {
  const GroundLayer& layer = ground.layers.at(region.layer);
  std::vector<std::vector<Eigen::Vector3d>> outline;
  for (const Ring& ring : region.rings) {
    std::vector<Eigen::Vector3d>& corners = outline.emplace_back();
    for (const Eigen::Vector2d& p : ring) {
      const double height = layer.surface.At(p.x(), p.y()).height;
      corners.push_back(layer.layer_from_world.transpose() * Eigen::Vector3d(p.x(), p.y(), height));
    }
  }
  return outline;
}

Eigen::Vector3d CentroidOf(const Ground& ground, const GapRegion& region) {
  const GroundLayer& layer = ground.layers.at(region.layer);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [x, y] : region.cells) {
    sum += ground.PlaceOf(layer, x, y, layer.cells.Find(x, y)->height);
  }
  return sum / static_cast<double>(region.cells.size());
}

void FindGaps(const CompletenessInput& input, const std::vector<SurveyView>& views,
              const PassPlan& plan, CompletenessResult* result) {
  const double min_area = std::pow(kMinGapSpacings * result->spacing, 2);
  PassRegions merged = MergeIntoPasses(FindGapRegions(kMinGapCells, min_area, &result->ground),
                                       plan, result->ground.cell_side);
  result->unlisted_area = merged.unlisted_area;
  std::vector<GapRegion>& regions = merged.regions;
  result->last_id = input.last_id;
  std::vector<GapPlace> places;
  for (const GapRegion& region : regions) {
    places.push_back({region.layer, &region.cells});
  }
  std::vector<FormerGap> former;
  for (const FormerOutline& outline : input.former) {
    former.push_back(InPlan(outline, result->ground.frame));
  }
  const std::vector<int> ids =
      AssignGapIds(places, result->ground.cell_side, former, input.last_id);
  for (size_t i = 0; i < regions.size(); ++i) {
    Gap gap;
    gap.id = ids[i];
    result->last_id = std::max(result->last_id, gap.id);
    gap.centroid = CentroidOf(result->ground, regions[i]);
    gap.outline = OutlineOf(result->ground, regions[i]);
    gap.pictures = NearestPictures(views, gap.centroid);
    gap.pass = PlanPass(result->ground, regions[i], plan);
    gap.region = std::move(regions[i]);
    result->gaps.push_back(std::move(gap));
  }
  std::sort(result->gaps.begin(), result->gaps.end(), [](const Gap& a, const Gap& b) {
    const double gain_a = a.AreaPerLength(), gain_b = b.AreaPerLength();
    return gain_a != gain_b ? gain_a > gain_b : a.id < b.id;
  });
}

void JoinPasses(CompletenessResult* result) {
  std::vector<ClosingPass> passes;
  for (const Gap& gap : result->gaps) passes.push_back(gap.pass);
  result->route = PlanRoute(passes);
  result->route_length = TransitLength(passes, result->route);
  for (const ClosingPass& pass : passes) result->route_length += pass.length;
}

}  // namespace

FormerGap InPlan(const FormerOutline& outline, const PlanFrame& frame) {
  const Eigen::Matrix3d layer_from_world = SideFromMap(outline.layer.side) * frame.map_from_world;
  FormerGap gap{outline.id, outline.layer, {}};
  for (const std::vector<Eigen::Vector3d>& corners : outline.rings) {
    Ring& ring = gap.rings.emplace_back();
    for (const Eigen::Vector3d& p : corners) ring.push_back((layer_from_world * p).head<2>());
  }
  return gap;
}

CompletenessResult AssessCompleteness(const CompletenessInput& input,
                                      const CompletenessOptions& options, int num_threads) {
  CompletenessResult result;
  const SparseModel& model = *input.model;
  const double max_range = VisualRange(model);
  const std::vector<SurveyView> views = MakeViews(model, max_range);
  const std::vector<SurfacePoint> sample = SampleCloud(input);
  const SurveyScale scale = MeasureScale(views, sample, options.min_parallax_deg);
  result.belonging_share = scale.seen_share;
  if (scale.seen_share < kMinBelonging) return result;

  const double step = StepOf(model, options);
  result.gsd = scale.gsd;
  result.spacing = options.spacing > 0 ? options.spacing : scale.gsd * step;
  result.is_area_too_large = input.asked.IsTooLarge(kCellSpacings * result.spacing);
  if (result.is_area_too_large) return result;
  const SurveySetting setting = {result.gsd, result.spacing, options.spacing > 0 ? 0 : step,
                                 max_range,
                                 input.frame_of ? input.frame_of(PlacesOf(sample)) : PlanFrame()};
  JudgedSurvey judged = JudgeSurvey(input, options, setting, views, num_threads);
  result.ground = std::move(judged.ground);
  result.records = std::move(judged.records);
  result.lost_runs = std::move(judged.lost_runs);

  Measure(&result);
  FindGaps(input, views, judged.plan, &result);
  JoinPasses(&result);
  return result;
}

}  // namespace colmap_seapoint
