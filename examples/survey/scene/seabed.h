// A made-up seabed: rock with ledges and boulders, rippled sand, pebbles, crusts and turf. Heights
// and colours are functions of world x, y (metres) and the seed, sampled on lattices.
#pragma once

#include <cstdint>
#include <vector>

#include "examples/survey/scene/height_field.h"
#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {

struct SeabedOptions {
  uint64_t seed = 1;
  double relief = 1;     // factor on all heights; 0 = a plane
  double cell = 0.0017;  // metres between the nodes of the height field (about one GSD)
};

// Linear reflectance, 0..1.
struct Albedo {
  float red = 0, green = 0, blue = 0;
};

class Seabed {
 public:
  explicit Seabed(const SeabedOptions& options) : options_(options) {}

  const SeabedOptions& Options() const { return options_; }
  Field MakeHeights(const GridSpec& grid) const;
  std::vector<Albedo> MakeAlbedo(const GridSpec& grid) const;

 private:
  SeabedOptions options_;
};

// Heights over the rectangle, computed in parallel.
HeightField MakeHeightField(const Seabed& seabed, double min_x, double min_y, double max_x,
                            double max_y, int num_threads);

// The colours of the seabed on a lattice of half a cell, bilinear between the nodes. Tiles are made
// when a picture needs them and dropped when the memory runs out.
class AlbedoMap {
 public:
  static constexpr int kTileSize = 256;  // texels

  AlbedoMap(const Seabed& seabed, double min_x, double min_y, double max_x, double max_y,
            size_t max_bytes);

  // Makes what is missing within the rectangle; drops the tiles unused for longest first.
  void Prepare(double min_x, double min_y, double max_x, double max_y, int num_threads);

  // The colour at a place within the rectangle of the last Prepare(). May be called from any number
  // of threads.
  Albedo At(double x, double y) const;

 private:
  using Texel = uint32_t;  // three square roots of 10 bits
  struct Tile {
    std::vector<Texel> texels;  // (kTileSize + 1)^2: the last row and column are the next tile's
    int64_t last_use = -1;
  };
  void MakeTile(size_t index);
  void DropOldTiles();

  const Seabed* seabed_;
  double texel_size_;
  int64_t ix0_, iy0_;  // of the first texel
  int num_tiles_x_, num_tiles_y_;
  size_t max_tiles_;
  int64_t num_uses_ = 0;
  std::vector<Tile> tiles_;
};

}  // namespace colmap_seapoint
