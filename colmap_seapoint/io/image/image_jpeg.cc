#include <csetjmp>
#include <cstdio>
// jpeglib.h needs <cstdio> before it.
#include <jerror.h>
#include <jpeglib.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

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

// Called again and again while libjpeg reads the scans.
void OnProgress(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMaxJpegScans) return;
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  std::snprintf(errors->message, sizeof(errors->message), "it has more than %d scans",
                kMaxJpegScans);
  longjmp(errors->jump, 1);
}

// Owns the decompressor, so that a longjmp passes no destructor.
struct JpegDecoder {
  explicit JpegDecoder(const ImageSource& source) : file(source.file.get()) {
    info.err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = OnError;
    errors.manager.emit_message = OnMessage;
    errors.manager.output_message = PrintNothing;
    progress.progress_monitor = OnProgress;
  }
  ~JpegDecoder() { jpeg_destroy_decompress(&info); }
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  std::FILE* file;
  jpeg_decompress_struct info{};
  jpeg_progress_mgr progress{};
  JpegErrors errors;
};

bool ReadHeader(JpegDecoder* decoder) {
  if (setjmp(decoder->errors.jump) != 0) return false;
  jpeg_create_decompress(&decoder->info);
  decoder->info.progress = &decoder->progress;
  jpeg_stdio_src(&decoder->info, decoder->file);
  jpeg_read_header(&decoder->info, TRUE);
  return true;
}

