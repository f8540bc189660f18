#include "colmap_seapoint/io/image/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_exif.h"
#include "colmap_seapoint/io/image/image_folder.h"
#include "colmap_seapoint/io/image/image_limits.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/system/memory_limit.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kMaxSide = 1u << 20;
constexpr uint64_t kMaxPixels = 1u << 30;

std::string LowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

// 1 or 3 channels.
Image<uint8_t> DecodePixels(const ImageSource& source) {
  switch (DetectImageFormat(source)) {
    case ImageFormat::kJpeg:
      return DecodeJpeg(source);
    case ImageFormat::kPng:
      return DecodePng(source);
    case ImageFormat::kTiff:
      return DecodeTiff(source);
    case ImageFormat::kPnm:
      return DecodePnm(source);
    case ImageFormat::kBmp:
      return DecodeBmp(source);
    case ImageFormat::kWebp:
      return DecodeWebp(source);
  }
  SEAPOINT_CHECK(false);
  return {};
}

Picture DecodePlanes(const ImageSource& source, JpegContent content) {
  if (DetectImageFormat(source) == ImageFormat::kJpeg) return DecodeJpegPlanes(source, content);
  Image<uint8_t> image = DecodePixels(source);
  Picture picture;
  if (image.channels == 1) {
    picture.luma = std::move(image);
  } else if (content == JpegContent::kLuma) {
    picture.luma = LumaOf(image);
  } else {
    picture = PictureOf(image);
  }
  return picture;
}

ImageHeader ReadHeader(const ImageSource& source) {
  switch (DetectImageFormat(source)) {
    case ImageFormat::kJpeg:
      return ReadJpegHeader(source);
    case ImageFormat::kPng:
      return ReadPngHeader(source);
    case ImageFormat::kTiff:
      return ReadTiffHeader(source);
    case ImageFormat::kPnm:
      return ReadPnmHeader(source);
    case ImageFormat::kBmp:
      return ReadBmpHeader(source);
    case ImageFormat::kWebp:
      return ReadWebpHeader(source);
  }
  SEAPOINT_CHECK(false);
  return {};
}

// The size of a picture that is worth decoding. The formats' libraries take a disk that fails for
// the end of the file.
ImageSize ReadSize(const ImageSource& source) {
  try {
    const ImageHeader header = ReadHeader(source);
    BytesToDecode(source, header);
    return header.size;
  } catch (const Error&) {
    if (std::ferror(source.file.get()) != 0) throw ReadError(source.path, EIO);
    throw;
  }
}

bool IsAboutMemory(const std::string& finding) {
  return finding.find("nsufficient memory") != std::string::npos ||
         finding.find("ut of memory") != std::string::npos;
}

cv::Mat AsMat(const Image<uint8_t>& image) {
  return cv::Mat(image.height, image.width, CV_8UC(image.channels),
                 const_cast<uint8_t*>(image.data.data()));
}

Image<uint8_t> Convert(const Image<uint8_t>& image, int num_channels, int code) {
  Image<uint8_t> converted(image.width, image.height, num_channels);
  cv::Mat target = AsMat(converted);
  cv::cvtColor(AsMat(image), target, code);
  SEAPOINT_CHECK(target.data == converted.data.data());
  return converted;
}

// Throws cv::Exception for an extension without an encoder.
std::vector<uint8_t> Encode(const Image<uint8_t>& image, const std::string& extension,
                            const std::vector<int>& settings) {
  SEAPOINT_CHECK(!image.Empty());
  const Image<uint8_t> swapped = image.channels == 3   ? Convert(image, 3, cv::COLOR_RGB2BGR)
                                 : image.channels == 4 ? Convert(image, 4, cv::COLOR_RGBA2BGRA)
                                                       : image;
  std::vector<uint8_t> bytes;
  const bool is_encoded = cv::imencode(extension, AsMat(swapped), bytes, settings);
  SEAPOINT_CHECK(is_encoded);
  return bytes;
}

}  // namespace

ImageSource OpenImageFile(const std::filesystem::path& path) {
  FileHandle file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) throw ReadError(path, errno);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw Error(path.string(), "is no file", "give a picture");
  }
  const uint64_t size = std::filesystem::file_size(path, error);
  return {path, std::move(file), error ? 0 : size};
}

