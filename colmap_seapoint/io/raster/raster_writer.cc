#include "colmap_seapoint/io/raster/raster_writer.h"

#include <algorithm>
#include <mutex>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_path.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/raster/cog_file.h"
#include "colmap_seapoint/io/raster/world_file.h"

namespace colmap_seapoint {
namespace {

struct BandType {
  GDALDataType type;
  int count;
};

BandType TypeOf(RasterBands bands) {
  switch (bands) {
    case RasterBands::kFloat32:
      return {GDT_Float32, 1};
    case RasterBands::kRgba8:
      return {GDT_Byte, 4};
    case RasterBands::kUint8:
      return {GDT_Byte, 1};
    case RasterBands::kUint16:
      return {GDT_UInt16, 1};
    case RasterBands::kUint32:
      return {GDT_UInt32, 1};
  }
  SEAPOINT_CHECK(false);
  return {};
}

bool NeedsBlocks(const RasterLayout& layout, const RasterWriterOptions& options) {
  return std::max(layout.width, layout.height) > options.max_block_side;
}

bool Describe(GDALDatasetH dataset, const RasterLayout& layout, const std::string& crs_wkt) {
  double transform[6] = {layout.min_x, layout.pixel_size, 0, layout.max_y, 0, -layout.pixel_size};
  bool described = GDALSetGeoTransform(dataset, transform) == CE_None;
  if (!crs_wkt.empty()) {
    described = described && GDALSetProjection(dataset, crs_wkt.c_str()) == CE_None;
  }
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  if (layout.nodata) GDALSetRasterNoDataValue(band, *layout.nodata);
  if (!layout.unit.empty()) GDALSetRasterUnitType(band, layout.unit.c_str());
  for (const auto& [name, value] : layout.metadata) {
    GDALSetMetadataItem(dataset, name.c_str(), value.c_str(), nullptr);
  }
  return described;
}

}  // namespace

struct RasterWriter::Impl {
  Impl(const std::filesystem::path& path_in, const RasterLayout& layout_in,
       const RasterWriterOptions& options_in)
      : path(path_in), layout(layout_in), options(options_in), scratch(path_in) {}

  void Open(const std::string& crs_wkt) {
    const GdalSession session(path);
    const BandType bands = TypeOf(layout.bands);
    GdalStrings creation = ScratchOptions(layout);
    dataset.reset(GDALCreate(GdalDriver("GTiff"), scratch.Temporary().c_str(), layout.width,
                             layout.height, bands.count, bands.type, creation.List()));
    session.Check(dataset != nullptr && Describe(dataset.get(), layout, crs_wkt), &scratch);
  }

  void Write(int column, int row, const void* pixels, int width, int height, int channels,
             GDALDataType type) {
    const BandType bands = TypeOf(layout.bands);
    const RasterWindow window = TileWindow(layout, column, row);
    SEAPOINT_CHECK(type == bands.type && channels == bands.count);
    SEAPOINT_CHECK(width == window.width && height == window.height);
    const std::lock_guard<std::mutex> held(mutex);
    SEAPOINT_CHECK(dataset != nullptr);
    const GdalSession session(path);
    const int sample = GDALGetDataTypeSizeBytes(type);
    const CPLErr written =
        GDALDatasetRasterIO(dataset.get(), GF_Write, window.x, window.y, width, height,
                            const_cast<void*>(pixels), width, height, type, channels, nullptr,
                            sample * channels, sample * channels * width, sample);
    session.Check(written == CE_None, &scratch);
  }

  template <typename T>
  void WriteImage(int column, int row, const Image<T>& tile, GDALDataType type) {
    Write(column, row, tile.data.data(), tile.width, tile.height, tile.channels, type);
  }

  void Finish() {
    const std::lock_guard<std::mutex> held(mutex);
    SEAPOINT_CHECK(dataset != nullptr);
    if (NeedsBlocks(layout, options)) {
      WriteBlocks(dataset.get(), path, layout, options.max_block_side);
    }
    WriteCog(dataset.get(), scratch, path, layout);
    if (layout.crs.empty()) WriteWorldFile(path, layout);
    Close();
  }

  // What GDAL still has to say of a file that nobody wants any more is nothing to the user.
  void Close() {
    if (dataset == nullptr) return;
    const GdalSession session(path);
    dataset.reset();
  }

  ~Impl() { Close(); }

  std::filesystem::path path;
  RasterLayout layout;
  RasterWriterOptions options;
  AtomicPath scratch;
  GdalDataset dataset;
  std::mutex mutex;
};

RasterWriter::RasterWriter(const std::filesystem::path& path, const RasterLayout& layout,
                           const RasterWriterOptions& options) {
  const std::string problem = CheckLayout(layout);
  if (!problem.empty()) {
    throw Error(path.string(), "the map " + problem, "choose another pixel size");
  }
  const std::string crs_wkt = layout.crs.empty() ? "" : WellKnownText(layout.crs, path.string());
  impl_ = std::make_unique<Impl>(path, layout, options);
  impl_->Open(crs_wkt);
}

RasterWriter::~RasterWriter() = default;

void RasterWriter::WriteTile(int column, int row, const Image<float>& tile) {
  impl_->WriteImage(column, row, tile, GDT_Float32);
}
void RasterWriter::WriteTile(int column, int row, const Image<uint8_t>& tile) {
  impl_->WriteImage(column, row, tile, GDT_Byte);
}
void RasterWriter::WriteTile(int column, int row, const Image<uint16_t>& tile) {
  impl_->WriteImage(column, row, tile, GDT_UInt16);
}
void RasterWriter::WriteTile(int column, int row, const Image<uint32_t>& tile) {
  impl_->WriteImage(column, row, tile, GDT_UInt32);
}

void RasterWriter::Finish() { impl_->Finish(); }

std::vector<std::string> RasterFiles(const std::string& name, const RasterLayout& layout,
                                     const RasterWriterOptions& options) {
  std::vector<std::string> names = {name};
  if (layout.crs.empty()) names.push_back(WorldFileOf(name).generic_string());
  if (!NeedsBlocks(layout, options)) return names;
  for (const auto& block : BlockPaths(name, layout, options.max_block_side)) {
    names.push_back(block.generic_string());
  }
  names.push_back(BlockIndexPath(name).generic_string());
  return names;
}

}  // namespace colmap_seapoint
