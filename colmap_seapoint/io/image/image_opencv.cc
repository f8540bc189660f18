#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap_seapoint/io/image/image_codecs.h"

namespace colmap_seapoint {
namespace {

uint64_t LittleEndian(const uint8_t* bytes, int count) {
  uint64_t value = 0;
  for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[i];
  return value;
}

uint64_t BigEndian(const uint8_t* bytes, int count) {
  uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

// OpenCV fills up what a truncated file lacks, or prints; so the length is checked before.
bool IsWholeWebp(const std::vector<uint8_t>& file) {
  return file.size() >= 20 && file.size() - 8 >= LittleEndian(&file[4], 4);
}

// Every box lies inside the file, and the code stream has its end marker.
bool IsWholeJp2(const std::vector<uint8_t>& file) {
  constexpr uint8_t kEndOfCodestream[] = {0xff, 0xd9};
  uint64_t at = 0;
  bool has_stream = false;
  while (at + 8 <= file.size()) {
    uint64_t length = BigEndian(&file[at], 4);
    uint64_t header = 8;
    if (length == 1 && at + 16 <= file.size()) {
      length = BigEndian(&file[at + 8], 8);
      header = 16;
    }
    if (length == 0) length = file.size() - at;
    if (length < header || length > file.size() - at) return false;
    if (std::memcmp(&file[at + 4], "jp2c", 4) == 0) {
      if (length < header + 2) return false;
      has_stream = std::memcmp(&file[at + length - 2], kEndOfCodestream, 2) == 0;
    }
    at += length;
  }
  return has_stream;
}

bool IsWhole(const std::vector<uint8_t>& file, ImageFormat format) {
  if (format == ImageFormat::kWebp) return IsWholeWebp(file);
  return IsWholeJp2(file);
}

}  // namespace

Image<uint8_t> DecodeWithOpenCv(const ImageSource& source, ImageFormat format) {
  static const bool is_silent = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  static_cast<void>(is_silent);
  const std::vector<uint8_t> file = ReadAll(source);
  if (!IsWhole(file, format)) ThrowDamagedImage(source.path, "the file ends too early");
  cv::Mat decoded;
  try {
    // Unchanged: the orientation is ignored too.
    decoded = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    if (decoded.empty()) ThrowDamagedImage(source.path, "OpenCV cannot decode it");
    CheckImageSize(source.path, static_cast<uint64_t>(decoded.cols),
                   static_cast<uint64_t>(decoded.rows));
    if (decoded.depth() == CV_16U) decoded.convertTo(decoded, CV_8U, 1.0 / 257.0);
    if (decoded.depth() != CV_8U)
      ThrowDamagedImage(source.path, "its pixels are not of 8 or 16 bits");
    if (decoded.channels() == 3) cv::cvtColor(decoded, decoded, cv::COLOR_BGR2RGB);
    if (decoded.channels() == 4) cv::cvtColor(decoded, decoded, cv::COLOR_BGRA2RGB);
  } catch (const cv::Exception&) {
    ThrowDamagedImage(source.path, "OpenCV cannot decode it");
  }
  Image<uint8_t> image(decoded.cols, decoded.rows, decoded.channels());
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(image.Row(y), decoded.ptr(y), image.Stride());
  }
  return image;
}

}  // namespace colmap_seapoint
