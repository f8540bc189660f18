// Tiny videos of a known motion, made by libav itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct VideoSpec {
  double seconds_per_frame = 1.0 / 30;
  std::vector<double> times;   // of the frames, seconds; empty = seconds_per_frame apart
  int rotation_deg = 0;        // clockwise, that makes it upright
  bool is_interlaced = false;  // said to be
  bool is_10_bit = false;      // FFV1 instead of MPEG-4; .mkv only
  std::string creation_time;   // ISO 8601; empty = none
};

// The container is that of the extension (mp4, mkv). `frame` draws number i, all of one even size.
void WriteVideo(const std::filesystem::path& path, const VideoSpec& spec, int num_frames,
                const std::function<GrayImage(int i)>& frame);

// One second of silence, and no picture.
void WriteSound(const std::filesystem::path& path);

// A seabed of `width` x `height` pixels, with structure of all sizes.
GrayImage MakeSeabed(int width, int height, uint32_t seed);

// The part of it from (left, top) on, which may lie between pixels; `blur` is the length in pixels
// of a smear along x.
GrayImage Crop(const GrayImage& seabed, double left, double top, int width, int height,
               int blur = 0);

}  // namespace colmap_seapoint
