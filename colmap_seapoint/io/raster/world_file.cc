#include "colmap_seapoint/io/raster/world_file.h"

#include <cstdio>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {

std::filesystem::path WorldFileOf(const std::filesystem::path& picture) {
  const std::string extension = picture.extension().string();
  SEAPOINT_CHECK(extension.size() >= 3);
  std::filesystem::path path = picture;
  return path.replace_extension(std::string{'.', extension[1], extension.back(), 'w'});
}

// Its place is that of the first pixel's centre.
void WriteWorldFile(const std::filesystem::path& picture, const RasterLayout& layout) {
  const double size = layout.pixel_size;
  char text[256];
  std::snprintf(text, sizeof(text), "%.15g\n0\n0\n%.15g\n%.15g\n%.15g\n", size, -size,
                layout.min_x + 0.5 * size, layout.max_y - 0.5 * size);
  WriteTextFile(WorldFileOf(picture), text);
}

}  // namespace colmap_seapoint
