#include "densify/completeness/judge_ground.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"
#include "densify/completeness/surface/smooth_surface.h"

namespace colmap_seapoint {
namespace {

constexpr int kSide = TiledGrid<GroundCell>::kSide;
// Without a limit of sight, pictures that look towards the horizon are cut off at that many
// heights.
constexpr double kMaxHeights = 8;
// Tiles from below a picture that it may show something of, in any direction: so many, or as many
// as the heights above are; never more. What a model that has gone wrong claims to see is endless.
constexpr double kNearTiles = 48, kMostTiles = 128;
// A hole on a wall: covered within so many cells in three of four directions, at about its depth.
constexpr int kHoleReach = 24, kHoleDepth = 12;
constexpr double kDenseTile = 0.25;
constexpr double kFewPoints = 5;
constexpr int kMaxReach = 4;  // cells

struct Box {
  Eigen::Vector2d low, high;
  void Clip(const Eigen::Vector2d& center, double half_side) {
    low = low.cwiseMax((center.array() - half_side).matrix());
    high = high.cwiseMin((center.array() + half_side).matrix());
  }
  void Take(const Eigen::Vector2d& place) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
};

// What a view may show of a level ground at the height of what is below it, in the layer's plan.
// `tile`: its side, units.
Box FootprintBox(const SurveyView& view, const GroundLayer& layer, double tile) {
  const Eigen::Vector3d center = layer.layer_from_world * view.center;
  const double above = center.z() - layer.surface.At(center.x(), center.y()).height;
  const double reach =
      std::isfinite(view.max_range) ? view.max_range : kMaxHeights * std::abs(above);
  Box box{center.head<2>(), center.head<2>()};
  constexpr int kRays = 6;
  for (int b = 0; b <= kRays; ++b) {
    for (int a = 0; a <= kRays; ++a) {
      const auto on_plane = view.camera->CamFromImg(
          {a * view.camera->width / double{kRays}, b * view.camera->height / double{kRays}});
      const Eigen::Vector3d in_cam =
          on_plane ? Eigen::Vector3d(on_plane->x(), on_plane->y(), 1) : Eigen::Vector3d(0, 0, 1);
      const Eigen::Vector3d ray =
          layer.layer_from_world * (view.rotation.transpose() * in_cam.normalized());
      const double to_ground = ray.z() < 0 && above > 0 ? above / -ray.z() : reach;
      box.Take((center + std::min(to_ground, reach) * ray).head<2>());
    }
  }
  // The ground is not level: half as much again to all sides.
  const Eigen::Vector2d margin = 0.5 * (box.high - box.low);
  box.low -= margin;
  box.high += margin;
  const double heights = kMaxHeights * std::abs(above);
  box.Clip(center.head<2>(), std::clamp(heights, kNearTiles * tile, kMostTiles * tile));
  return box;
}

double TileRadius(const Ground& ground) { return 0.75 * kSide * ground.cell_side; }

Eigen::Vector3d TileMiddle(const Ground& ground, const GroundLayer& layer, const TileKey& key) {
  const double side = kSide * ground.cell_side;
  const double u = (key.x + 0.5) * side, v = (key.y + 0.5) * side;
  return layer.layer_from_world.transpose() * Eigen::Vector3d(u, v, layer.surface.At(u, v).height);
}

void SpreadFootprint(const SurveyView& view, Ground* ground, GroundLayer* layer) {
  const double side = kSide * ground->cell_side;
  const Box box = FootprintBox(view, *layer, side);
  const auto tile_of = [&](double at) {
    return static_cast<int>(std::clamp(std::floor(at / side), -1e8, 1e8));
  };
  const int x1 = tile_of(box.high.x()) + 1, y1 = tile_of(box.high.y()) + 1;
  for (int y = tile_of(box.low.y()) - 1; y <= y1; ++y) {
    for (int x = tile_of(box.low.x()) - 1; x <= x1; ++x) {
      if (layer->cells.Holds({x, y})) continue;
      if (view.MaySee(TileMiddle(*ground, *layer, {x, y}), 2 * TileRadius(*ground))) {
        layer->cells.TileAt({x, y});
      }
    }
  }
}

double CoveredShare(const TiledGrid<GroundCell>::Tile& tile) {
  const auto count = std::count_if(tile.begin(), tile.end(),
                                   [](const GroundCell& cell) { return cell.is_covered; });
  return static_cast<double>(count) / static_cast<double>(tile.size());
}

// Of a layer that is not the top: whether covered cells enclose this one.
bool IsHole(const GroundLayer& layer, int x, int y, double height, double cell_side) {
  constexpr int kStep[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  int num_sides = 0;
  for (const auto& step : kStep) {
    for (int k = 1; k <= kHoleReach; ++k) {
      const GroundCell* cell = layer.cells.Find(x + k * step[0], y + k * step[1]);
      if (cell == nullptr || !cell->is_covered) continue;
      num_sides += std::abs(cell->height - height) < kHoleDepth * cell_side ? 1 : 0;
      break;
    }
  }
  return num_sides >= 3;
}

// Judges the cells of one tile.
class TileJudge {
 public:
  TileJudge(const SightContext& context, const JudgeOptions& options, const Ground& ground,
            bool is_top, GroundLayer* layer)
      : context_(context), options_(options), ground_(ground), is_top_(is_top), layer_(layer) {}

  void Judge(const TileKey& key) const {
    TiledGrid<GroundCell>::Tile& tile = layer_->cells.ExistingTile(key);
    if (!is_top_ && CoveredShare(tile) < kDenseTile) return;
    for (int i = 0; i < kSide * kSide; ++i) {
      GroundCell& cell = tile[static_cast<size_t>(i)];
      if (cell.is_covered) continue;
      PredictCell(ground_, *layer_, key.x * kSide + i % kSide, key.y * kSide + i / kSide, &cell);
    }
    const std::vector<int> candidates = CandidatesOf(key, tile);
    const bool has_bad = HasBad(candidates);
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = key.x * kSide + i % kSide, y = key.y * kSide + i / kSide;
      GroundCell& cell = tile[static_cast<size_t>(i)];
      if (!cell.is_covered) {
        JudgeCell(candidates, x, y, &cell);
      } else if (has_bad || IsSampledCell(x, y)) {
        JudgeCovered(SightsAt(candidates, x, y, cell), x, y, &cell);
      }
      RespectArea(x, y, &cell);
    }
  }

 private:
  // Views that may show a cell of the tile, all of which have their heights.
  std::vector<int> CandidatesOf(const TileKey& key, const TiledGrid<GroundCell>::Tile& tile) const {
    const auto [low, high] = std::minmax_element(
        tile.begin(), tile.end(),
        [](const GroundCell& a, const GroundCell& b) { return a.height < b.height; });
    const Eigen::Vector3d middle =
        ground_.PlaceOf(*layer_, key.x * kSide + kSide / 2, key.y * kSide + kSide / 2,
                        0.5 * (low->height + high->height));
    const double radius = std::hypot(TileRadius(ground_), 0.5 * (high->height - low->height));
    std::vector<int> candidates;
    for (size_t i = 0; i < context_.views->size(); ++i) {
      if ((*context_.views)[i].MaySee(middle, radius)) candidates.push_back(static_cast<int>(i));
    }
    return candidates;
  }
  bool HasBad(const std::vector<int>& candidates) const {
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](int i) { return (*context_.facts)[static_cast<size_t>(i)].is_bad; });
  }
  std::vector<Sight> SightsAt(const std::vector<int>& candidates, int x, int y,
                              const GroundCell& cell) const {
    const double side = ground_.cell_side;
    const PlaneAt plane = layer_->surface.At((x + 0.5) * side, (y + 0.5) * side);
    return SightsOf(context_, candidates, ground_.PlaceOf(*layer_, x, y, cell.height),
                    layer_->layer_from_world.transpose() * plane.Normal());
  }
  void Note(const std::vector<Sight>& sights, GroundCell* cell) const {
    cell->has_pair = IsSeenFromTwoSides(sights, context_.min_parallax_deg);
    cell->gsd = static_cast<float>(LevelGsd(sights, layer_->layer_from_world.row(2).transpose()));
    cell->texture = MedianTexture(sights);
    cell->num_views = static_cast<uint8_t>(std::min(255, NumGood(sights)));
    cell->parallax_deg = static_cast<uint8_t>(std::lround(ParallaxDeg(sights)));
  }
  // What other layers look at must not change while they do.
  void JudgeCovered(const std::vector<Sight>& sights, int x, int y, GroundCell* cell) const {
    if (IsSampledCell(x, y)) Note(sights, cell);
    if (!is_top_ || !NeedsBadPictures(context_, sights)) return;
    if (IsSmoothAround(*layer_, x, y, ground_.cell_side)) return;
    cell->is_covered = cell->is_thin = false;
    cell->cause = GapCause::kBadPicture;
  }
  void JudgeCell(const std::vector<int>& candidates, int x, int y, GroundCell* cell) const {
    if (!is_top_ && !IsHole(*layer_, x, y, cell->height, ground_.cell_side)) return;
    const std::vector<Sight> sights = SightsAt(candidates, x, y, *cell);
    if (sights.empty()) return;
    Note(sights, cell);
    cell->is_expected = true;
    if (is_top_ && IsCoveredFromAfar(sights, x, y, *cell)) {
      cell->is_covered = cell->is_from_afar = true;
      return;
    }
    cell->cause = CauseOf(context_, sights, ground_.PlaceOf(*layer_, x, y, cell->height));
    if (cell->cause == GapCause::kOutOfArea) cell->is_expected = false;
  }
  // Whether the surroundings hold what the two pictures that measure the place best can give.
  bool IsCoveredFromAfar(const std::vector<Sight>& sights, int x, int y,
                         const GroundCell& cell) const {
    const auto gsd = PairGsd(sights, context_.min_parallax_deg);
    const double spacing = gsd ? *gsd * options_.pixels_a_point : 0;
    // What is as near as usual has been asked for its points already.
    if (kCellSpacings * spacing <= ground_.cell_side) return false;
    const double wanted = kCoveredShare * WantedPoints(cell.area, spacing);
    // As many cells as should hold a few points.
    const int reach =
        std::clamp(static_cast<int>(std::sqrt(kFewPoints / wanted) / 2), 1, kMaxReach);
    return CountAround(*layer_, x, y, reach) >= wanted * (2 * reach + 1) * (2 * reach + 1);
  }
  void RespectArea(int x, int y, GroundCell* cell) const {
    if (options_.asked == nullptr) return;
    const Eigen::Vector3d place =
        ground_.frame.map_from_world * ground_.PlaceOf(*layer_, x, y, cell->height);
    if (options_.asked->Contains(place.head<2>())) return;
    cell->is_expected = false;
    cell->cause = GapCause::kOutOfArea;
  }

  const SightContext& context_;
  const JudgeOptions& options_;
  const Ground& ground_;
  bool is_top_;
  GroundLayer* layer_;
};

}  // namespace

void SpreadCells(const std::vector<SurveyView>& views, Ground* ground) {
  GroundLayer& top = ground->LayerAt({Side::kTop, 0});
  for (const SurveyView& view : views) SpreadFootprint(view, ground, &top);
  for (auto& [key, layer] : ground->layers) {
    if (key.side == Side::kTop) continue;
    for (const TileKey& tile : layer.cells.Keys()) {
      for (int k = 0; k < 9; ++k) layer.cells.TileAt({tile.x + k % 3 - 1, tile.y + k / 3 - 1});
    }
  }
}

void JudgeGround(const SightContext& context, const JudgeOptions& options, int num_threads,
                 Ground* ground) {
  for (auto& [key, layer] : ground->layers) {
    const TileJudge judge(context, options, *ground, key.side == Side::kTop, &layer);
    const std::vector<TileKey> keys = layer.cells.Keys();
    ParallelFor(num_threads, static_cast<int64_t>(keys.size()),
                [&](int64_t i) { judge.Judge(keys[static_cast<size_t>(i)]); });
  }
}

}  // namespace colmap_seapoint
