#include "colmap_seapoint/io/image/jpeg_exif.h"

#include <cstdio>
#include <ctime>
#include <exiv2/exiv2.hpp>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_exif.h"

namespace colmap_seapoint {
namespace {

constexpr int kQuality = 95;
// A JPEG's segment holds no more, its length and "Exif" taken off.
constexpr size_t kMaxExifBytes = 65535 - 2 - 6;

ExifBlock Encode(const Exiv2::ExifData& exif) {
  if (exif.empty()) return {};
  Exiv2::Blob blob;
  Exiv2::ExifParser::encode(blob, Exiv2::littleEndian, exif);
  return blob.size() <= kMaxExifBytes ? ExifBlock(blob.begin(), blob.end()) : ExifBlock();
}

// Other keys tell where the pixels lie in the file that they come from.
bool IsAboutTheCamera(const Exiv2::Exifdatum& datum) {
  static const std::set<std::string> kImageKeys = {
      "Exif.Image.Make",     "Exif.Image.Model",    "Exif.Image.Orientation",
      "Exif.Image.DateTime", "Exif.Image.Software", "Exif.Image.ImageDescription"};
  static const std::set<std::string> kPhotoKeys = {"Exif.Photo.MakerNote",
                                                   "Exif.Photo.InteroperabilityTag"};
  const std::string group = datum.groupName();
  if (group == "Photo") return kPhotoKeys.count(datum.key()) == 0;
  return group == "GPSInfo" || kImageKeys.count(datum.key()) > 0;
}

ExifBlock Clean(const Exiv2::ExifData& exif) {
  Exiv2::ExifData kept;
  for (const Exiv2::Exifdatum& datum : exif) {
    if (IsAboutTheCamera(datum)) kept.add(datum);
  }
  return Encode(kept);
}

}  // namespace

ExifBlock MakeExif(std::optional<int64_t> time_us, const std::string& maker,
                   const std::string& model) {
  const auto held = HoldExiv2();
  Exiv2::ExifData exif;
  if (!maker.empty()) exif["Exif.Image.Make"] = maker;
  if (!model.empty()) exif["Exif.Image.Model"] = model;
  if (time_us && *time_us >= 0) {
    const std::time_t seconds = *time_us / 1000000;
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    char text[32];
    std::strftime(text, sizeof(text), "%Y:%m:%d %H:%M:%S", &parts);
    exif["Exif.Photo.DateTimeOriginal"] = std::string(text);
    std::snprintf(text, sizeof(text), "%06d", static_cast<int>(*time_us % 1000000));
    exif["Exif.Photo.SubSecTimeOriginal"] = std::string(text);
  }
  return Encode(exif);
}

ExifBlock CleanExif(const ExifBlock& block) {
  const auto held = HoldExiv2();
  try {
    Exiv2::ExifData exif;
    Exiv2::ExifParser::decode(exif, block.data(), static_cast<uint32_t>(block.size()));
    return Clean(exif);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // Exiv2's own errors among them
    return {};
  }
}

ExifBlock CleanExifOf(const std::filesystem::path& path) {
  const auto held = HoldExiv2();
  try {
    const auto image = Exiv2::ImageFactory::open(path.string());
    image->readMetadata();
    return Clean(image->exifData());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return {};
  }
}

void WriteJpeg(const std::filesystem::path& path, const ColorImage& image, const ExifBlock& exif) {
  SEAPOINT_CHECK(!image.Empty() && image.channels == 3);
  const cv::Mat pixels(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.data.data()));
  cv::Mat swapped;
  cv::cvtColor(pixels, swapped, cv::COLOR_RGB2BGR);
  std::vector<uint8_t> jpeg;
  if (!cv::imencode(".jpg", swapped, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    throw Error(path.string(), "cannot be made a JPEG of", "make the picture smaller");
  }
  AtomicFile file(path);
  constexpr size_t kStartBytes = 2;  // of the marker that begins a JPEG
  file.Write(jpeg.data(), kStartBytes);
  if (!exif.empty()) {
    const size_t length = exif.size() + 8;
    const uint8_t head[] = {0xff,
                            0xe1,
                            static_cast<uint8_t>(length >> 8),
                            static_cast<uint8_t>(length & 0xff),
                            'E',
                            'x',
                            'i',
                            'f',
                            0,
                            0};
    file.Write(head, sizeof(head));
    file.Write(exif.data(), exif.size());
  }
  file.Write(jpeg.data() + kStartBytes, jpeg.size() - kStartBytes);
  file.Commit();
}

}  // namespace colmap_seapoint