bool Start(JpegDecoder* decoder, J_COLOR_SPACE color_space, bool as_stored) {
  jpeg_decompress_struct* info = &decoder->info;
  if (setjmp(decoder->errors.jump) != 0) return false;
  info->out_color_space = color_space;
  info->raw_data_out = as_stored ? TRUE : FALSE;
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

// 0, 1, 2 for a plane as large as the luma's, half, a quarter; else -1.
int ShiftOf(int max_sampling, int sampling) {
  for (int shift = 0; shift <= 2; ++shift) {
    if (sampling << shift == max_sampling) return shift;
  }
  return -1;
}

// Whether the file holds luma in full and both chroma planes in a grid that Picture knows.
bool HoldsPlanes(const jpeg_decompress_struct& info) {
  if (info.jpeg_color_space != JCS_YCbCr || info.num_components != 3) return false;
  const jpeg_component_info &y = info.comp_info[0], &cb = info.comp_info[1],
                            &cr = info.comp_info[2];
  return y.h_samp_factor == info.max_h_samp_factor && y.v_samp_factor == info.max_v_samp_factor &&
         cb.h_samp_factor == cr.h_samp_factor && cb.v_samp_factor == cr.v_samp_factor &&
         ShiftOf(y.h_samp_factor, cb.h_samp_factor) >= 0 &&
         ShiftOf(y.v_samp_factor, cb.v_samp_factor) >= 0;
}

// Room for one row of a JPEG's largest blocks (iMCU), whose sides go beyond the picture's.
struct RowOfBlocks {
  Image<uint8_t> samples[3];
  std::vector<JSAMPROW> rows[3];
  JSAMPARRAY planes[3];

  explicit RowOfBlocks(const jpeg_decompress_struct& info) {
    for (int c = 0; c < 3; ++c) {
      const jpeg_component_info& component = info.comp_info[c];
      samples[c] = Image<uint8_t>(static_cast<int>(component.width_in_blocks) * DCTSIZE,
                                  component.v_samp_factor * DCTSIZE);
      for (int y = 0; y < samples[c].height; ++y) rows[c].push_back(samples[c].Row(y));
      planes[c] = rows[c].data();
    }
  }
};

bool ReadPlanes(JpegDecoder* decoder, RowOfBlocks* blocks, GrayImage* const planes[3]) {
  jpeg_decompress_struct* info = &decoder->info;
  const auto num_lines = static_cast<JDIMENSION>(info->max_v_samp_factor * DCTSIZE);
  if (setjmp(decoder->errors.jump) != 0) return false;
  for (int row = 0; info->output_scanline < info->output_height; ++row) {
    jpeg_read_raw_data(info, blocks->planes, num_lines);
    for (int c = 0; c < 3; ++c) {
      const int begin = row * blocks->samples[c].height;
      const int count = std::min(blocks->samples[c].height, planes[c]->height - begin);
      for (int y = 0; y < count; ++y) {
        std::memcpy(planes[c]->Row(begin + y), blocks->samples[c].Row(y), planes[c]->Stride());
      }
    }
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

// One channel (luma) or three.
Image<uint8_t> DecodePixels(const std::filesystem::path& path, const ImageSize& size,
                            J_COLOR_SPACE color_space, JpegDecoder* decoder) {
  if (!Start(decoder, color_space, false)) ThrowDamagedImage(path, decoder->errors.message);
  Image<uint8_t> image(size.width, size.height, decoder->info.output_components);
  if (!ReadRows(decoder, image.data.data()) || decoder->errors.is_damaged) {
    ThrowDamagedImage(path, decoder->errors.message);
  }
  if (image.channels == 4) return RgbFromCmyk(image, decoder->info.saw_Adobe_marker != 0);
  return image;
}

Image<uint8_t> DecodeInColor(const std::filesystem::path& path, const ImageSize& size,
                             JpegDecoder* decoder) {
  switch (decoder->info.jpeg_color_space) {
    case JCS_CMYK:
    case JCS_YCCK:
      return DecodePixels(path, size, JCS_CMYK, decoder);
    case JCS_GRAYSCALE:
      return DecodePixels(path, size, JCS_GRAYSCALE, decoder);
    default:
      return DecodePixels(path, size, JCS_RGB, decoder);
  }
}

// Leaves out upsampling and colour conversion, half of a decoder's work.
Picture DecodeAsStored(const std::filesystem::path& path, const ImageSize& size,
                       JpegDecoder* decoder) {
  if (!Start(decoder, JCS_YCbCr, true)) ThrowDamagedImage(path, decoder->errors.message);
  const jpeg_component_info &y = decoder->info.comp_info[0], &cb = decoder->info.comp_info[1];
  Picture picture;
  picture.chroma_shift_x = ShiftOf(y.h_samp_factor, cb.h_samp_factor);
  picture.chroma_shift_y = ShiftOf(y.v_samp_factor, cb.v_samp_factor);
  picture.luma = GrayImage(size.width, size.height);
  picture.cb = picture.cr =
      GrayImage(static_cast<int>(cb.downsampled_width), static_cast<int>(cb.downsampled_height));
  RowOfBlocks blocks(decoder->info);
  GrayImage* const planes[3] = {&picture.luma, &picture.cb, &picture.cr};
  if (!ReadPlanes(decoder, &blocks, planes) || decoder->errors.is_damaged) {
    ThrowDamagedImage(path, decoder->errors.message);
  }
  return picture;
}

ImageHeader CheckHeader(const std::filesystem::path& path, JpegDecoder* decoder) {
  if (!ReadHeader(decoder)) ThrowDamagedImage(path, decoder->errors.message);
  if (decoder->errors.is_damaged) ThrowDamagedImage(path, decoder->errors.message);
  const jpeg_decompress_struct& info = decoder->info;
  ImageHeader header;
  header.size = CheckImageSize(path, info.image_width, info.image_height);
  header.packing = Packing::kJpeg;
  for (int c = 0; c < info.num_components; ++c) {
    const jpeg_component_info& component = info.comp_info[c];
    header.unpacked_bytes +=
        static_cast<uint64_t>(component.width_in_blocks) * component.height_in_blocks * DCTSIZE2;
  }
  // Of several scans, libjpeg holds the coefficients of all blocks.
  if (jpeg_has_multiple_scans(&decoder->info)) {
    header.more_bytes = header.unpacked_bytes * sizeof(JCOEF);
  }
  return header;
}

}  // namespace

ImageHeader ReadJpegHeader(const ImageSource& source) {
  JpegDecoder decoder(source);
  return CheckHeader(source.path, &decoder);
}

Image<uint8_t> DecodeJpeg(const ImageSource& source) {
  JpegDecoder decoder(source);
  const ImageHeader header = CheckHeader(source.path, &decoder);
  const MemoryShare share(BytesToDecode(source, header));
  return DecodeInColor(source.path, header.size, &decoder);
}

Picture DecodeJpegPlanes(const ImageSource& source, JpegContent content) {
  JpegDecoder decoder(source);
  const ImageHeader header = CheckHeader(source.path, &decoder);
  const ImageSize size = header.size;
  const MemoryShare share(BytesToDecode(source, header));
  Picture picture;
  if (HoldsPlanes(decoder.info)) {
    if (content == JpegContent::kPlanes) return DecodeAsStored(source.path, size, &decoder);
    picture.luma = DecodePixels(source.path, size, JCS_GRAYSCALE, &decoder);
    return picture;
  }
  Image<uint8_t> image = DecodeInColor(source.path, size, &decoder);
  if (image.channels == 3) return PictureOf(image);
  picture.luma = std::move(image);
  return picture;
}

}  // namespace colmap_seapoint
