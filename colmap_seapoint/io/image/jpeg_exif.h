// Pictures that we make ourselves, with what EXIF tells about them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// A TIFF structure, as EXIF stands in files; empty: there is none.
using ExifBlock = std::vector<uint8_t>;

// EXIF of a picture that was taken at a time (microseconds since 1970, as the camera's clock said).
// Empty when nothing is known.
ExifBlock MakeExif(std::optional<int64_t> time_us, const std::string& maker,
                   const std::string& model);

// What a picture's block, or its file (any format that Exiv2 reads, RAW among them), tells of the
// camera, the time and the place, without previews and makers' notes. Empty for what cannot be
// read.
ExifBlock CleanExif(const ExifBlock& block);
ExifBlock CleanExifOf(const std::filesystem::path& path);

// A JPEG of quality 95 with this EXIF; atomic.
void WriteJpeg(const std::filesystem::path& path, const ColorImage& image, const ExifBlock& exif);

}  // namespace colmap_seapoint
