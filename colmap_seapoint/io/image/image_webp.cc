#include <webp/decode.h>

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
  // Decoders may fill up what a truncated file lacks; so the length is checked before.
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
  header.bytes_per_pixel += 6;  // libwebp's own copies
  return header;
}

}  // namespace

ImageHeader ReadWebpHeader(const ImageSource& source) { return CheckHeader(source); }

// By libwebp itself: what OpenCV takes for no WebP it hands on to libraries of other formats
// (DICOM, GDAL), which print, and some of whose formats name other files.
Image<uint8_t> DecodeWebp(const ImageSource& source) {
  const ImageHeader header = CheckHeader(source);
  const MemoryShare share(BytesToDecode(source, header));
  const std::vector<uint8_t> file = ReadAll(source);
  int width = 0, height = 0;
  if (WebPGetInfo(file.data(), file.size(), &width, &height) == 0) {
    ThrowDamagedImage(source.path, "libwebp cannot decode it");
  }
  if (width != header.size.width || height != header.size.height) {
    ThrowDamagedImage(source.path, "its header and its pixels are of different sizes");
  }
  Image<uint8_t> image(width, height, 3);
  if (WebPDecodeRGBInto(file.data(), file.size(), image.data.data(), image.data.size(),
                        static_cast<int>(image.Stride())) == nullptr) {
    ThrowDamagedImage(source.path, "libwebp cannot decode it");
  }
  return image;
}

}  // namespace colmap_seapoint
