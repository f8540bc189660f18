// Whether a picture is worth decoding, decided from its header alone: a file of some hundred bytes
// can promise gigabytes. For image_*.cc only.
#pragma once

#include <cstdint>

#include "colmap_seapoint/io/image/image_codecs.h"

namespace colmap_seapoint {

// More scans than any encoder writes for a progressive JPEG (cameras 1, libjpeg 10, the optimisers
// about 20): each takes a pass over all pixels, however few bytes it has.
inline constexpr int kMaxJpegScans = 64;

// The memory that decoding takes, in bytes. Throws Error, and nothing is allocated yet, when
// - a side or the number of pixels is beyond what is decoded at all,
// - the file is too short for what its header promises, even packed as tightly as its format can,
// - it takes more than MaxMemory().
uint64_t BytesToDecode(const ImageSource& source, const ImageHeader& header);

}  // namespace colmap_seapoint
