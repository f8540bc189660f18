// The map of a survey: relief and true orthomosaic on one grid (ours).
//
// Nothing is made up: where the cloud has no surface the map has none, unless `fill` asks for it,
// and every pixel says which picture its colour is from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/ground/map_tile.h"
#include "colmap_seapoint/orthomosaic/map_memory.h"
#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"
#include "colmap_seapoint/water/water_model.h"

namespace colmap_seapoint {

// Raised whenever a map changes for the same inputs and options.
inline constexpr char kOrthomosaicVersion[] = "3";

struct OrthomosaicOptions {
  MapFrameOptions plane;
  double pixel_size = 0;  // of the model's unit; 0 = the survey's ground sampling distance
  bool fill = false;      // also what lies between measured cells up to 48 pixels apart; marked
  bool balance = true;    // one brightness and colour for all pictures
  bool restore = false;   // colours without the water, where the survey tells it; for the eye only
  int num_threads = -1;   // -1 = all; never changes a result
  size_t picture_bytes = size_t{256} << 20;  // of decoded pictures that are kept
};

struct OrthomosaicInputs {
  const SparseModel& model;                // of a map that is continued: its pictures first
  std::filesystem::path cloud_path;        // PLY, in the model's frame
  std::optional<ModelUnits> units;         // of the model
  MapPictureReader read;                   // pictures of the model
  std::filesystem::path temporary_folder;  // some 16 bytes a point and 5 a pixel
  // Told the share of the work that is done, from one thread at a time; empty: nobody asks.
  std::function<void(double)> progress = nullptr;
  // The map that is continued, of a cloud whose points come first in this one; of colours that are
  // not restored. nullptr: there is none.
  const MapMemory* before = nullptr;
};

struct OrthomosaicSummary {
  MapFrame frame;
  MapGrid grid;
  double gsd = 0;                    // of the survey, in the model's unit a pixel
  int cell_size = 1;                 // pixels, in most tiles: as fine as the cloud is, no finer
  uint64_t num_surface_pixels = 0;   // with a height
  uint64_t num_bridged_pixels = 0;   // of these: between measured ones, in cells without a point
  uint64_t num_filled_pixels = 0;    // of these: made up, by `fill`
  uint64_t num_overhang_pixels = 0;  // of these: with another surface below
  uint64_t num_colored_pixels = 0;   // of these: with a picture
  uint64_t num_points_outside = 0;   // of the map: far from all others
  size_t num_picture_reads = 0;
  std::optional<WaterModel>
      water;  // with `restore`; where it is not determined, nothing is restored
  std::vector<size_t> pictures_used;    // positions in the model's images, ascending
  std::vector<size_t> pictures_unread;  // those that could not be read, or are of another shape
  size_t num_tiles = 0, num_tiles_drawn = 0;  // with a surface; the others are as they were
  MapMemory memory;                           // for the map that continues this one
};

// Finds the plane and the grid, makes the relief, chooses a picture for every part of it, and hands
// over tile by tile. Same bytes for any number of threads. Each picture is read once to look at,
// and about once more to draw, or once in all where the cache holds them; `read` returns an empty
// picture for one that cannot be used. Memory: pictures in the cache and one a thread, 110 MB a
// thread (of six at most), some 80 bytes for every 16 x 16 pixels with a surface. Throws NoMap for
// a cloud without a surface and a map that would be too large, Error for a cloud without points or
// of which no picture of the model sees the half, and no space for temporary files.
OrthomosaicSummary MakeOrthomosaic(const OrthomosaicOptions& options,
                                   const OrthomosaicInputs& inputs, MapTileSink* sink);

}  // namespace colmap_seapoint
