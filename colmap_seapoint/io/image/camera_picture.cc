#include "colmap_seapoint/io/image/camera_picture.h"

#include <libheif/heif.h>
#include <libraw/libraw.h>

#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kBytesPerPixel = 20;
constexpr char kConvert[] = "convert it to JPEG, or take it out of the folder";

struct HeifDeleter {
  void operator()(heif_context* context) const { heif_context_free(context); }
  void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_decoding_options* options) const { heif_decoding_options_free(options); }
};
template <typename T>
using HeifPointer = std::unique_ptr<T, HeifDeleter>;

void CheckHeif(const std::filesystem::path& path, const heif_error& error) {
  if (error.code == heif_error_Ok) return;
  std::string message = error.message;
  message.resize(message.find_last_not_of("\n ") + 1);
  if (error.code == heif_error_Memory_allocation_error &&
      error.subcode != heif_suberror_Security_limit_exceeded) {
    throw std::bad_alloc();
  }
  if (error.code == heif_error_Unsupported_filetype ||
      error.code == heif_error_Unsupported_feature ||
      error.code == heif_error_Decoder_plugin_error) {
    throw Error(path.string(), "is HEIC that cannot be decoded here (" + message + ")", kConvert);
  }
  ThrowDamagedImage(path, message);
}

ExifBlock HeifExif(const heif_image_handle* handle) {
  heif_item_id id = 0;
  if (heif_image_handle_get_list_of_metadata_block_IDs(handle, "Exif", &id, 1) != 1) return {};
  std::vector<uint8_t> bytes(heif_image_handle_get_metadata_size(handle, id));
  if (bytes.size() < 4 || heif_image_handle_get_metadata(handle, id, bytes.data()).code != 0) {
    return {};
  }
  // The first four bytes tell how far behind them the TIFF header is.
  uint64_t offset = 4;
  for (int i = 0; i < 4; ++i)
    offset += static_cast<uint64_t>(bytes[static_cast<size_t>(i)]) << (24 - 8 * i);
  if (offset >= bytes.size()) return {};
  return CleanExif(ExifBlock(bytes.begin() + static_cast<std::ptrdiff_t>(offset), bytes.end()));
}

CameraPicture ReadHeif(const std::filesystem::path& path) {
  const HeifPointer<heif_context> context(heif_context_alloc());
  if (context == nullptr) throw std::bad_alloc();
  CheckHeif(path, heif_context_read_from_file(context.get(), path.c_str(), nullptr));
  heif_image_handle* opened = nullptr;
  CheckHeif(path, heif_context_get_primary_image_handle(context.get(), &opened));
  const HeifPointer<heif_image_handle> handle(opened);
  const ImageSize promised =
      CheckImageSize(path, static_cast<uint64_t>(heif_image_handle_get_width(opened)),
                     static_cast<uint64_t>(heif_image_handle_get_height(opened)));
  const MemoryShare share(kBytesPerPixel * static_cast<uint64_t>(promised.width) *
                          static_cast<uint64_t>(promised.height));
  const HeifPointer<heif_decoding_options> options(heif_decoding_options_alloc());
  if (options == nullptr) throw std::bad_alloc();
  options->ignore_transformations = 1;
  options->convert_hdr_to_8bit = 1;
  heif_image* decoded = nullptr;
  CheckHeif(path, heif_decode_image(opened, &decoded, heif_colorspace_RGB,
                                    heif_chroma_interleaved_RGB, options.get()));
  const HeifPointer<heif_image> image(decoded);
  int stride = 0;
  const uint8_t* rows = heif_image_get_plane_readonly(decoded, heif_channel_interleaved, &stride);
  if (rows == nullptr) ThrowDamagedImage(path, "it has no pixels");
  CameraPicture picture;
  picture.pixels = ColorImage(heif_image_get_width(decoded, heif_channel_interleaved),
                              heif_image_get_height(decoded, heif_channel_interleaved), 3);
  for (int y = 0; y < picture.pixels.height; ++y) {
    std::memcpy(picture.pixels.Row(y), rows + static_cast<std::ptrdiff_t>(y) * stride,
                picture.pixels.Stride());
  }
  picture.exif = HeifExif(opened);
  return picture;
}

