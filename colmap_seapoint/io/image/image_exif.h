// Reads what EXIF tells about the camera and its place. For image_file.cc and jpeg_exif.cc only.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>

#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/io/image/exif_camera.h"
#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {

struct ExifInfo {
  ExifCamera camera;
  int orientation = 1;
  std::optional<GeoPosition> gps;
  CaptureHeights heights;
  std::string taken;
};

// Exiv2, set up and silent, for as long as this is held: its XMP parser and its caches are shared
// by the process.
std::unique_lock<std::mutex> HoldExiv2();

// Pictures without EXIF, or with EXIF that cannot be read, give the defaults. Never prints; may be
// called from several threads.
ExifInfo ReadExif(const std::filesystem::path& path);

}  // namespace colmap_seapoint
