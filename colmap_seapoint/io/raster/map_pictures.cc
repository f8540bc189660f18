#include "colmap_seapoint/io/raster/map_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/jpeg_exif.h"
#include "colmap_seapoint/io/image/png_rows.h"
#include "colmap_seapoint/io/raster/raster_reader.h"
#include "colmap_seapoint/io/raster/world_file.h"

namespace colmap_seapoint {
namespace {

constexpr int kStripRows = 256;
constexpr int kWhite = 255;

// Rows first - 1 .. first + count of the map, as far as there are such.
class Strip {
 public:
  Strip(const RasterReader& dem, int first, int count)
      : start_(std::max(0, first - 1)),
        rows_(dem.ReadHeights(start_, std::min(dem.Layout().height, first + count + 1) - start_)) {}

  // nullptr beyond the map.
  const float* Row(int y) const {
    return y < start_ || y >= start_ + rows_.height ? nullptr : rows_.Row(y - start_);
  }

 private:
  int start_;
  FloatImage rows_;
};

int SideOf(int side, int longer, int max_side) {
  if (longer <= max_side) return side;
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(side) * max_side / longer)));
}

ColorImage OnWhite(const Image<uint8_t>& rgba) {
  ColorImage result(rgba.width, rgba.height, 3);
  const size_t num_pixels = static_cast<size_t>(rgba.width) * static_cast<size_t>(rgba.height);
  for (size_t i = 0; i < num_pixels; ++i) {
    const int alpha = rgba.data[4 * i + 3];
    for (size_t c = 0; c < 3; ++c) {
      const int color = rgba.data[4 * i + c];
      result.data[3 * i + c] =
          static_cast<uint8_t>((color * alpha + kWhite * (255 - alpha) + 127) / 255);
    }
  }
  return result;
}

void RequireBands(const std::filesystem::path& path, const RasterReader& map, RasterBands bands,
                  const std::string& what) {
  if (map.Layout().bands == bands) return;
  throw Error(path.string(), "holds no " + what, "give the map that does");
}

}  // namespace

void WriteHillshade(const std::filesystem::path& dem, const std::filesystem::path& png,
                    int max_side, const HillshadeLight& light) {
  const RasterReader heights(dem, max_side);
  RequireBands(dem, heights, RasterBands::kFloat32, "heights");
  const RasterLayout& layout = heights.Layout();
  PngRows picture(png, layout.width, layout.height, PngColors::kGrayAlpha);
  std::vector<uint8_t> shades(2 * static_cast<size_t>(layout.width));
  for (int first = 0; first < layout.height; first += kStripRows) {
    const int count = std::min(kStripRows, layout.height - first);
    const Strip strip(heights, first, count);
    for (int y = first; y < first + count; ++y) {
      ShadeRow(strip.Row(y - 1), strip.Row(y), strip.Row(y + 1), layout.width, layout.pixel_size,
               light, shades.data());
      picture.Write(shades.data());
    }
  }
  picture.Finish();
  WriteWorldFile(png, layout);
}

void WritePreview(const std::filesystem::path& map, const std::filesystem::path& jpeg,
                  int max_side) {
  const RasterReader colors(map);
  RequireBands(map, colors, RasterBands::kRgba8, "colours");
  RasterLayout layout = colors.Layout();
  const int longer = std::max(layout.width, layout.height);
  const int width = SideOf(layout.width, longer, max_side);
  const int height = SideOf(layout.height, longer, max_side);
  WriteJpeg(jpeg, OnWhite(colors.ReadColors(width, height)), {});
  layout.pixel_size *= static_cast<double>(longer) / std::max(width, height);
  WriteWorldFile(jpeg, layout);
}

std::vector<std::string> MapPictureFiles(const std::string& name) {
  return {name, WorldFileOf(name).generic_string()};
}

}  // namespace colmap_seapoint
