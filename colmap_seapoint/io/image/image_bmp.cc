#include <algorithm>
#include <array>
#include <cstdlib>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kHeaderBytes = 54;  // file header and BITMAPINFOHEADER
constexpr uint32_t kUncompressed = 0;
constexpr uint32_t kBitFields = 3;  // of 32 bits: taken as blue, green, red, unused

// What cameras and scanners write: uncompressed, 8 bits with a palette, 24 or 32 bits.
struct BmpHeader {
  ImageSize size;
  bool is_top_down = false;
  uint32_t bits = 0;
  uint64_t pixel_offset = 0;
  uint64_t palette_offset = 0;
  uint32_t num_colors = 0;

  uint64_t RowBytes() const { return (static_cast<uint64_t>(size.width) * bits + 31) / 32 * 4; }
};

uint32_t LittleEndian(const uint8_t* bytes, int count) {
  uint32_t value = 0;
  for (int i = count - 1; i >= 0; --i) value = value << 8 | bytes[i];
  return value;
}

BmpHeader ReadHeader(const std::filesystem::path& path, std::FILE* file) {
  uint8_t head[kHeaderBytes];
  if (std::fread(head, 1, sizeof(head), file) != sizeof(head)) {
    ThrowDamagedImage(path, "the file ends too early");
  }
  BmpHeader header;
  header.pixel_offset = LittleEndian(head + 10, 4);
  const uint32_t info_bytes = LittleEndian(head + 14, 4);
  const auto width = static_cast<int32_t>(LittleEndian(head + 18, 4));
  const auto height = static_cast<int32_t>(LittleEndian(head + 22, 4));
  header.bits = LittleEndian(head + 28, 2);
  const uint32_t compression = LittleEndian(head + 30, 4);
  header.num_colors = LittleEndian(head + 46, 4);
  if (header.num_colors == 0) header.num_colors = 256;
  header.palette_offset = 14 + static_cast<uint64_t>(info_bytes);
  header.is_top_down = height < 0;
  const bool is_known =
      compression == kUncompressed || (compression == kBitFields && header.bits == 32);
  if (info_bytes < 40 || info_bytes > 4096 || !is_known || width < 0 ||
      (header.bits != 8 && header.bits != 24 && header.bits != 32) || header.num_colors > 256) {
    ThrowDamagedImage(path, "only uncompressed BMP of 8, 24 or 32 bits can be read");
  }
  header.size = CheckImageSize(path, static_cast<uint64_t>(width),
                               static_cast<uint64_t>(std::abs(static_cast<int64_t>(height))));
  return header;
}

ImageHeader Promise(const BmpHeader& header) {
  ImageHeader promise;
  promise.size = header.size;
  promise.unpacked_bytes = header.RowBytes() * static_cast<uint64_t>(header.size.height);
  promise.more_bytes = promise.unpacked_bytes;  // the file once more
  return promise;
}

// Blue, green, red, unused of each value.
std::array<uint8_t, 4 * 256> Palette(const std::filesystem::path& path, const BmpHeader& header,
                                     const std::vector<uint8_t>& file) {
  std::array<uint8_t, 4 * 256> palette{};
  if (header.palette_offset + 4ull * header.num_colors > file.size()) {
    ThrowDamagedImage(path, "its palette lies outside the file");
  }
  std::copy_n(file.begin() + static_cast<std::ptrdiff_t>(header.palette_offset),
              4 * header.num_colors, palette.begin());
  return palette;
}

}  // namespace

ImageHeader ReadBmpHeader(const ImageSource& source) {
  return Promise(ReadHeader(source.path, source.file.get()));
}

Image<uint8_t> DecodeBmp(const ImageSource& source) {
  const BmpHeader header = ReadHeader(source.path, source.file.get());
  const MemoryShare share(BytesToDecode(source, Promise(header)));
  const std::vector<uint8_t> file = ReadAll(source);
  const auto num_rows = static_cast<uint64_t>(header.size.height);
  if (header.pixel_offset < kHeaderBytes || header.pixel_offset > file.size() ||
      (file.size() - header.pixel_offset) / header.RowBytes() < num_rows) {
    ThrowDamagedImage(source.path, "the file ends too early");
  }
  std::array<uint8_t, 4 * 256> palette{};
  if (header.bits == 8) palette = Palette(source.path, header, file);
  Image<uint8_t> image(header.size.width, header.size.height, 3);
  for (int y = 0; y < image.height; ++y) {
    const auto stored_row = static_cast<uint64_t>(header.is_top_down ? y : image.height - 1 - y);
    const uint8_t* in = file.data() + header.pixel_offset + stored_row * header.RowBytes();
    uint8_t* out = image.Row(y);
    for (int x = 0; x < image.width; ++x, in += header.bits / 8, out += 3) {
      const uint8_t* bgr = header.bits == 8 ? &palette[4u * *in] : in;
      out[0] = bgr[2];
      out[1] = bgr[1];
      out[2] = bgr[0];
    }
  }
  return image;
}

}  // namespace colmap_seapoint
