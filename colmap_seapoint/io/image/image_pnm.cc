#include <cctype>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

// P2 P3 (ASCII) and P5 P6 (binary) with up to 16 bits; bitmaps (P1, P4) are no pictures.
struct PnmHeader {
  bool is_ascii = false;
  int channels = 1;
  ImageSize size;
  uint32_t max_value = 255;

  size_t SampleBytes() const { return max_value > 255 ? 2 : 1; }
};

// The next number, after blanks and comments.
uint32_t ReadNumber(const std::filesystem::path& path, std::FILE* file) {
  int c = std::fgetc(file);
  while (std::isspace(c) || c == '#') {
    if (c == '#') {
      while (c != '\n' && c != EOF) c = std::fgetc(file);
    }
    c = std::fgetc(file);
  }
  if (c == EOF) ThrowDamagedImage(path, "the file ends too early");
  uint32_t value = 0;
  int num_digits = 0;
  for (; std::isdigit(c) && num_digits < 9; ++num_digits, c = std::fgetc(file)) {
    value = value * 10 + static_cast<uint32_t>(c - '0');
  }
  if (num_digits == 0 || (c != EOF && !std::isspace(c))) {
    ThrowDamagedImage(path, "a number was expected");
  }
  return value;  // and one blank after it is gone, as the format wants it
}

PnmHeader ReadHeader(const std::filesystem::path& path, std::FILE* file) {
  PnmHeader header;
  std::fgetc(file);
  const int kind = std::fgetc(file);
  header.is_ascii = kind == '2' || kind == '3';
  header.channels = kind == '3' || kind == '6' ? 3 : 1;
  if (kind != '2' && kind != '3' && kind != '5' && kind != '6') {
    ThrowDamagedImage(path, "only P2, P3, P5 and P6 can be read");
  }
  const uint32_t width = ReadNumber(path, file);
  const uint32_t height = ReadNumber(path, file);
  header.size = CheckImageSize(path, width, height);
  header.max_value = ReadNumber(path, file);
  if (header.max_value == 0 || header.max_value > 65535) {
    ThrowDamagedImage(path, "its maximal value is not in 1..65535");
  }
  return header;
}

ImageHeader Promise(const PnmHeader& header) {
  ImageHeader promise;
  promise.size = header.size;
  promise.unpacked_bytes = static_cast<uint64_t>(header.size.width) *
                           static_cast<uint64_t>(header.size.height) *
                           static_cast<uint64_t>(header.channels) * header.SampleBytes();
  return promise;
}

}  // namespace

ImageHeader ReadPnmHeader(const ImageSource& source) {
  return Promise(ReadHeader(source.path, source.file.get()));
}

Image<uint8_t> DecodePnm(const ImageSource& source) {
  const PnmHeader header = ReadHeader(source.path, source.file.get());
  const MemoryShare share(BytesToDecode(source, Promise(header)));
  const size_t sample_bytes = header.SampleBytes();
  Image<uint8_t> image(header.size.width, header.size.height, header.channels);
  std::vector<uint8_t> row(image.Stride() * sample_bytes);
  for (int y = 0; y < image.height; ++y) {
    if (!header.is_ascii &&
        std::fread(row.data(), 1, row.size(), source.file.get()) != row.size()) {
      ThrowDamagedImage(source.path, "the file ends too early");
    }
    for (size_t i = 0; i < image.Stride(); ++i) {
      const uint32_t value = header.is_ascii ? ReadNumber(source.path, source.file.get())
                             : sample_bytes == 1
                                 ? row[i]
                                 : static_cast<uint32_t>(row[2 * i]) * 256u + row[2 * i + 1];
      if (value > header.max_value) ThrowDamagedImage(source.path, "a value is above its maximum");
      image.Row(y)[i] =
          static_cast<uint8_t>((value * 255u + header.max_value / 2) / header.max_value);
    }
  }
  return image;
}

}  // namespace colmap_seapoint
