// The surface as cells on plans: where the cloud covers it, and where something is missing.
//
// A cell is two wanted spacings wide. Cells lie on the six sides of a box around the survey
// (PlanFrame): the top one holds all that faces the viewer of the map, the others what is steeper
// than 75 degrees. The five others are cut into slabs as deep as kSlabCells cells, so that two
// walls one behind the other, or the underside of one thing above that of another, are layers of
// their own.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <tuple>

#include "densify/completeness/surface/gap_cause.h"
#include "densify/completeness/surface/plan_frame.h"
#include "densify/completeness/surface/plane_pyramid.h"
#include "densify/completeness/surface/tiled_grid.h"

namespace colmap_seapoint {

inline constexpr int kSlabCells = 128;
inline constexpr double kCellSpacings = 2;  // side of a cell, in wanted spacings

struct GroundCell {
  float height = 0;    // along the side's axis: mean of the points, or the predicted surface's
  float gsd = 0;       // units a pixel of the nearest picture, as if it were level
  float area = 0;      // units^2 of surface, along its slope
  uint16_t count = 0;  // points of enough confidence
  bool is_coherent = false;  // its points lie on one surface with those around
  bool is_covered = false;
  bool is_thin = false;       // not covered, yet with too many points to call it a gap
  bool is_from_afar = false;  // covered by what farther pictures than usual can give
  bool has_pair = false;      // two pictures see it from two sides
  bool is_expected = false;   // part of what the survey should have covered
  GapCause cause = GapCause::kNone;
  // Of a sample of the covered cells: usable pictures that see it, and the largest angle between
  // two of them, up to 180 degrees.
  uint8_t num_views = 0;
  uint8_t texture = 255;  // what its good pictures show of it, as in PictureFacts
  uint8_t parallax_deg = 0;
};

struct LayerKey {
  Side side = Side::kTop;
  int slab = 0;
  bool operator<(const LayerKey& other) const {
    return std::tie(side, slab) < std::tie(other.side, other.slab);
  }
};

struct GroundLayer {
  Eigen::Matrix3d layer_from_world;  // rows: u, v, height
  TiledGrid<GroundCell> cells;
  PlanePyramid surface;

  GroundLayer(const Eigen::Matrix3d& rotation, double cell_side)
      : layer_from_world(rotation), surface(4 * cell_side) {}
};

struct Ground {
  PlanFrame frame;
  double cell_side = 1;  // units
  std::map<LayerKey, GroundLayer> layers;

  GroundLayer& LayerAt(const LayerKey& key);
  // World coordinates of a cell's middle, at a height.
  Eigen::Vector3d PlaceOf(const GroundLayer& layer, int x, int y, double height) const;
  int CellOf(double coordinate) const;
};

struct SurfacePoint {
  Eigen::Vector3d xyz, normal;  // world; normal zero: unknown
};

// Counts a point of the cloud.
void AddPoint(const SurfacePoint& point, Ground* ground);
// A triangulated point of the model: it says where the surface is, and covers nothing.
void AddHint(const Eigen::Vector3d& xyz, Ground* ground);

// To be called once, after all points: heights, areas and which cells are covered. A cell is
// covered when it, or it and its neighbours together, hold 0.6 of the points that the spacing asks
// for on a surface of that slope (measured: so the share is that of the surface with a point within
// two GSD); with 0.43 of them it is thin. Either needs neighbours that lie on one surface with it.
// Threads: any number, the same result.
void FinishPoints(int num_threads, Ground* ground);

// Area of a cell that is not covered, from the predicted surface, and its height, but where its own
// points lie on one surface with their neighbours.
void PredictCell(const Ground& ground, const GroundLayer& layer, int x, int y, GroundCell* cell);

// Points of the (2 reach + 1)^2 cells around one.
int CountAround(const GroundLayer& layer, int x, int y, int reach);

// Points that the spacing asks for on an area.
double WantedPoints(double area, double spacing);
inline constexpr double kCoveredShare = 0.6, kThinShare = 0.43;

}  // namespace colmap_seapoint