void CheckRaw(const std::filesystem::path& path, int code) {
  if (code == LIBRAW_SUCCESS) return;
  if (code == LIBRAW_UNSUFFICIENT_MEMORY) throw std::bad_alloc();
  if (code == LIBRAW_FILE_UNSUPPORTED || code == LIBRAW_REQUEST_FOR_NONEXISTENT_IMAGE ||
      code == LIBRAW_NOT_IMPLEMENTED) {
    throw Error(path.string(),
                "is RAW of a kind that this libraw cannot decode (" +
                    std::string(libraw_strerror(code)) + "; GoPro's compressed GPR is one)",
                kConvert);
  }
  ThrowDamagedImage(path, libraw_strerror(code));
}

struct RawImageDeleter {
  void operator()(libraw_processed_image_t* image) const { LibRaw::dcraw_clear_mem(image); }
};

CameraPicture ReadRaw(const std::filesystem::path& path) {
  const auto raw = std::make_unique<LibRaw>();
  bool is_damaged = false;
  // Where the data end too early libraw goes on with zeros, and says so to this function only; the
  // default one prints.
  raw->set_dataerror_handler(
      [](void* flag, const char*, auto) { *static_cast<bool*>(flag) = true; }, &is_damaged);
  libraw_output_params_t& params = raw->imgdata.params;
  params.use_camera_wb = 1;
  params.no_auto_bright = 1;
  params.user_flip = 0;
  params.output_bps = 8;
  // Of a file that is no picture, libraw says that it cannot be read.
  const int opened = raw->open_file(path.c_str());
  CheckRaw(path, opened == LIBRAW_IO_ERROR ? LIBRAW_FILE_UNSUPPORTED : opened);
  const ImageSize promised =
      CheckImageSize(path, raw->imgdata.sizes.raw_width, raw->imgdata.sizes.raw_height);
  const MemoryShare share(kBytesPerPixel * static_cast<uint64_t>(promised.width) *
                          static_cast<uint64_t>(promised.height));
  CheckRaw(path, raw->unpack());
  if (is_damaged) ThrowDamagedImage(path, "its data end too early");
  CheckRaw(path, raw->dcraw_process());
  int code = LIBRAW_SUCCESS;
  const std::unique_ptr<libraw_processed_image_t, RawImageDeleter> image(
      raw->dcraw_make_mem_image(&code));
  CheckRaw(path, code);
  if (image == nullptr || image->colors != 3 || image->bits != 8) {
    ThrowDamagedImage(path, "it has no colours");
  }
  CameraPicture picture;
  picture.pixels = ColorImage(image->width, image->height, 3);
  SEAPOINT_CHECK(image->data_size == picture.pixels.data.size());
  std::memcpy(picture.pixels.data.data(), image->data, image->data_size);
  picture.exif = CleanExifOf(path);
  return picture;
}

enum class Content { kHeif, kJpeg, kRaw };

Content ContentOf(const std::filesystem::path& path) {
  const ImageSource source = OpenImageFile(path);
  char head[12] = {0};
  const size_t size = std::fread(head, 1, sizeof(head), source.file.get());
  if (size == 0) {
    throw Error(path.string(), "is empty (zero bytes)",
                "copy the picture again from its source, or take it out of the folder");
  }
  if (std::memcmp(head, "\xff\xd8\xff", 3) == 0) return Content::kJpeg;
  // CR3 is in the same container.
  const bool is_heif = size == sizeof(head) && std::memcmp(head + 4, "ftyp", 4) == 0 &&
                       std::memcmp(head + 8, "crx ", 4) != 0;
  return is_heif ? Content::kHeif : Content::kRaw;
}

}  // namespace

CameraPicture ReadCameraPicture(const std::filesystem::path& path) {
  switch (ContentOf(path)) {
    case Content::kHeif:
      return ReadHeif(path);
    case Content::kJpeg:  // messengers keep the name of what they convert
      return {ReadColorImage(path), CleanExifOf(path)};
    case Content::kRaw:
      return ReadRaw(path);
  }
  SEAPOINT_CHECK(false);
  return {};
}

}  // namespace colmap_seapoint
