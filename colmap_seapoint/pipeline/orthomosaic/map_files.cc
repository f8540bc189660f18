#include "colmap_seapoint/pipeline/orthomosaic/map_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <mutex>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/io/raster/map_pictures.h"
#include "colmap_seapoint/io/raster/world_file.h"

namespace colmap_seapoint {
namespace {

constexpr char kFlagsText[] =
    "sum of 1: measured, 2: bridged between measured cells next to it, 4: filled, 8: another "
    "surface below, 16: no picture shows it";

// A step that floats hold exactly, at most a 64th of a pixel: what is finer is noise, and packs to
// two and a half times the size.
double HeightStep(double pixel_size) { return std::exp2(std::floor(std::log2(pixel_size / 64))); }

FloatImage HeightsForFile(FloatImage heights, double offset, double step) {
  const double per_step = 1 / step;
  for (float& height : heights.data) {
    height = std::isnan(height)
                 ? static_cast<float>(kNoHeightInFile)
                 : static_cast<float>(step * std::rint(per_step * (double{height} + offset)));
  }
  return heights;
}

}  // namespace

std::vector<std::string> MapNames() {
  std::vector<std::string> names = {kMapColors,      kMapHeights,     kMapSources, kMapSurface,
                                    kMapSourceTable, kMapDescription, "run.json"};
  for (const char* picture : {kMapHillshade, kMapPreview}) {
    for (const std::string& name : MapPictureFiles(picture)) names.push_back(name);
  }
  return names;
}

std::vector<std::string> MapRasters() {
  return {kMapColors, kMapHeights, kMapSources, kMapSurface};
}

MapFiles::MapFiles(OutputFolder* folder, const std::optional<ModelUnits>& units,
                   size_t num_pictures, int num_threads, std::filesystem::path former)
    : folder_(*folder),
      units_(units),
      num_pictures_(num_pictures),
      num_threads_(num_threads),
      former_(std::move(former)) {}

void MapFiles::Open(const std::string& name, RasterLayout layout) {
  rasters_.push_back({name, std::move(layout), nullptr});
}

RasterWriter& MapFiles::Writer(const std::string& name) {
  const auto found = std::find_if(rasters_.begin(), rasters_.end(),
                                  [&](const Raster& raster) { return raster.name == name; });
  SEAPOINT_CHECK(found != rasters_.end());
  return *found->writer;
}

// A world file beside a map that says itself where it lies, or blocks of a larger one, would
// mislead.
void MapFiles::RemoveFormer() const {
  for (const Raster& raster : rasters_) {
    const std::filesystem::path name = raster.name;
    for (const std::string& former :
         {WorldFileOf(name).generic_string(), name.stem().string() + ".vrt",
          name.stem().string() + "_blocks"}) {
      if (folder_.IsOurs(former)) folder_.Remove(former);
    }
  }
}

void MapFiles::Begin(const MapFrame& frame, const MapGrid& grid) {
  placement_ = PlaceMap(frame, units_);
  tile_size_ = grid.tile_size;
  height_step_ = HeightStep(grid.pixel_size);
  const auto layout_of = [&](RasterBands bands, std::optional<double> nodata) {
    RasterLayout layout = LayoutOfMap(grid, placement_, bands);
    layout.nodata = nodata;
    layout.metadata = {{"MAP_FRAME", frame.text}};
    return layout;
  };
  Open(kMapColors, layout_of(RasterBands::kRgba8, std::nullopt));
  RasterLayout heights = layout_of(RasterBands::kFloat32, kNoHeightInFile);
  heights.unit = placement_.unit;
  Open(kMapHeights, std::move(heights));
  const bool is_wide = num_pictures_ > std::numeric_limits<uint16_t>::max();
  RasterLayout sources = layout_of(is_wide ? RasterBands::kUint32 : RasterBands::kUint16, 0);
  sources.metadata.emplace_back("LABELS", std::string("pictures of ") + kMapSourceTable);
  Open(kMapSources, std::move(sources));
  RasterLayout surface = layout_of(RasterBands::kUint8, 0);
  surface.metadata.emplace_back("FLAGS", kFlagsText);
  Open(kMapSurface, std::move(surface));
  RemoveFormer();
  for (Raster& raster : rasters_) {
    folder_.Claim(RasterFiles(raster.name, raster.layout));
    raster.writer = std::make_unique<RasterWriter>(folder_.Path() / raster.name, raster.layout);
  }
}

template <typename Label>
void MapFiles::WriteSources(int column, int row, const Image<int32_t>& source) {
  Image<Label> labels(source.width, source.height);
  std::transform(source.data.begin(), source.data.end(), labels.data.begin(),
                 [](int32_t picture) { return static_cast<Label>(picture + 1); });
  Writer(kMapSources).WriteTile(column, row, labels);
}

void MapFiles::Take(MapTile&& tile) {
  static_assert(kNoSource == -1);
  const int column = tile.x / tile_size_, row = tile.y / tile_size_;
  Writer(kMapColors).WriteTile(column, row, tile.rgba);
  Writer(kMapHeights)
      .WriteTile(column, row,
                 HeightsForFile(std::move(tile.relief), placement_.offset.z(), height_step_));
  Writer(kMapSurface).WriteTile(column, row, tile.surface);
  TakeSources(column, row, tile.source);
}

template <typename T>
Image<T> MapFiles::Former(const std::string& name, int x, int y, Image<T> tile) {
  std::unique_ptr<RasterReader>& raster = former_rasters_[name];
  if (raster == nullptr) raster = std::make_unique<RasterReader>(former_ / name);
  raster->ReadWindow(x, y, &tile);
  return tile;
}

MapTile MapFiles::TakeOver(const MapGrid::Box& box, int x, int y) {
  const int column = box.x / tile_size_, row = box.y / tile_size_;
  MapTile tile;
  tile.x = box.x;
  tile.y = box.y;
  Writer(kMapColors)
      .WriteTile(column, row, Former(kMapColors, x, y, Image<uint8_t>(box.width, box.height, 4)));
  const FloatImage none(box.width, box.height, 1, static_cast<float>(kNoHeightInFile));
  Writer(kMapHeights).WriteTile(column, row, Former(kMapHeights, x, y, none));
  tile.surface = Former(kMapSurface, x, y, Image<uint8_t>(box.width, box.height));
  Writer(kMapSurface).WriteTile(column, row, tile.surface);
  const Image<uint32_t> labels = Former(kMapSources, x, y, Image<uint32_t>(box.width, box.height));
  tile.source = Image<int32_t>(box.width, box.height);
  std::transform(labels.data.begin(), labels.data.end(), tile.source.data.begin(),
                 [](uint32_t label) { return static_cast<int32_t>(label) - 1; });
  TakeSources(column, row, tile.source);
  return tile;
}

void MapFiles::TakeSources(int column, int row, const Image<int32_t>& source) {
  if (num_pictures_ > std::numeric_limits<uint16_t>::max()) {
    WriteSources<uint32_t>(column, row, source);
  } else {
    WriteSources<uint16_t>(column, row, source);
  }
}

void MapFiles::Finish(const std::function<void(double)>& progress) {
  const auto num_steps = static_cast<double>(rasters_.size() + 2);
  std::mutex mutex;
  double num_done = 0;
  const auto finish_step = [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    progress(++num_done / num_steps);
  };
  ParallelFor(num_threads_, static_cast<int64_t>(rasters_.size()), [&](int64_t i) {
    Raster& raster = rasters_[static_cast<size_t>(i)];
    raster.writer->Finish();
    raster.writer = nullptr;
    finish_step();
  });
  ParallelFor(num_threads_, 2, [&](int64_t i) {
    if (i == 0) WriteHillshade(folder_.Path() / kMapHeights, folder_.Path() / kMapHillshade);
    if (i == 1) WritePreview(folder_.Path() / kMapColors, folder_.Path() / kMapPreview);
    finish_step();
  });
}

}  // namespace colmap_seapoint
