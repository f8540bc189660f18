// One decoder for each format, over the format's own library where it has one: only there can
// "damaged" be told from "fine", and warnings be kept off stderr without a switch for the whole
// process. For image_*.cc only.
//
// OpenImageIO (2.4.7, Debian 12) was tried for PNG, TIFF, BMP and PNM and does not pass
// image_damage_test.cc: it takes a PNG for whole whose last 1 to 12 bytes are missing (IEND), and
// prints "libpng error: ..." to stderr for damaged ones. It would also add 100 MB of packages.
//
// All functions throw Error for files that cannot be read or decoded whole. Decoders return 1 or 3
// channels, 8 bits, rows as they are stored. A source is read from its start to where the function
// needs it, once: open another one for another function.
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

// A picture to read from: the file, where only its header is wanted, or its bytes in memory.
using FileHandle = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
struct ImageSource {
  std::filesystem::path path;  // errors name it
  FileHandle file;
  uint64_t size = 0;  // bytes
};
ImageSource OpenImageFile(const std::filesystem::path& path);
// `bytes` must outlive the source.
ImageSource OpenImageBytes(const std::filesystem::path& path, const std::vector<uint8_t>& bytes);

enum class ImageFormat { kJpeg, kPng, kTiff, kPnm, kBmp, kWebp };

// From the first bytes, never from the name; leaves the source at its start. Throws Error for
// empty and unknown files, and for what no camera writes but a few bytes of which can unfold into
// gigabytes (JPEG 2000).
ImageFormat DetectImageFormat(const ImageSource& source);

// How the pixels are packed in the file.
enum class Packing { kNone, kPackBits, kLzw, kDeflate, kJpeg, kWebp };

// What a header promises.
struct ImageHeader {
  ImageSize size;
  Packing packing = Packing::kNone;
  uint64_t unpacked_bytes = 0;   // of all samples, as they are stored
  uint64_t bytes_per_pixel = 6;  // that decoding takes: three channels, and the planes of them
  uint64_t more_bytes = 0;       // that the format's library takes beside that
};

ImageHeader ReadJpegHeader(const ImageSource& source);
ImageHeader ReadPngHeader(const ImageSource& source);
ImageHeader ReadTiffHeader(const ImageSource& source);
ImageHeader ReadPnmHeader(const ImageSource& source);
ImageHeader ReadBmpHeader(const ImageSource& source);
ImageHeader ReadWebpHeader(const ImageSource& source);

// What to decode: kLuma leaves the chroma out where the file holds luma apart, and gives the same
// luma as kPlanes. Where the file does not hold luma and chroma (CMYK, RGB), or chroma in a grid
// that Picture does not know, both give the planes of its red, green and blue.
enum class JpegContent { kLuma, kPlanes };
Picture DecodeJpegPlanes(const ImageSource& source, JpegContent content);
Image<uint8_t> DecodeJpeg(const ImageSource& source);
Image<uint8_t> DecodePng(const ImageSource& source);
Image<uint8_t> DecodeTiff(const ImageSource& source);
Image<uint8_t> DecodePnm(const ImageSource& source);
Image<uint8_t> DecodeBmp(const ImageSource& source);
Image<uint8_t> DecodeWebp(const ImageSource& source);

// Shared by the decoders.
std::vector<uint8_t> ReadAll(const ImageSource& source);
// `finding` may be what a library said: where that is about memory, std::bad_alloc is thrown, since
// nothing is wrong with the picture then.
[[noreturn]] void ThrowDamagedImage(const std::filesystem::path& path, const std::string& finding);
// Throws Error when the sides or their product are beyond what we decode.
ImageSize CheckImageSize(const std::filesystem::path& path, uint64_t width, uint64_t height);

}  // namespace colmap_seapoint
