#include <png.h>

#include <csetjmp>
#include <cstring>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

struct PngErrors {
  jmp_buf jump;
  char message[200] = {0};
};

void OnError(png_structp png, png_const_charp message) {
  auto* errors = static_cast<PngErrors*>(png_get_error_ptr(png));
  std::strncpy(errors->message, message, sizeof(errors->message) - 1);
  longjmp(errors->jump, 1);
}

void OnWarning(png_structp, png_const_charp) {}

// Owns the reader, so that a longjmp passes no destructor.
struct PngDecoder {
  explicit PngDecoder(const ImageSource& source) : file(source.file.get()) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &errors, OnError, OnWarning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) ThrowDamagedImage(source.path, "libpng cannot start");
  }
  ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  std::FILE* file;
  PngErrors errors;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

bool ReadHeader(PngDecoder* decoder) {
  if (setjmp(decoder->errors.jump) != 0) return false;
  png_init_io(decoder->png, decoder->file);
  png_read_info(decoder->png, decoder->info);
  return true;
}

// Any PNG becomes 8 bits, grey or red green blue.
bool Start(PngDecoder* decoder) {
  if (setjmp(decoder->errors.jump) != 0) return false;
  png_set_scale_16(decoder->png);
  png_set_expand(decoder->png);
  png_set_strip_alpha(decoder->png);
  png_set_interlace_handling(decoder->png);
  png_read_update_info(decoder->png, decoder->info);
  return true;
}

bool ReadRows(PngDecoder* decoder, png_bytepp rows) {
  if (setjmp(decoder->errors.jump) != 0) return false;
  png_read_image(decoder->png, rows);
  png_read_end(decoder->png, nullptr);  // reads on to the IEND chunk
  return true;
}

ImageHeader CheckHeader(const std::filesystem::path& path, PngDecoder* decoder) {
  if (!ReadHeader(decoder)) ThrowDamagedImage(path, decoder->errors.message);
  const uint64_t width = png_get_image_width(decoder->png, decoder->info);
  const uint64_t height = png_get_image_height(decoder->png, decoder->info);
  ImageHeader header;
  header.size = CheckImageSize(path, width, height);
  header.packing = Packing::kDeflate;
  header.unpacked_bytes = png_get_rowbytes(decoder->png, decoder->info) * height;
  return header;
}

}  // namespace

ImageHeader ReadPngHeader(const ImageSource& source) {
  PngDecoder decoder(source);
  return CheckHeader(source.path, &decoder);
}

Image<uint8_t> DecodePng(const ImageSource& source) {
  PngDecoder decoder(source);
  const ImageHeader header = CheckHeader(source.path, &decoder);
  const ImageSize size = header.size;
  const MemoryShare share(BytesToDecode(source, header));
  if (!Start(&decoder)) ThrowDamagedImage(source.path, decoder.errors.message);
  Image<uint8_t> image(size.width, size.height, png_get_channels(decoder.png, decoder.info));
  if (png_get_rowbytes(decoder.png, decoder.info) != image.Stride()) {
    ThrowDamagedImage(source.path, "its pixels are of an unknown kind");
  }
  std::vector<png_bytep> rows(static_cast<size_t>(size.height));
  for (int y = 0; y < size.height; ++y) rows[static_cast<size_t>(y)] = image.Row(y);
  if (!ReadRows(&decoder, rows.data())) ThrowDamagedImage(source.path, decoder.errors.message);
  return image;
}

}  // namespace colmap_seapoint
