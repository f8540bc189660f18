#include "colmap_seapoint/io/raster/raster_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/raster/gdal_session.h"

namespace colmap_seapoint {
namespace {

constexpr int kColors = 4;

RasterBands BandsOf(const std::filesystem::path& path, GDALDatasetH dataset) {
  const int count = GDALGetRasterCount(dataset);
  const GDALDataType type = GDALGetRasterDataType(GDALGetRasterBand(dataset, 1));
  if (count == kColors && type == GDT_Byte) return RasterBands::kRgba8;
  if (count == 1 && type == GDT_Float32) return RasterBands::kFloat32;
  if (count == 1 && type == GDT_Byte) return RasterBands::kUint8;
  if (count == 1 && type == GDT_UInt16) return RasterBands::kUint16;
  if (count == 1 && type == GDT_UInt32) return RasterBands::kUint32;
  throw Error(path.string(), "is none of our maps: its bands are of another kind",
              "give one that colmap_seapoint wrote");
}

// The first band at full size, or that of an overview.
GDALRasterBandH BandOf(GDALDatasetH dataset, int max_side) {
  const GDALRasterBandH full = GDALGetRasterBand(dataset, 1);
  GDALRasterBandH band = full;
  for (int i = 0; max_side > 0 && i < GDALGetOverviewCount(full); ++i) {
    if (std::max(GDALGetRasterBandXSize(band), GDALGetRasterBandYSize(band)) <= max_side) break;
    band = GDALGetOverview(full, i);
  }
  return band;
}

}  // namespace

struct RasterReader::Impl {
  template <typename T>
  void ReadWindow(int x, int y, GDALDataType type, Image<T>* window) const {
    const int left = std::max(x, 0), top = std::max(y, 0);
    const int width = std::min(x + window->width, layout.width) - left;
    const int height = std::min(y + window->height, layout.height) - top;
    if (width <= 0 || height <= 0) return;
    SEAPOINT_CHECK(GDALGetRasterCount(dataset.get()) == window->channels);
    T* first = window->Row(top - y) + (left - x) * window->channels;
    const int pixel = window->channels * static_cast<int>(sizeof(T));
    const GdalSession session(path);
    session.Check(GDALDatasetRasterIO(dataset.get(), GF_Read, left, top, width, height, first,
                                      width, height, type, window->channels, nullptr, pixel,
                                      pixel * window->width, sizeof(T)) == CE_None);
  }

  std::filesystem::path path;
  GdalDataset dataset;
  GDALRasterBandH band = nullptr;
  RasterLayout layout;
};

RasterReader::RasterReader(const std::filesystem::path& path, int max_side)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  const GdalSession session(path);
  constexpr const char* kDrivers[] = {"GTiff", nullptr};
  impl_->dataset.reset(
      GDALOpenEx(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, kDrivers, nullptr, nullptr));
  GDALDatasetH dataset = impl_->dataset.get();
  session.Check(dataset != nullptr);
  RasterLayout& layout = impl_->layout;
  layout.bands = BandsOf(path, dataset);
  impl_->band = BandOf(dataset, max_side);
  layout.width = GDALGetRasterBandXSize(impl_->band);
  layout.height = GDALGetRasterBandYSize(impl_->band);
  double transform[6] = {0, 1, 0, 0, 0, -1};
  GDALGetGeoTransform(dataset, transform);
  layout.min_x = transform[0];
  layout.max_y = transform[3];
  // By the longer side, whose rounding weighs less.
  layout.pixel_size = transform[1] *
                      std::max(GDALGetRasterXSize(dataset), GDALGetRasterYSize(dataset)) /
                      std::max(layout.width, layout.height);
  layout.crs = GDALGetProjectionRef(dataset);
  layout.unit = GDALGetRasterUnitType(GDALGetRasterBand(dataset, 1));
  int has_nodata = 0;
  const double nodata = GDALGetRasterNoDataValue(GDALGetRasterBand(dataset, 1), &has_nodata);
  if (has_nodata != 0) layout.nodata = nodata;
}

RasterReader::~RasterReader() = default;

const RasterLayout& RasterReader::Layout() const { return impl_->layout; }

FloatImage RasterReader::ReadHeights(int first, int count) const {
  const RasterLayout& layout = impl_->layout;
  SEAPOINT_CHECK(first >= 0 && count > 0 && count <= layout.height - first);
  FloatImage rows(layout.width, count);
  const GdalSession session(impl_->path);
  session.Check(GDALRasterIO(impl_->band, GF_Read, 0, first, layout.width, count, rows.data.data(),
                             layout.width, count, GDT_Float32, 0, 0) == CE_None);
  if (layout.nodata) {
    std::replace(rows.data.begin(), rows.data.end(), static_cast<float>(*layout.nodata),
                 std::numeric_limits<float>::quiet_NaN());
  }
  return rows;
}

void RasterReader::ReadWindow(int x, int y, Image<float>* window) const {
  impl_->ReadWindow(x, y, GDT_Float32, window);
}
void RasterReader::ReadWindow(int x, int y, Image<uint8_t>* window) const {
  impl_->ReadWindow(x, y, GDT_Byte, window);
}
void RasterReader::ReadWindow(int x, int y, Image<uint16_t>* window) const {
  impl_->ReadWindow(x, y, GDT_UInt16, window);
}
void RasterReader::ReadWindow(int x, int y, Image<uint32_t>* window) const {
  impl_->ReadWindow(x, y, GDT_UInt32, window);
}

Image<uint8_t> RasterReader::ReadColors(int width, int height) const {
  SEAPOINT_CHECK(impl_->layout.bands == RasterBands::kRgba8);
  GDALDatasetH dataset = impl_->dataset.get();
  Image<uint8_t> colors(width, height, kColors);
  const GdalSession session(impl_->path);
  GDALRasterIOExtraArg how;
  INIT_RASTERIO_EXTRA_ARG(how);
  how.eResampleAlg = GRIORA_Average;
  session.Check(GDALDatasetRasterIOEx(dataset, GF_Read, 0, 0, GDALGetRasterXSize(dataset),
                                      GDALGetRasterYSize(dataset), colors.data.data(), width,
                                      height, GDT_Byte, kColors, nullptr, kColors, kColors * width,
                                      1, &how) == CE_None);
  return colors;
}

}  // namespace colmap_seapoint