ImageSource OpenImageBytes(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  FileHandle file(fmemopen(const_cast<uint8_t*>(bytes.data()), bytes.size(), "rb"), &std::fclose);
  if (file == nullptr) throw std::bad_alloc();
  return {path, std::move(file), bytes.size()};
}

std::vector<uint8_t> ReadAll(const ImageSource& source) {
  std::rewind(source.file.get());
  std::vector<uint8_t> bytes(source.size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), source.file.get()));
  if (std::ferror(source.file.get()) != 0) throw ReadError(source.path, errno);
  return bytes;
}

void ThrowDamagedImage(const std::filesystem::path& path, const std::string& finding) {
  if (IsAboutMemory(finding)) throw std::bad_alloc();
  throw Error(path.string(), "cannot be decoded whole (" + finding + ")",
              "copy the picture again from its source, or take it out of the folder");
}

ImageSize CheckImageSize(const std::filesystem::path& path, uint64_t width, uint64_t height) {
  if (width == 0 || height == 0) ThrowDamagedImage(path, "it has no pixels");
  if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels) {
    throw Error(path.string(),
                "is too large: " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels, the limit is " + std::to_string(kMaxPixels),
                "make the picture smaller, or cut it into parts");
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

ImageFormat DetectImageFormat(const ImageSource& source) {
  const std::filesystem::path& path = source.path;
  char head[12] = {0};
  const size_t size = std::fread(head, 1, sizeof(head), source.file.get());
  if (std::ferror(source.file.get()) != 0) throw ReadError(path, errno);
  std::rewind(source.file.get());
  if (size == 0) {
    throw Error(path.string(), "is empty (zero bytes)",
                "copy the picture again from its source, or take it out of the folder");
  }
  auto starts_with = [&](const char* magic, size_t length) {
    return size >= length && std::memcmp(head, magic, length) == 0;
  };
  if (starts_with("\xff\xd8\xff", 3)) return ImageFormat::kJpeg;
  if (starts_with("\x89PNG\r\n\x1a\n", 8)) return ImageFormat::kPng;
  if (starts_with("II*\0", 4) || starts_with("MM\0*", 4) || starts_with("II+\0", 4) ||
      starts_with("MM\0+", 4)) {
    return ImageFormat::kTiff;
  }
  if (starts_with("BM", 2)) return ImageFormat::kBmp;
  if (starts_with("RIFF", 4) && size == 12 && std::memcmp(head + 8, "WEBP", 4) == 0) {
    return ImageFormat::kWebp;
  }
  if (starts_with("\0\0\0\x0cjP  ", 8) || starts_with("\xff\x4f\xff\x51", 4)) {
    throw Error(path.string(), "is JPEG 2000, which no camera writes and is not decoded",
                "convert it to JPEG, PNG or TIFF, or take it out of the folder");
  }
  if (size == sizeof(head) && std::memcmp(head + 4, "ftyphe", 6) == 0) {
    throw Error(path.string(), "is HEIC by its content", "rename it to .heic");
  }
  if (head[0] == 'P' && head[1] >= '1' && head[1] <= '6') return ImageFormat::kPnm;
  throw Error(path.string(), "is no picture of a known format",
              "convert it to JPEG, PNG or TIFF, or take it out of the folder");
}

std::vector<std::string> ListImages(const std::filesystem::path& image_path) {
  const FolderListing listing = ListFolder(image_path);
  if (!listing.pictures.empty()) return listing.pictures;
  const std::string kinds = "holds no picture (jpg png tif bmp webp ppm pgm jp2)";
  if (!listing.camera_pictures.empty()) {
    throw Error(
        image_path.string(),
        kinds + ", but " + std::to_string(listing.camera_pictures.size()) + " of HEIC or RAW",
        "let automatic_reconstructor take it, which decodes them, or convert them to JPEG");
  }
  if (!listing.videos.empty()) {
    throw Error(image_path.string(),
                kinds + ", but " + std::to_string(listing.videos.size()) + " videos",
                "let automatic_reconstructor take it, which chooses their frames");
  }
  throw Error(image_path.string(), kinds, "put the pictures there, or give another --image_path");
}

std::vector<std::string> ReadImageList(const std::filesystem::path& list_path) {
  InputStream stream(list_path);
  std::vector<std::string> names;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const size_t last = line.find_last_not_of(" \t\r");
    line.resize(last == std::string::npos ? 0 : last + 1);
    if (line.empty() || line.front() == '#') continue;
    if (!IsSafeImageName(line)) {
      throw Error(list_path.string(),
                  "line " + std::to_string(number) + ": '" + line +
                      "' is absolute or leads out of the image folder",
                  "give names relative to --image_path, with '/' between folders");
    }
    names.push_back(line);
  }
  if (names.empty()) {
    throw Error(list_path.string(), "names no picture", "give one name a line");
  }
  return names;
}

