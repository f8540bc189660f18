// One decoder for each format, over the format's own library where it has one: only there can
// "damaged" be told from "fine", and warnings be kept off stderr without a switch for the whole
// process. For image_*.cc only.
//
// All functions throw Error for files that cannot be read or decoded whole. Decoders return 1 or 3
// channels, 8 bits, rows as they are stored.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/picture.h"

namespace colmap_seapoint {

struct ImageSize {
  int width = 0;
  int height = 0;
};

enum class ImageFormat { kJpeg, kPng, kTiff, kPnm, kBmp, kWebp, kJp2 };

// From the first bytes, never from the name. Throws Error for empty and unknown files.
ImageFormat DetectImageFormat(const std::filesystem::path& path);

// Size from the header.
ImageSize ReadJpegSize(const std::filesystem::path& path);
ImageSize ReadPngSize(const std::filesystem::path& path);
ImageSize ReadTiffSize(const std::filesystem::path& path);
ImageSize ReadPnmSize(const std::filesystem::path& path);
ImageSize ReadBmpSize(const std::filesystem::path& path);

// As what: kLuma decodes no chroma where the file holds luma apart; the same luma as kPlanes. Where
// the file does not hold luma and chroma (CMYK, RGB), or chroma in a grid that Picture does not
// know, both give the planes of its red, green and blue.
enum class JpegContent { kLuma, kPlanes };
Picture DecodeJpegPlanes(const std::filesystem::path& path, JpegContent content);
Image<uint8_t> DecodeJpeg(const std::filesystem::path& path);
Image<uint8_t> DecodePng(const std::filesystem::path& path);
Image<uint8_t> DecodeTiff(const std::filesystem::path& path);
Image<uint8_t> DecodePnm(const std::filesystem::path& path);
Image<uint8_t> DecodeBmp(const std::filesystem::path& path);
// WebP and JPEG 2000, by OpenCV.
Image<uint8_t> DecodeWithOpenCv(const std::filesystem::path& path, ImageFormat format);

// Shared by the decoders.
using FileHandle = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
FileHandle OpenImageFile(const std::filesystem::path& path);
std::vector<uint8_t> ReadWholeFile(const std::filesystem::path& path);
[[noreturn]] void ThrowDamagedImage(const std::filesystem::path& path, const std::string& finding);
// Throws Error when the sides or their product are beyond what we decode.
ImageSize CheckImageSize(const std::filesystem::path& path, uint64_t width, uint64_t height);

}  // namespace colmap_seapoint
