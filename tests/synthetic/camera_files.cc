#include "tests/synthetic/camera_files.h"

#include <libheif/heif.h>
#include <tiffio.h>

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <stdexcept>
#include <vector>

namespace colmap_seapoint {
namespace {

std::vector<uint8_t> Exif() {
  Exiv2::ExifData exif;
  exif["Exif.Image.Make"] = std::string("TestMaker");
  exif["Exif.Photo.FocalLengthIn35mmFilm"] = uint16_t(28);
  Exiv2::Blob blob;
  Exiv2::ExifParser::encode(blob, Exiv2::littleEndian, exif);
  return {blob.begin(), blob.end()};
}

void Check(bool is_right, const char* what) {
  if (!is_right) throw std::runtime_error(std::string("the test's picture: ") + what);
}

}  // namespace

bool WriteHeic(const std::filesystem::path& path, const GrayImage& gray) {
  heif_context* context = heif_context_alloc();
  heif_encoder* encoder = nullptr;
  if (heif_context_get_encoder_for_format(context, heif_compression_HEVC, &encoder).code != 0) {
    heif_context_free(context);
    return false;
  }
  heif_encoder_set_lossy_quality(encoder, 95);
  heif_image* image = nullptr;
  heif_image_create(gray.width, gray.height, heif_colorspace_RGB, heif_chroma_interleaved_RGB,
                    &image);
  heif_image_add_plane(image, heif_channel_interleaved, gray.width, gray.height, 8);
  int stride = 0;
  uint8_t* rows = heif_image_get_plane(image, heif_channel_interleaved, &stride);
  for (int y = 0; y < gray.height; ++y) {
    for (int x = 0; x < 3 * gray.width; ++x) rows[y * stride + x] = gray.At(x / 3, y);
  }
  heif_image_handle* handle = nullptr;
  Check(heif_context_encode_image(context, image, encoder, nullptr, &handle).code == 0, "HEIC");
  const auto exif = Exif();
  heif_context_add_exif_metadata(context, handle, exif.data(), static_cast<int>(exif.size()));
  Check(heif_context_write_to_file(context, path.c_str()).code == 0, "file");
  heif_image_handle_release(handle);
  heif_image_release(image);
  heif_encoder_release(encoder);
  heif_context_free(context);
  return true;
}

void WriteDng(const std::filesystem::path& path, const GrayImage& gray) {
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  Check(tiff != nullptr, "file");
  const uint8_t version[] = {1, 4, 0, 0}, pattern[] = {0, 1, 1, 2};
  const uint16_t pattern_size[] = {2, 2};
  // Camera white is white, and its colours are those of sRGB.
  const float matrix[] = {3.2406f, -1.5372f, -0.4986f, -0.9689f, 1.8758f,
                          0.0415f, 0.0557f,  -0.2040f, 1.0570f};
  const float neutral[] = {1, 1, 1};
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, gray.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, gray.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, gray.height);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CFA);
  TIFFSetField(tiff, TIFFTAG_MAKE, "TestMaker");
  TIFFSetField(tiff, TIFFTAG_MODEL, "TestModel");
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, 6);
  TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, pattern_size);
  TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, pattern);
  TIFFSetField(tiff, TIFFTAG_DNGVERSION, version);
  TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, "TestMaker TestModel");
  TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
  TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, neutral);
  std::vector<uint16_t> row(static_cast<size_t>(gray.width));
  for (int y = 0; y < gray.height; ++y) {
    for (int x = 0; x < gray.width; ++x) {
      row[static_cast<size_t>(x)] =
          static_cast<uint16_t>(std::lround(65535 * std::pow(gray.At(x, y) / 255.0, 2.2)));
    }
    TIFFWriteScanline(tiff, row.data(), static_cast<uint32_t>(y), 0);
  }
  TIFFClose(tiff);
}

}  // namespace colmap_seapoint
