#include <csetjmp>
#include <cstdio>
// jpeglib.h needs <cstdio> before it.
#include <jerror.h>
#include <jpeglib.h>

#include "colmap_seapoint/io/image_codecs.h"

namespace colmap_seapoint {
namespace {

// Bytes before a marker that belong to nothing: a few are padding, many are damage.
constexpr int kMaxExtraneousBytes = 256;

struct JpegErrors {
  jpeg_error_mgr manager;  // first: libjpeg hands back a pointer to it
  jmp_buf jump;
  bool is_damaged = false;
  char message[JMSG_LENGTH_MAX] = {0};
};

void OnError(j_common_ptr info) {
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  info->err->format_message(info, errors->message);
  longjmp(errors->jump, 1);
}

void OnMessage(j_common_ptr info, int level) {
  if (level >= 0) return;  // a trace
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  switch (info->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:
      if (info->err->msg_parm.i[0] <= kMaxExtraneousBytes) return;
      break;
    case JWRN_ADOBE_XFORM:
    case JWRN_BOGUS_PROGRESSION:
    case JWRN_JFIF_MAJOR:
    case JWRN_NOT_SEQUENTIAL:
    case JWRN_TOO_MUCH_DATA:
      return;  // odd, but every pixel is there
    default:
      break;
  }
  if (!errors->is_damaged) info->err->format_message(info, errors->message);
  errors->is_damaged = true;
}

void PrintNothing(j_common_ptr) {}

// Owns the decompressor, so that a longjmp passes no destructor.
struct JpegDecoder {
  explicit JpegDecoder(const std::filesystem::path& path) : file(OpenImageFile(path)) {
    info.err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = OnError;
    errors.manager.emit_message = OnMessage;
    errors.manager.output_message = PrintNothing;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  FileHandle file;
  jpeg_decompress_struct info{};
  JpegErrors errors;
};

bool ReadHeader(JpegDecoder* decoder) {
  if (setjmp(decoder->errors.jump) != 0) return false;
  jpeg_create_decompress(&decoder->info);
  jpeg_stdio_src(&decoder->info, decoder->file.get());
  jpeg_read_header(&decoder->info, TRUE);
  return true;
}

bool Start(JpegDecoder* decoder, bool grey) {
  jpeg_decompress_struct* info = &decoder->info;
  if (setjmp(decoder->errors.jump) != 0) return false;
  const bool is_cmyk = info->jpeg_color_space == JCS_CMYK || info->jpeg_color_space == JCS_YCCK;
  const bool is_grey = info->jpeg_color_space == JCS_GRAYSCALE;
  info->out_color_space = is_cmyk ? JCS_CMYK : (grey || is_grey) ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_start_decompress(info);
  return true;
}

bool ReadRows(JpegDecoder* decoder, uint8_t* pixels) {
  jpeg_decompress_struct* info = &decoder->info;
  const size_t stride =
      static_cast<size_t>(info->output_width) * static_cast<size_t>(info->output_components);
  if (setjmp(decoder->errors.jump) != 0) return false;
  while (info->output_scanline < info->output_height) {
    JSAMPROW row = pixels + info->output_scanline * stride;
    jpeg_read_scanlines(info, &row, 1);
  }
  jpeg_finish_decompress(info);  // reads on to the end-of-image marker
  return true;
}

// Adobe's CMYK is stored inverted: 255 is no ink.
Image<uint8_t> RgbFromCmyk(const Image<uint8_t>& cmyk, bool is_inverted) {
  Image<uint8_t> rgb(cmyk.width, cmyk.height, 3);
  for (size_t i = 0; i < rgb.data.size() / 3; ++i) {
    const uint8_t* ink = cmyk.data.data() + 4 * i;
    for (size_t c = 0; c < 3; ++c) {
      const int light = is_inverted ? ink[c] : 255 - ink[c];
      const int black = is_inverted ? ink[3] : 255 - ink[3];
      rgb.data[3 * i + c] = static_cast<uint8_t>((light * black + 127) / 255);
    }
  }
  return rgb;
}

ImageSize CheckHeader(const std::filesystem::path& path, JpegDecoder* decoder) {
  if (!ReadHeader(decoder)) ThrowDamagedImage(path, decoder->errors.message);
  if (decoder->errors.is_damaged) ThrowDamagedImage(path, decoder->errors.message);
  return CheckImageSize(path, decoder->info.image_width, decoder->info.image_height);
}

}  // namespace

ImageSize ReadJpegSize(const std::filesystem::path& path) {
  JpegDecoder decoder(path);
  return CheckHeader(path, &decoder);
}

Image<uint8_t> DecodeJpeg(const std::filesystem::path& path, bool grey) {
  JpegDecoder decoder(path);
  const ImageSize size = CheckHeader(path, &decoder);
  if (!Start(&decoder, grey)) ThrowDamagedImage(path, decoder.errors.message);
  Image<uint8_t> image(size.width, size.height, decoder.info.output_components);
  if (!ReadRows(&decoder, image.data.data()) || decoder.errors.is_damaged) {
    ThrowDamagedImage(path, decoder.errors.message);
  }
  if (image.channels == 4) return RgbFromCmyk(image, decoder.info.saw_Adobe_marker != 0);
  return image;
}

}  // namespace colmap_seapoint
