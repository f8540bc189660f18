// The files of a map, written tile by tile while it is made.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/io/raster/raster_reader.h"
#include "colmap_seapoint/io/raster/raster_writer.h"
#include "colmap_seapoint/orthomosaic/ground/map_tile.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_placement.h"

namespace colmap_seapoint {

inline constexpr char kMapColors[] = "orthomosaic.tif";   // red green blue alpha
inline constexpr char kMapHeights[] = "dem.tif";          // float32
inline constexpr char kMapSources[] = "source.tif";       // labels of source.csv
inline constexpr char kMapSurface[] = "surface.tif";      // SurfaceFlags
inline constexpr char kMapHillshade[] = "hillshade.png";  // of the heights
inline constexpr char kMapPreview[] = "orthomosaic.jpg";  // small
inline constexpr char kMapSourceTable[] = "source.csv";
inline constexpr char kMapDescription[] = "map.json";

inline constexpr double kNoHeightInFile = -9999;

// The rasters that a map which is continued is taken over from.
std::vector<std::string> MapRasters();

// What every map has, with run.json; what depends on its size and frame comes on top.
std::vector<std::string> MapNames();

class MapFiles : public MapTileSink {
 public:
  // `folder` has claimed MapNames(); it outlives this object. Labels are positions in the model's
  // images plus one. `former`: the folder of the rasters of a map that is continued.
  MapFiles(OutputFolder* folder, const std::optional<ModelUnits>& units, size_t num_pictures,
           int num_threads, std::filesystem::path former = {});

  // Removes what an earlier map in the folder had beyond these.
  void Begin(const MapFrame& frame, const MapGrid& grid) override;
  void Take(MapTile&& tile) override;
  MapTile TakeOver(const MapGrid::Box& box, int x, int y) override;
  // The rasters, then the pictures that are made of them; `progress` is told the share that is
  // done. Throws Error.
  void Finish(const std::function<void(double)>& progress);

  const MapPlacement& Placement() const { return placement_; }  // after Begin()

 private:
  RasterWriter& Writer(const std::string& name);
  void Open(const std::string& name, RasterLayout layout);
  void RemoveFormer() const;
  void TakeSources(int column, int row, const Image<int32_t>& source);
  // The box of a raster as it was at (x, y); what it did not hold is as in `tile`.
  template <typename T>
  Image<T> Former(const std::string& name, int x, int y, Image<T> tile);
  template <typename Label>
  void WriteSources(int column, int row, const Image<int32_t>& source);

  struct Raster {
    std::string name;
    RasterLayout layout;
    std::unique_ptr<RasterWriter> writer;
  };

  OutputFolder& folder_;
  std::optional<ModelUnits> units_;
  size_t num_pictures_;
  int num_threads_;
  std::filesystem::path former_;
  std::map<std::string, std::unique_ptr<RasterReader>> former_rasters_;
  MapPlacement placement_;
  std::vector<Raster> rasters_;
  int tile_size_ = 0;
  double height_step_ = 0;  // heights are whole numbers of it
};

}  // namespace colmap_seapoint
