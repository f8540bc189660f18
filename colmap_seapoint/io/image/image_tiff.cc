#include <tiffio.h>

#include <cstdarg>
#include <cstdio>

#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"

namespace colmap_seapoint {
namespace {

struct TiffErrors {
  std::string first;
};

// Returning 1 keeps libtiff from calling the handlers of the whole process, which print.
int OnError(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  auto* errors = static_cast<TiffErrors*>(user_data);
  char message[300];
  std::vsnprintf(message, sizeof(message), format, arguments);
  if (errors->first.empty()) errors->first = message;
  return 1;
}

int OnWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

using TiffHandle = std::unique_ptr<TIFF, void (*)(TIFF*)>;

std::FILE* FileOf(thandle_t source) { return static_cast<const ImageSource*>(source)->file.get(); }

tmsize_t Read(thandle_t source, void* bytes, tmsize_t count) {
  return static_cast<tmsize_t>(std::fread(bytes, 1, static_cast<size_t>(count), FileOf(source)));
}

tmsize_t WriteNothing(thandle_t, void*, tmsize_t) { return 0; }

toff_t Seek(thandle_t source, toff_t offset, int whence) {
  if (fseeko(FileOf(source), static_cast<off_t>(offset), whence) != 0) {
    return static_cast<toff_t>(-1);
  }
  return static_cast<toff_t>(ftello(FileOf(source)));
}

int CloseNothing(thandle_t) { return 0; }

toff_t SizeOf(thandle_t source) { return static_cast<const ImageSource*>(source)->size; }

// `source` and `errors` must outlive it.
TiffHandle OpenTiff(const ImageSource& source, TiffErrors* errors) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, OnError, errors);
  TIFFOpenOptionsSetWarningHandlerExtR(options, OnWarning, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, static_cast<tmsize_t>(MaxMemory()));
  // 'm': no memory mapping, which would crash when the file shrinks meanwhile.
  TiffHandle tiff(
      TIFFClientOpenExt(source.path.c_str(), "rm", const_cast<ImageSource*>(&source), Read,
                        WriteNothing, Seek, CloseNothing, SizeOf, nullptr, nullptr, options),
      &TIFFClose);
  TIFFOpenOptionsFree(options);
  if (tiff == nullptr) ThrowDamagedImage(source.path, errors->first);
  return tiff;
}

Packing PackingOf(uint16_t compression) {
  switch (compression) {
    case COMPRESSION_NONE:
      return Packing::kNone;
    case COMPRESSION_PACKBITS:
      return Packing::kPackBits;
    case COMPRESSION_LZW:
      return Packing::kLzw;
    case COMPRESSION_JPEG:
    case COMPRESSION_OJPEG:
      return Packing::kJpeg;
    default:  // others are held to the same: no photograph comes near it
      return Packing::kDeflate;
  }
}

ImageHeader CheckHeader(const std::filesystem::path& path, TIFF* tiff) {
  uint32_t width = 0, height = 0;
  uint16_t compression = COMPRESSION_NONE;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  ImageHeader header;
  header.size = CheckImageSize(path, width, height);
  header.packing = PackingOf(compression);
  header.unpacked_bytes = TIFFScanlineSize64(tiff) * height;
  header.bytes_per_pixel += sizeof(uint32_t);  // libtiff's raster
  header.more_bytes = TIFFIsTiled(tiff) ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff);
  return header;
}

bool IsGrey(TIFF* tiff) {
  uint16_t photometric = 0, samples = 1;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  return samples <= 2 &&
         (photometric == PHOTOMETRIC_MINISBLACK || photometric == PHOTOMETRIC_MINISWHITE);
}

}  // namespace

ImageHeader ReadTiffHeader(const ImageSource& source) {
  TiffErrors errors;
  return CheckHeader(source.path, OpenTiff(source, &errors).get());
}

Image<uint8_t> DecodeTiff(const ImageSource& source) {
  TiffErrors errors;
  const TiffHandle tiff = OpenTiff(source, &errors);
  const ImageHeader header = CheckHeader(source.path, tiff.get());
  const ImageSize size = header.size;
  const MemoryShare share(BytesToDecode(source, header));
  char message[1024] = "";
  if (!TIFFRGBAImageOK(tiff.get(), message)) ThrowDamagedImage(source.path, message);
  TIFFRGBAImage reader;
  const int stop_on_error = 1;
  if (!TIFFRGBAImageBegin(&reader, tiff.get(), stop_on_error, message)) {
    ThrowDamagedImage(source.path, message);
  }
  // The rows as they are stored, whatever the orientation tag says.
  reader.orientation = ORIENTATION_TOPLEFT;
  reader.req_orientation = ORIENTATION_TOPLEFT;
  const auto width = static_cast<uint32_t>(size.width);
  const auto height = static_cast<uint32_t>(size.height);
  std::vector<uint32_t> raster(static_cast<size_t>(width) * height);
  const bool is_read = TIFFRGBAImageGet(&reader, raster.data(), width, height) != 0;
  TIFFRGBAImageEnd(&reader);
  if (!is_read || !errors.first.empty()) ThrowDamagedImage(source.path, errors.first);

  const bool is_grey = IsGrey(tiff.get());
  Image<uint8_t> image(size.width, size.height, is_grey ? 1 : 3);
  uint8_t* out = image.data.data();
  for (const uint32_t pixel : raster) {
    *out++ = static_cast<uint8_t>(TIFFGetR(pixel));
    if (is_grey) continue;
    *out++ = static_cast<uint8_t>(TIFFGetG(pixel));
    *out++ = static_cast<uint8_t>(TIFFGetB(pixel));
  }
  return image;
}

}  // namespace colmap_seapoint
