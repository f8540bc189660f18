#include "colmap_seapoint/orthomosaic/relief/relief_tile.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "colmap_seapoint/orthomosaic/ground/map_tile.h"

namespace colmap_seapoint {
namespace {

// All lengths below are in cells.
constexpr float kLayerGap = 3;        // between the heights of two layers
constexpr float kTopDepth = 1.5f;     // below the highest point of a layer: what is its surface
constexpr float kMaxSlope = 2.5f;     // between neighbours of one surface
constexpr int kMinSupport = 2;        // neighbours that a layer goes on in
constexpr int kMinOverhangCells = 5;  // of 3 x 3
constexpr int kFillReach = 48;        // pixels
constexpr int kMaxLayers = 4;

struct Layer {
  float x = 0, y = 0;  // from the cell's centre
  float height = 0;
  float weight = 0;
};

struct Plane {
  float height = kNoHeight;  // at the cell's centre
  float slope_x = 0, slope_y = 0;
};

// dx, dy of the 8 neighbours; k and k + 4 lie on opposite sides.
constexpr std::array<std::array<int, 2>, 8> kAround = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr float kDistance[2] = {1, 1.41421356f};

// The cells of a tile and its halo.
class CellGrid {
 public:
  CellGrid(const ReliefOptions& options, const MapGrid::Box& box)
      : size_(options.cell_size),
        unit_(static_cast<float>(options.cell_size * options.pixel_size)),
        nx_((box.width + 2 * kTileHalo + size_ - 1) / size_),
        ny_((box.height + 2 * kTileHalo + size_ - 1) / size_) {}

  void AddPoints(const std::vector<TilePoint>& points);
  void ChooseSurface();
  void Bridge();
  void Fill();
  void MarkOverhangs();
  // Height of a pixel of the tile, in cells.
  Plane PlaneAt(int x, int y) const;
  uint8_t Flags(int x, int y) const { return flags_[At(x, y)]; }

 private:
  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(nx_) + static_cast<size_t>(x);
  }
  void AddLayers(TilePoint* begin, TilePoint* end);
  void BridgeBetween(int x, int y, size_t k, int far);
  int Support(int x, int y, float height) const;

