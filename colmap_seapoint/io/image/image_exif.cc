#include "colmap_seapoint/io/image/image_exif.h"

#include <charconv>
#include <cmath>
#include <exiv2/exiv2.hpp>
#include <locale>
#include <new>
#include <sstream>
#include <utility>

#include "colmap_seapoint/io/image/image_codecs.h"

namespace colmap_seapoint {
namespace {

std::optional<double> Number(const Exiv2::ExifData& exif, const char* key, int index = 0) {
  const auto found = exif.findKey(Exiv2::ExifKey(key));
  if (found == exif.end() || static_cast<int>(found->count()) <= index) return std::nullopt;
  const Exiv2::Rational value = found->toRational(index);
  if (value.second == 0) return std::nullopt;
  return static_cast<double>(value.first) / static_cast<double>(value.second);
}

std::string Text(const Exiv2::ExifData& exif, const char* key) {
  const auto found = exif.findKey(Exiv2::ExifKey(key));
  if (found == exif.end()) return {};
  std::string text = found->toString();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

// 0 for what is missing, infinite or below zero.
double Measure(const Exiv2::ExifData& exif, const char* key) {
  const double value = Number(exif, key).value_or(0);
  return std::isfinite(value) && value > 0 ? value : 0;
}

// By the units of TIFF, and the two that some cameras write; 0 for others.
double UnitMm(const Exiv2::ExifData& exif) {
  const double unit = Measure(exif, "Exif.Photo.FocalPlaneResolutionUnit");
  return unit == 2 ? 25.4 : unit == 3 ? 10.0 : unit == 4 ? 1.0 : unit == 5 ? 1e-3 : 0.0;
}

ExifCamera CameraOf(const Exiv2::ExifData& exif) {
  ExifCamera camera;
  camera.maker = Text(exif, "Exif.Image.Make");
  camera.model = Text(exif, "Exif.Image.Model");
  camera.lens = Text(exif, "Exif.Photo.LensModel");
  camera.serial = Text(exif, "Exif.Photo.BodySerialNumber");
  camera.focal_mm = Measure(exif, "Exif.Photo.FocalLength");
  camera.focal_35mm = Measure(exif, "Exif.Photo.FocalLengthIn35mmFilm");
  camera.digital_zoom = Measure(exif, "Exif.Photo.DigitalZoomRatio");
  const double unit_mm = UnitMm(exif);
  if (unit_mm > 0) {
    camera.pixels_per_mm = Measure(exif, "Exif.Photo.FocalPlaneXResolution") / unit_mm;
  }
  camera.taken_width = Measure(exif, "Exif.Photo.PixelXDimension");
  camera.taken_height = Measure(exif, "Exif.Photo.PixelYDimension");
  return camera;
}

// Degrees, minutes and seconds; minutes and seconds may be missing.
std::optional<double> Angle(const Exiv2::ExifData& exif, const char* key) {
  const auto degrees = Number(exif, key, 0);
  if (!degrees) return std::nullopt;
  return *degrees + Number(exif, key, 1).value_or(0) / 60 + Number(exif, key, 2).value_or(0) / 3600;
}

std::optional<GeoPosition> GpsOfExif(const Exiv2::ExifData& exif) {
  const auto latitude = Angle(exif, "Exif.GPSInfo.GPSLatitude");
  const auto longitude = Angle(exif, "Exif.GPSInfo.GPSLongitude");
  if (!latitude || !longitude) return std::nullopt;
  GeoPosition gps;
  const bool is_south = Text(exif, "Exif.GPSInfo.GPSLatitudeRef") == "S";
  const bool is_west = Text(exif, "Exif.GPSInfo.GPSLongitudeRef") == "W";
  const bool is_below = Number(exif, "Exif.GPSInfo.GPSAltitudeRef").value_or(0) == 1;
  const double altitude = Number(exif, "Exif.GPSInfo.GPSAltitude").value_or(0);
  gps.latitude_deg = is_south ? -*latitude : *latitude;
  gps.longitude_deg = is_west ? -*longitude : *longitude;
  gps.altitude_m = is_below ? -altitude : altitude;
  if (!IsLegal(gps)) return std::nullopt;
  return gps;
}

// What Exiv2 tells of a file.
struct Metadata {
  Exiv2::ExifData exif;
  Exiv2::XmpData xmp;
};

// The value of the property of that name, whatever its namespace: makers have their own. "": none.
std::string XmpText(const Exiv2::XmpData& xmp, const std::string& name) {
  for (const Exiv2::Xmpdatum& datum : xmp) {
    if (datum.tagName() == name) return datum.toString();
  }
  return {};
}

// "+39.80", "12.5 m" and "25/2" are numbers.
std::optional<double> XmpNumber(const Exiv2::XmpData& xmp, const std::string& name) {
  std::istringstream text(XmpText(xmp, name));
  text.imbue(std::locale::classic());
  double value = 0, divisor = 1;
  char slash = 0;
  if (!(text >> value)) return std::nullopt;
  if (text >> slash && slash == '/' && text >> divisor && divisor != 0) value /= divisor;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// "43,6.125N" and "43,6,7.5S" as XMP's specification writes them, "+43.102" as drones do. Streams
// would take the E of the east for that of an exponent.
std::optional<double> XmpAngle(const Exiv2::XmpData& xmp, const std::string& name) {
  const std::string text = XmpText(xmp, name);
  const char *next = text.data(), *const end = next + text.size();
  if (next != end && *next == '+') ++next;
  double angle = 0;
  for (double unit = 1;; unit /= 60) {
    double part = 0;
    const auto number = std::from_chars(next, end, part);
    if (number.ec != std::errc()) return std::nullopt;
    angle += unit * part;
    next = number.ptr;
    if (next == end || *next != ',') break;
    ++next;
  }
  return next != end && (*next == 'S' || *next == 'W') ? -angle : angle;
}

std::optional<GeoPosition> GpsOfXmp(const Exiv2::XmpData& xmp) {
  for (const auto& [latitude_name, longitude_name] :
       {std::pair("GPSLatitude", "GPSLongitude"), std::pair("GpsLatitude", "GpsLongitude"),
        std::pair("GpsLatitude", "GpsLongtitude")}) {  // as a maker's firmware spells it
    const auto latitude = XmpAngle(xmp, latitude_name), longitude = XmpAngle(xmp, longitude_name);
    if (!latitude || !longitude) continue;
    const GeoPosition gps = {*latitude, *longitude, 0};
    if (IsLegal(gps)) return gps;
  }
  return std::nullopt;
}

std::optional<double> XmpAltitude(const Exiv2::XmpData& xmp) {
  const auto altitude = XmpNumber(xmp, "GPSAltitude");
  if (!altitude) return XmpNumber(xmp, "AbsoluteAltitude");
  return XmpNumber(xmp, "GPSAltitudeRef") == 1.0 ? -*altitude : *altitude;
}

CaptureHeights Heights(const Metadata& metadata) {
  CaptureHeights heights;
  heights.depth = Number(metadata.exif, "Exif.Photo.0x9403");  // WaterDepth
  for (const char* name : {"WaterDepth", "Depth", "depth"}) {
    if (!heights.depth) heights.depth = XmpNumber(metadata.xmp, name);
  }
  heights.altitude = Number(metadata.exif, "Exif.GPSInfo.GPSAltitude");
  if (heights.altitude && Number(metadata.exif, "Exif.GPSInfo.GPSAltitudeRef").value_or(0) == 1) {
    heights.altitude = -*heights.altitude;
  }
  if (!heights.altitude) heights.altitude = XmpAltitude(metadata.xmp);
  heights.above_start = XmpNumber(metadata.xmp, "RelativeAltitude");
  return heights;
}

// "2016:06:23 16:31:59.25".
std::string Taken(const Exiv2::ExifData& exif) {
  const std::string time = Text(exif, "Exif.Photo.DateTimeOriginal");
  const std::string fraction = Text(exif, "Exif.Photo.SubSecTimeOriginal");
  if (time.empty() || fraction.empty() ||
      fraction.find_first_not_of("0123456789") != std::string::npos) {
    return time;
  }
  return time + "." + fraction;
}

ExifInfo InfoOf(const Metadata& metadata) {
  const Exiv2::ExifData& exif = metadata.exif;
  ExifInfo info;
  info.camera = CameraOf(exif);
  const double orientation = Number(exif, "Exif.Image.Orientation").value_or(1);
  if (orientation >= 1 && orientation <= 8) info.orientation = static_cast<int>(orientation);
  info.heights = Heights(metadata);
  info.gps = GpsOfExif(exif);
  if (!info.gps) {
    info.gps = GpsOfXmp(metadata.xmp);
    if (info.gps) info.gps->altitude_m = info.heights.altitude.value_or(0);
  }
  info.taken = Taken(exif);
  return info;
}

// nullopt for what Exiv2 cannot read.
std::optional<Metadata> TryToRead(const std::filesystem::path& path) {
  try {
    const auto image = Exiv2::ImageFactory::open(path.string());
    image->readMetadata();
    return Metadata{image->exifData(), image->xmpData()};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // Exiv2's own errors among them
    return std::nullopt;
  }
}

}  // namespace

std::unique_lock<std::mutex> HoldExiv2() {
  static std::mutex mutex;
  std::unique_lock<std::mutex> lock(mutex);
  static const bool is_set_up = [] {
    Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
    return Exiv2::XmpParser::initialize();
  }();
  static_cast<void>(is_set_up);
  return lock;
}

ExifInfo ReadExif(const std::filesystem::path& path) {
  const auto held = HoldExiv2();
  auto metadata = TryToRead(path);
  if (!metadata) {
    // A disk that fails looks to Exiv2 like damaged EXIF: it is read here, where both are told
    // apart. If it can be read by now, so may the EXIF.
    ReadAll(OpenImageFile(path));
    metadata = TryToRead(path);
  }
  return InfoOf(metadata.value_or(Metadata()));
}

}  // namespace colmap_seapoint