bool IsSafeImageName(const std::string& name) {
  if (name.empty()) return false;
  for (const char c : name) {
    if (c == '\\' || c == '\0' || c == '\n' || c == '\r') return false;
  }
  for (size_t begin = 0; begin <= name.size();) {
    const size_t end = std::min(name.find('/', begin), name.size());
    const std::string component = name.substr(begin, end - begin);
    if (component.empty() || component == "..") return false;
    begin = end + 1;
  }
  return true;
}

ImageInfo ReadImageInfo(const std::filesystem::path& path) {
  const ImageSize size = ReadSize(OpenImageFile(path));
  ExifInfo exif = ReadExif(path);
  ImageInfo info;
  info.width = size.width;
  info.height = size.height;
  info.exif_orientation = exif.orientation;
  info.gps = exif.gps;
  info.camera = std::move(exif.camera);
  info.heights = exif.heights;
  info.taken = std::move(exif.taken);
  return info;
}

PictureFile::PictureFile(const std::filesystem::path& path) : path_(path) {
  const ImageSource source = OpenImageFile(path);
  DetectImageFormat(source);
  if (source.size > MaxMemory()) {
    throw Error(path.string(), "is longer than --max_memory: " + BytesText(source.size),
                "raise --max_memory, or take it out of the folder");
  }
  bytes_ = ReadAll(source);
}

std::string PictureFile::Hash() const { return HashBytes(bytes_.data(), bytes_.size()); }

uint64_t PictureFile::BytesToDecode() const {
  return colmap_seapoint::BytesToDecode(OpenImageBytes(path_, bytes_),
                                        ReadHeader(OpenImageBytes(path_, bytes_)));
}

GrayImage PictureFile::DecodeMask() const {
  GrayImage mask = DecodeGray();  // refuses what is not whole
  const cv::Mat full = cv::imdecode(bytes_, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH);
  if (full.type() != CV_16UC1 || full.cols != mask.width || full.rows != mask.height) return mask;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) mask.At(x, y) = full.at<uint16_t>(y, x) != 0 ? 255 : 0;
  }
  return mask;
}

GrayImage PictureFile::DecodeGray() const {
  return DecodePlanes(OpenImageBytes(path_, bytes_), JpegContent::kLuma).luma;
}

Picture PictureFile::Decode() const {
  return DecodePlanes(OpenImageBytes(path_, bytes_), JpegContent::kPlanes);
}

ColorImage PictureFile::DecodeColor() const {
  Image<uint8_t> image = DecodePixels(OpenImageBytes(path_, bytes_));
  return image.channels == 3 ? image : Convert(image, 3, cv::COLOR_GRAY2RGB);
}

GrayImage ReadGrayImage(const std::filesystem::path& path) {
  return PictureFile(path).DecodeGray();
}

Picture ReadPicture(const std::filesystem::path& path) { return PictureFile(path).Decode(); }

ColorImage ReadColorImage(const std::filesystem::path& path) {
  return PictureFile(path).DecodeColor();
}

std::vector<uint8_t> EncodePng(const Image<uint8_t>& image) {
  return Encode(image, ".png", {cv::IMWRITE_PNG_COMPRESSION, 6});
}

std::vector<uint8_t> EncodeJpeg(const Image<uint8_t>& image, int quality) {
  return Encode(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

void WriteImage(const std::filesystem::path& path, const Image<uint8_t>& image) {
  SEAPOINT_CHECK(image.channels == 1 || image.channels == 3);
  std::vector<uint8_t> bytes;
  try {
    bytes = Encode(image, LowerExtension(path), {});
  } catch (const cv::Exception&) {
    throw Error(path.string(), "a picture cannot be written in the format of this extension",
                "use png, jpg or tif");
  }
  AtomicFile file(path);
  file.Write(bytes.data(), bytes.size());
  file.Commit();
}

}  // namespace colmap_seapoint
