// Pictures as phones and cameras store them that COLMAP does not read: HEIC (libheif) and RAW
// (libraw: DNG, NEF, CR2, CR3, ARW, ORF, RW2, RAF, PEF, SRW; GPR where it is not compressed).
#pragma once

#include <cstdint>
#include <filesystem>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/image/jpeg_exif.h"

namespace colmap_seapoint {

struct CameraPicture {
  ColorImage pixels;
  ExifBlock exif;  // what is worth keeping; its orientation tells how the pixels are turned
};

// The pixels are as the sensor has them, whatever way the camera was held, so that all pictures of
// a camera share a size and a lens. RAW is developed with the camera's white balance and one
// brightness for all pictures. Throws Error for a file that cannot be read, is damaged, or that
// this libheif or libraw has no codec for. Cost: about 0.2 CPU s for HEIC and 2 s for RAW at 12
// megapixels; memory about 20 bytes a pixel.
CameraPicture ReadCameraPicture(const std::filesystem::path& path);

}  // namespace colmap_seapoint
