#include "densify/completeness/picture_records.h"

#include <algorithm>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr int kSide = TiledGrid<GroundCell>::kSide;
constexpr int kMinDrawn = 3;  // of four depth cells
static_assert(kPictureCell == 2 * kDepthCell);

// Depth cells beyond the picture's edge are missing from both counts.
bool IsDrawn(const DepthCells& depths, int a, int b) {
  int num_drawn = 0, num_cells = 0;
  for (int k = 0; k < 4; ++k) {
    const int x = 2 * a + k % 2, y = 2 * b + k / 2;
    if (!depths.codes.Contains(x, y)) continue;
    ++num_cells;
    num_drawn += depths.Holds(x, y) ? 1 : 0;
  }
  return 4 * num_drawn >= kMinDrawn * num_cells;
}

PictureRecord StartRecord(const SurveyView& view, const DepthCells& depths,
                          const PictureFacts& facts) {
  PictureRecord record;
  record.is_bad = facts.is_bad;
  record.sharpness = facts.sharpness;
  record.width = (view.camera->width + kPictureCell - 1) / kPictureCell;
  record.height = (view.camera->height + kPictureCell - 1) / kPictureCell;
  for (int b = 0; b < record.height; ++b) {
    for (int a = 0; a < record.width; ++a) {
      const bool is_covered = IsDrawn(depths, a, b);
      record.states.push_back(is_covered ? CellState::kCovered : CellState::kUnknown);
      GapCause cause = GapCause::kNone;
      const size_t i = record.causes.size();
      if (!is_covered && !facts.Empty() && i < facts.flags.size()) {
        if (facts.flags[i] & kMaskedCell) cause = GapCause::kOutOfArea;
        if (facts.is_bad || (facts.flags[i] & kBadlyExposedCell)) cause = GapCause::kBadPicture;
      }
      record.causes.push_back(cause);
    }
  }
  return record;
}

struct JudgedTile {
  const GroundLayer* layer;
  TileKey key;
  Eigen::Vector3d middle;
  double radius;
};

std::vector<JudgedTile> JudgedTiles(const Ground& ground) {
  std::vector<JudgedTile> tiles;
  for (const auto& [layer_key, layer] : ground.layers) {
    for (const TileKey& key : layer.cells.Keys()) {
      const TiledGrid<GroundCell>::Tile& tile = layer.cells.ExistingTile(key);
      float low = 0, high = 0;
      bool has_any = false;
      for (const GroundCell& cell : tile) {
        if (!cell.is_expected || cell.is_covered) continue;
        low = has_any ? std::min(low, cell.height) : cell.height;
        high = has_any ? std::max(high, cell.height) : cell.height;
        has_any = true;
      }
      if (!has_any) continue;
      tiles.push_back({&layer, key,
                       ground.PlaceOf(layer, key.x * kSide + kSide / 2, key.y * kSide + kSide / 2,
                                      0.5 * (low + high)),
                       0.75 * kSide * ground.cell_side + 0.5 * (high - low)});
    }
  }
  return tiles;
}

void FillFromTile(const Ground& ground, const JudgedTile& judged, const SurveyView& view,
                  PictureRecord* record) {
  const TiledGrid<GroundCell>::Tile& tile = judged.layer->cells.ExistingTile(judged.key);
  for (int i = 0; i < kSide * kSide; ++i) {
    const GroundCell& cell = tile[static_cast<size_t>(i)];
    if (!cell.is_expected || cell.is_covered) continue;
    const int x = judged.key.x * kSide + i % kSide, y = judged.key.y * kSide + i / kSide;
    const auto pixel = view.Project(ground.PlaceOf(*judged.layer, x, y, cell.height));
    if (!pixel) continue;
    const int a = std::min(static_cast<int>(pixel->x()) / kPictureCell, record->width - 1);
    const int b = std::min(static_cast<int>(pixel->y()) / kPictureCell, record->height - 1);
    const auto at = static_cast<size_t>(b * record->width + a);
    if (record->states[at] == CellState::kCovered) continue;
    record->states[at] = CellState::kNotCovered;
    record->causes[at] = cell.cause;
  }
}

}  // namespace

double PictureRecord::Share(CellState state) const {
  if (states.empty()) return 0;
  return static_cast<double>(std::count(states.begin(), states.end(), state)) /
         static_cast<double>(states.size());
}

std::vector<PictureRecord> StartRecords(const SightContext& context, int num_threads) {
  std::vector<PictureRecord> records(context.views->size());
  ParallelFor(num_threads, static_cast<int64_t>(records.size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    records[i] = StartRecord((*context.views)[i], (*context.depths)[i], (*context.facts)[i]);
  });
  return records;
}

void FillRecords(const SightContext& context, const Ground& ground, int num_threads,
                 std::vector<PictureRecord>* records) {
  const std::vector<JudgedTile> tiles = JudgedTiles(ground);
  ParallelFor(num_threads, static_cast<int64_t>(records->size()), [&](int64_t index) {
    const auto i = static_cast<size_t>(index);
    const SurveyView& view = (*context.views)[i];
    for (const JudgedTile& tile : tiles) {
      if (view.MaySee(tile.middle, tile.radius)) FillFromTile(ground, tile, view, &(*records)[i]);
    }
  });
}

}  // namespace colmap_seapoint
