// Any bytes as the EXIF of a JPEG.
#include <cmath>

#include "colmap_seapoint/cameras/exif_focal_length.h"
#include "colmap_seapoint/io/image/image_exif.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kMaxSegment = 65535 - 8;
  const std::string exif(reinterpret_cast<const char*>(data), std::min(size, kMaxSegment));
  const size_t length = exif.size() + 8;
  std::string jpeg = "\xff\xd8\xff\xe1";
  jpeg += static_cast<char>(length >> 8);
  jpeg += static_cast<char>(length & 255);
  jpeg += std::string("Exif\0\0", 6) + exif;
  // A frame of 640 x 480, without data: nobody decodes it here.
  jpeg += std::string("\xff\xc0\0\x0b\x08\x01\xe0\x02\x80\x01\x01\x11\0\xff\xd9", 15);
  const ExifInfo info = ReadExif(WriteFuzzFile("exif.jpg", jpeg));
  FUZZ_REQUIRE(info.orientation >= 1 && info.orientation <= 8);
  const ExifCamera& camera = info.camera;
  for (const double number : {camera.focal_mm, camera.focal_35mm, camera.digital_zoom,
                              camera.pixels_per_mm, camera.taken_width, camera.taken_height}) {
    FUZZ_REQUIRE(std::isfinite(number) && number >= 0);
  }
  const auto focal = FocalLengthFromExif(camera, 640, 480);
  FUZZ_REQUIRE(!focal || (focal->px >= 64 && focal->px <= 64000));
  FUZZ_REQUIRE(!info.gps || IsLegal(*info.gps));
  return 0;
}
