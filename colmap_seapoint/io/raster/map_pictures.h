// Maps as pictures that any program shows: the relief shaded, the colours as a small JPEG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/raster/hillshade.h"

namespace colmap_seapoint {

// Programs that show pictures open no PNG with longer sides in reasonable time.
inline constexpr int kMaxHillshadeSide = 8192;
inline constexpr int kMaxPreviewSide = 4000;

// The heights of `dem` (raster_writer.h) shaded, as a PNG in grey, transparent where there are
// none; of a dem with longer sides than max_side, its first overview that has none. With a world
// file. Memory: some 256 rows. Atomic. Throws Error.
void WriteHillshade(const std::filesystem::path& dem, const std::filesystem::path& png,
                    int max_side = kMaxHillshadeSide, const HillshadeLight& light = {});

// The colours of `map`, an RGBA raster of ours, as a JPEG of at most max_side pixels a side, white
// where nothing is. With a world file. Memory: seven bytes a pixel of the preview. Atomic. Throws
// Error.
void WritePreview(const std::filesystem::path& map, const std::filesystem::path& jpeg,
                  int max_side = kMaxPreviewSide);

// The names of what either of them makes.
std::vector<std::string> MapPictureFiles(const std::string& name);

}  // namespace colmap_seapoint
