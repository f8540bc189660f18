// HEIC and DNG as phones and cameras write them, made by libheif and libtiff.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// With EXIF: make "TestMaker" and a focal length of 28 mm (35 mm equivalent). False when this
// libheif has no encoder.
bool WriteHeic(const std::filesystem::path& path, const GrayImage& image);

// Uncompressed Bayer pattern of a grey picture, 16 bits, of even sides. Make as above.
void WriteDng(const std::filesystem::path& path, const GrayImage& image);

}  // namespace colmap_seapoint