  int size_;
  float unit_;  // a cell's side, map's unit
  int nx_, ny_;
  std::vector<Layer> layers_;
  std::vector<uint32_t> first_layer_;  // by cell, and the end
  std::vector<Layer> surface_;         // weight 0: none
  std::vector<uint8_t> flags_;
  std::vector<uint8_t> has_lower_;  // another layer that goes on around, below the surface
};

// Points become layers, cell by cell: positions from the cell's centre, all in cells.
void CellGrid::AddPoints(const std::vector<TilePoint>& points) {
  const size_t num_cells = static_cast<size_t>(nx_) * static_cast<size_t>(ny_);
  const float per_pixel = 1 / static_cast<float>(size_), per_unit = 1 / unit_;
  const auto column_of = [&](const TilePoint& point) {
    return std::clamp(static_cast<int>((point.column + kTileHalo) * per_pixel), 0, nx_ - 1);
  };
  const auto row_of = [&](const TilePoint& point) {
    return std::clamp(static_cast<int>((point.row + kTileHalo) * per_pixel), 0, ny_ - 1);
  };
  std::vector<uint32_t> ends(num_cells + 1, 0);
  for (const TilePoint& point : points) ++ends[At(column_of(point), row_of(point)) + 1];
  for (size_t i = 1; i <= num_cells; ++i) ends[i] += ends[i - 1];
  std::vector<TilePoint> sorted(points.size());
  for (const TilePoint& point : points) {
    const int column = column_of(point), row = row_of(point);
    const float x = static_cast<float>(column) + 0.5f, y = static_cast<float>(row) + 0.5f;
    sorted[ends[At(column, row)]++] = {(point.column + kTileHalo) * per_pixel - x,
                                       (point.row + kTileHalo) * per_pixel - y,
                                       point.height * per_unit, point.weight};
  }
  first_layer_.assign(1, 0);
  first_layer_.reserve(num_cells + 1);
  layers_.reserve(points.size());
  for (size_t i = 0, begin = 0; i < num_cells; begin = ends[i++]) {
    AddLayers(sorted.data() + begin, sorted.data() + ends[i]);
    first_layer_.push_back(static_cast<uint32_t>(layers_.size()));
  }
}

// Of the points of one cell, the highest first, of equal ones the first of the file.
void CellGrid::AddLayers(TilePoint* begin, TilePoint* end) {
  for (TilePoint* at = begin; at != end; ++at) {  // few: sorted by insertion
    std::rotate(std::upper_bound(
                    begin, at, *at,
                    [](const TilePoint& a, const TilePoint& b) { return a.height > b.height; }),
                at, at + 1);
  }
  float top = 0, last = 0;
  int num_layers = 0;
  for (const TilePoint* point = begin; point != end; ++point) {
    if (num_layers == 0 || last - point->height > kLayerGap) {
      if (num_layers++ == kMaxLayers) return;
      layers_.push_back({});
      top = point->height;
    }
    last = point->height;
    if (top - point->height > kTopDepth) continue;
    Layer& layer = layers_.back();
    layer.weight += point->weight;
    const float share = point->weight / layer.weight;
    layer.x += share * (point->column - layer.x);
    layer.y += share * (point->row - layer.y);
    layer.height += share * (point->height - layer.height);
  }
}

// In how many of the cells around a surface at this height goes on.
int CellGrid::Support(int x, int y, float height) const {
  int support = 0;
  for (size_t k = 0; k < kAround.size(); ++k) {
    const size_t at = At(x + kAround[k][0], y + kAround[k][1]);
    const float limit = kMaxSlope * kDistance[k % 2];
    bool goes_on = false;
    for (uint32_t i = first_layer_[at]; i < first_layer_[at + 1]; ++i) {
      goes_on |= std::abs(layers_[i].height - height) <= limit;
    }
    support += goes_on;
  }
  return support;
}

void CellGrid::ChooseSurface() {
  surface_.assign(first_layer_.size() - 1, {});
  flags_.assign(surface_.size(), 0);
  has_lower_.assign(surface_.size(), 0);
  for (int y = 1; y + 1 < ny_; ++y) {
    for (int x = 1; x + 1 < nx_; ++x) {
      const size_t at = At(x, y);
      for (uint32_t i = first_layer_[at]; i < first_layer_[at + 1]; ++i) {
        if (Support(x, y, layers_[i].height) < kMinSupport) continue;
        if (flags_[at] != 0) has_lower_[at] = 1;
        if (flags_[at] == 0) surface_[at] = layers_[i];
        flags_[at] = kMeasured;
      }
    }
  }
}

// An empty cell between measured ones on opposite sides, one of them next to it and the other at
// most two away; of the higher surface where several go through.
void CellGrid::Bridge() {
  for (int y = 2; y + 2 < ny_; ++y) {
    for (int x = 2; x + 2 < nx_; ++x) {
      if (flags_[At(x, y)] != 0) continue;
      uint8_t around = 0;
      for (const auto& [dx, dy] : kAround) around |= flags_[At(x + dx, y + dy)];
      if ((around & kMeasured) == 0) continue;
      for (size_t k = 0; k < kAround.size(); ++k) {
        BridgeBetween(x, y, k, 1);
        BridgeBetween(x, y, k, 2);
      }
    }
  }
}

// From the neighbour in direction k to what lies `far` cells on the other side.
void CellGrid::BridgeBetween(int x, int y, size_t k, int far) {
  const auto [dx, dy] = kAround[k];
  const size_t at = At(x, y), a = At(x + dx, y + dy), b = At(x - far * dx, y - far * dy);
  if ((flags_[a] & flags_[b] & kMeasured) == 0) return;
  const auto reach = static_cast<float>(far);
  const auto fx = static_cast<float>(dx), fy = static_cast<float>(dy);
  const Eigen::Vector3f from(fx + surface_[a].x, fy + surface_[a].y, surface_[a].height);
  const Eigen::Vector3f to(surface_[b].x - reach * fx, surface_[b].y - reach * fy,
                           surface_[b].height);
  const Eigen::Vector3f way = to - from;
  if (std::abs(way.z()) > kMaxSlope * kDistance[k % 2] * (1 + reach)) return;
  // The place on the line between both that is nearest to the cell's centre.
  const float share = -from.head<2>().dot(way.head<2>()) / way.head<2>().squaredNorm();
  const Eigen::Vector3f place = from + std::clamp(share, 0.0f, 1.0f) * way;
  if (flags_[at] != 0 && place.z() <= surface_[at].height) return;
  surface_[at] = {place.x(), place.y(), place.z(),
                  std::min(surface_[a].weight, surface_[b].weight)};
  flags_[at] = kBridged;
}

// The nearest cells with a surface to either side along a row and a column, and between them a mean
// by nearness: only where all four are there, so that nothing grows beyond the survey's border.
void CellGrid::Fill() {
  const std::vector<uint8_t> known = flags_;
  const int reach = kFillReach / size_;
  for (int y = reach; y + reach < ny_; ++y) {
    for (int x = reach; x + reach < nx_; ++x) {
      if (known[At(x, y)] != 0) continue;
      float sum = 0, weights = 0;
      int num_sides = 0;
      for (size_t k = 0; k < 8; k += 2) {
        int step = 1;
        const auto place = [&] { return At(x + step * kAround[k][0], y + step * kAround[k][1]); };
        while (step < reach && known[place()] == 0) ++step;
        if (known[place()] == 0) break;
        sum += surface_[place()].height / static_cast<float>(step);
        weights += 1 / static_cast<float>(step);
        ++num_sides;
      }
      if (num_sides < 4) continue;
      surface_[At(x, y)] = {0, 0, sum / weights, 0};
      flags_[At(x, y)] = kFilled;
    }
  }
}

// A cliff's edge, one cell wide, has points of both its levels too, and is none.
void CellGrid::MarkOverhangs() {
  for (int y = 1; y + 1 < ny_; ++y) {
    for (int x = 1; x + 1 < nx_; ++x) {
      if (flags_[At(x, y)] == 0) continue;
      int num_lower = has_lower_[At(x, y)];
      for (const auto& [dx, dy] : kAround) num_lower += has_lower_[At(x + dx, y + dy)];
      if (num_lower >= kMinOverhangCells) flags_[At(x, y)] |= kOverhang;
    }
  }
}

// Weighted least squares. Steep slopes have to be told by several cells: a term pulls them to 0.
Plane CellGrid::PlaneAt(int x, int y) const {
  const Layer& own = surface_[At(x, y)];
  if (flags_[At(x, y)] & kFilled) return {own.height, 0, 0};
  float s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sz = 0, sxz = 0, syz = 0;
  const auto add = [&](float px, float py, float height, float weight) {
    const float w = weight / (0.5f + px * px + py * py), z = height - own.height;
    s += w, sx += w * px, sy += w * py, sz += w * z;
    sxx += w * px * px, sxy += w * px * py, syy += w * py * py;
    sxz += w * px * z, syz += w * py * z;
  };
  if (own.weight > 0) add(own.x, own.y, own.height, own.weight);
  for (size_t k = 0; k < kAround.size(); ++k) {
    const size_t at = At(x + kAround[k][0], y + kAround[k][1]);
    const Layer& other = surface_[at];
    const bool belongs = (flags_[at] & kMeasured) != 0 &&
                         std::abs(other.height - own.height) <= kMaxSlope * kDistance[k % 2];
    if (!belongs) continue;
    add(static_cast<float>(kAround[k][0]) + other.x, static_cast<float>(kAround[k][1]) + other.y,
        other.height, other.weight);
  }
  if (!(s > 0)) return {own.height, 0, 0};
  const float mx = sx / s, my = sy / s, mz = sz / s, ridge = 0.02f * s;
  const float cxx = sxx - sx * mx + ridge, cyy = syy - sy * my + ridge, cxy = sxy - sx * my;
  const float cxz = sxz - sx * mz, cyz = syz - sy * mz;
  const float determinant = cxx * cyy - cxy * cxy;
  const float a = (cyy * cxz - cxy * cyz) / determinant;
  const float b = (cxx * cyz - cxy * cxz) / determinant;
  return {own.height + mz - a * mx - b * my, a, b};
}

// The pixels of one cell that lie in the tile and its margin.
void DrawCell(const CellGrid& cells, int x, int y, const ReliefOptions& options, ReliefTile* tile) {
  const uint8_t flags = cells.Flags(x, y);
  if (flags == 0) return;
  const Plane plane = cells.PlaneAt(x, y);
  const int size = options.cell_size;
  const auto side = static_cast<float>(size);
  for (int py = 0; py < size; ++py) {
    for (int px = 0; px < size; ++px) {
      const int column = x * size + px - kTileHalo, row = y * size + py - kTileHalo;
      if (!tile->heights.Contains(column + kReliefMargin, row + kReliefMargin)) continue;
      const float dx = (static_cast<float>(px) + 0.5f) / side - 0.5f;
      const float dy = (static_cast<float>(py) + 0.5f) / side - 0.5f;
      const float height = plane.height + plane.slope_x * dx + plane.slope_y * dy;
      tile->heights.At(column + kReliefMargin, row + kReliefMargin) =
          static_cast<float>(options.base_height + double{height} * size * options.pixel_size);
      if (tile->surface.Contains(column, row)) tile->surface.At(column, row) = flags;
    }
  }
}

}  // namespace

ReliefTile MakeReliefTile(const ReliefOptions& options, const std::vector<TilePoint>& points,
                          const MapGrid::Box& box) {
  ReliefTile tile;
  if (points.empty()) return tile;
  CellGrid cells(options, box);
  cells.AddPoints(points);
  cells.ChooseSurface();
  cells.Bridge();
  if (options.fill) cells.Fill();
  cells.MarkOverhangs();
  tile.heights =
      FloatImage(box.width + 2 * kReliefMargin, box.height + 2 * kReliefMargin, 1, kNoHeight);
  tile.surface = Image<uint8_t>(box.width, box.height);
  const int first = (kTileHalo - kReliefMargin) / options.cell_size;
  const int end_x = (kTileHalo + box.width + kReliefMargin) / options.cell_size;
  const int end_y = (kTileHalo + box.height + kReliefMargin) / options.cell_size;
  for (int y = first; y <= end_y; ++y) {
    for (int x = first; x <= end_x; ++x) DrawCell(cells, x, y, options, &tile);
  }
  return tile;
}

}  // namespace colmap_seapoint
