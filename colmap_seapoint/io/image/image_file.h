// Pictures on disk: listing them, size and EXIF without decoding, hash and pixels from one reading,
// writing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/picture.h"
#include "colmap_seapoint/io/image/exif_camera.h"

namespace colmap_seapoint {

// Names (relative to `image_path`, '/' between folders, sorted bytewise) of all files below it with
// a picture's extension (jpg jpeg png tif tiff bmp webp ppm pgm jp2, any case). Hidden files and
// folders are left out. Throws Error when the folder is missing or holds no picture. Names that
// IsSafeImageName refuses are among them, for whoever lists them to name and leave out.
std::vector<std::string> ListImages(const std::filesystem::path& image_path);

// One name a line; blank lines and lines starting with '#' skipped. Throws Error for a missing
// file, an empty list, and names that IsSafeImageName refuses.
std::vector<std::string> ReadImageList(const std::filesystem::path& list_path);

// False for empty and absolute names, names with a ".." or an empty component, with a backslash or
// a NUL or a newline: such a name could lead out of a folder.
bool IsSafeImageName(const std::string& name);

// Heights that EXIF or XMP tell, by what they are measured from; metres.
struct CaptureHeights {
  std::optional<double> depth;        // below the surface (EXIF's WaterDepth, XMP's Depth)
  std::optional<double> altitude;     // EXIF's GPSAltitude, else XMP's AbsoluteAltitude
  std::optional<double> above_start;  // XMP's RelativeAltitude: above where the flight began
};

struct ImageInfo {
  int width = 0;  // as stored: the EXIF orientation is not applied, as in COLMAP
  int height = 0;
  int exif_orientation = 1;        // 1..8; not 1: the picture is stored turned
  std::optional<GeoPosition> gps;  // from EXIF; altitude 0 when it tells none
  ExifCamera camera;
  CaptureHeights heights;
  std::string taken;  // EXIF's DateTimeOriginal with its fraction, as it stands there; "" = none
};

// Reads the header (and EXIF) only. Throws Error for missing, zero-byte, unreadable files.
ImageInfo ReadImageInfo(const std::filesystem::path& path);

// A picture's file, read whole and once: its hash and its pixels come from the same bytes.
//
// EXIF orientation is ignored, as COLMAP does: the pixels are as they are stored. 16-bit pictures
// are scaled to 8 bits. Grey is 0.299 R + 0.587 G + 0.114 B; of a JPEG, the luma that it holds, so
// that DecodeGray() == Decode().luma, always. Decoders throw Error for what cannot be decoded
// *whole*: a truncated JPEG, PNG or TIFF is an error, not a half-grey picture. The codec libraries
// print nothing. Several threads may decode one file.
class PictureFile {
 public:
  // Throws Error for a file that cannot be read to its end, is empty, or is of no known format.
  explicit PictureFile(const std::filesystem::path& path);

  uint64_t Size() const { return bytes_.size(); }  // bytes
  std::string Hash() const;                        // that of HashFile()
  // The memory that decoding takes, in bytes. Throws Error for what is not worth it: a header that
  // promises more than the file can hold, or than --max_memory (memory_budget.h) allows.
  uint64_t BytesToDecode() const;

  GrayImage DecodeGray() const;
  // As DecodeGray(), for a mask: what is not 0 in a 16-bit PNG stays so, however dark it is.
  GrayImage DecodeMask() const;
  // A JPEG's own planes, neither enlarged nor converted; of other formats, and of a JPEG that holds
  // none such, the planes of its red, green and blue. A grey picture has no colour.
  Picture Decode() const;
  ColorImage DecodeColor() const;

 private:
  std::filesystem::path path_;
  std::vector<uint8_t> bytes_;
};

// For a picture whose file nobody keeps: PictureFile(path).DecodeGray() and so on.
GrayImage ReadGrayImage(const std::filesystem::path& path);
Picture ReadPicture(const std::filesystem::path& path);
ColorImage ReadColorImage(const std::filesystem::path& path);

// The bytes of a file of that kind. 8-bit, 1, 3 or (PNG) 4 channels, red green blue alpha.
std::vector<uint8_t> EncodePng(const Image<uint8_t>& image);
std::vector<uint8_t> EncodeJpeg(const Image<uint8_t>& image, int quality);  // 0..100

// 8-bit, 1 or 3 channels, format from the extension; atomic.
void WriteImage(const std::filesystem::path& path, const Image<uint8_t>& image);

}  // namespace colmap_seapoint
