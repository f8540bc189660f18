#include <cstring>
#include <new>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kHeaderBytes = 30;

uint64_t LittleEndian(const uint8_t* bytes, int count) {
  uint64_t value = 0;
  for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[i];
  return value;
}

// The sides stand in the first chunk: "VP8 " (a key frame of a film), "VP8L" (without loss), or
// "VP8X" (with transparency, EXIF and so on, before one of the others).
ImageHeader CheckHeader(const ImageSource& source) {
  uint8_t head[kHeaderBytes];
  // OpenCV fills up what a truncated file lacks, or prints; so the length is checked before.
  if (std::fread(head, 1, sizeof(head), source.file.get()) != sizeof(head) ||
      source.size - 8 < LittleEndian(head + 4, 4)) {
    ThrowDamagedImage(source.path, "the file ends too early");
  }
  const std::string chunk(head + 12, head + 16);
  const uint8_t* data = head + 20;
  uint64_t width = 0, height = 0;
  if (chunk == "VP8X") {
    width = LittleEndian(data + 4, 3) + 1;
    height = LittleEndian(data + 7, 3) + 1;
  } else if (chunk == "VP8L") {
    const uint64_t bits = LittleEndian(data + 1, 4);
    width = (bits & 0x3fff) + 1;
    height = (bits >> 14 & 0x3fff) + 1;
  } else if (chunk == "VP8 ") {
    width = LittleEndian(data + 6, 2) & 0x3fff;
    height = LittleEndian(data + 8, 2) & 0x3fff;
  }
  ImageHeader header;
  header.size = CheckImageSize(source.path, width, height);
  header.packing = Packing::kWebp;
  header.unpacked_bytes = width * height;
  header.bytes_per_pixel += 10;  // libwebp's and OpenCV's copies
  return header;
}

}  // namespace

ImageHeader ReadWebpHeader(const ImageSource& source) { return CheckHeader(source); }

// By OpenCV, which has libwebp.
Image<uint8_t> DecodeWebp(const ImageSource& source) {
  static const bool is_silent = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  static_cast<void>(is_silent);
  const ImageHeader header = CheckHeader(source);
  const MemoryShare share(BytesToDecode(source, header));
  const std::vector<uint8_t> file = ReadAll(source);
  cv::Mat decoded;
  try {
    // Unchanged: the orientation is ignored too.
    decoded = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    if (decoded.empty()) ThrowDamagedImage(source.path, "OpenCV cannot decode it");
    if (decoded.cols != header.size.width || decoded.rows != header.size.height) {
      ThrowDamagedImage(source.path, "its header and its pixels are of different sizes");
    }
    if (decoded.depth() == CV_16U) decoded.convertTo(decoded, CV_8U, 1.0 / 257.0);
    if (decoded.depth() != CV_8U)
      ThrowDamagedImage(source.path, "its pixels are not of 8 or 16 bits");
    if (decoded.channels() == 3) cv::cvtColor(decoded, decoded, cv::COLOR_BGR2RGB);
    if (decoded.channels() == 4) cv::cvtColor(decoded, decoded, cv::COLOR_BGRA2RGB);
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    ThrowDamagedImage(source.path, "OpenCV cannot decode it");
  }
  Image<uint8_t> image(decoded.cols, decoded.rows, decoded.channels());
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(image.Row(y), decoded.ptr(y), image.Stride());
  }
  return image;
}

}  // namespace colmap_seapoint
