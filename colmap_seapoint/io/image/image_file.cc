#include "colmap_seapoint/io/image/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/image/image_codecs.h"
#include "colmap_seapoint/io/image/image_exif.h"
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

bool HasImageExtension(const std::filesystem::path& path) {
  static const std::set<std::string> kExtensions = {".jpg", ".jpeg", ".png", ".tif", ".tiff",
                                                    ".bmp", ".webp", ".ppm", ".pgm", ".jp2"};
  return kExtensions.count(LowerExtension(path)) > 0;
}

bool IsWithin(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Walks a folder and those below it, links to folders included: each is walked once, so that links
// that go in circles, or to what is read anyway, do no harm.
class PictureFinder {
 public:
  explicit PictureFinder(const std::filesystem::path& root) : root_(root) {
    walked_.push_back(std::filesystem::canonical(root));
  }

  // Names of all pictures below `folder`, in the order of their names in each folder.
  void Find(const std::filesystem::path& folder) {
    std::vector<std::filesystem::directory_entry> entries(
        std::filesystem::directory_iterator(folder), {});
    std::sort(entries.begin(), entries.end());
    for (const auto& entry : entries) {
      std::error_code ignored;
      if (entry.path().filename().string().front() == '.') continue;
      if (entry.is_directory(ignored)) {
        if (!entry.is_symlink(ignored) || IsNew(entry.path())) Find(entry.path());
      } else if (HasImageExtension(entry.path()) && entry.is_regular_file(ignored)) {
        AddPicture(entry.path());
      }
    }
  }

  std::vector<std::string> Names() && { return std::move(names_); }

 private:
  // False for a link to what is walked, or to what holds it.
  bool IsNew(const std::filesystem::path& link) {
    std::error_code error;
    const auto target = std::filesystem::canonical(link, error);
    if (error) return false;
    for (const auto& folder : walked_) {
      if (IsWithin(target, folder) || IsWithin(folder, target)) return false;
    }
    walked_.push_back(target);
    return true;
  }

  void AddPicture(const std::filesystem::path& path) {
    names_.push_back(path.lexically_relative(root_).generic_string());
    if (IsSafeImageName(names_.back())) return;
    throw Error(path.string(), "has a backslash or a control character in its name",
                "rename the picture");
  }

  std::filesystem::path root_;
  std::vector<std::filesystem::path> walked_;
  std::vector<std::string> names_;
};

std::vector<std::string> FindImages(const std::filesystem::path& folder) {
  PictureFinder finder(folder);
  finder.Find(folder);
  return std::move(finder).Names();
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
  if (head[0] == 'P' && head[1] >= '1' && head[1] <= '6') return ImageFormat::kPnm;
  throw Error(path.string(), "is no picture of a known format",
              "convert it to JPEG, PNG or TIFF, or take it out of the folder");
}

std::vector<std::string> ListImages(const std::filesystem::path& image_path) {
  std::error_code error;
  if (!std::filesystem::is_directory(image_path, error)) {
    throw Error(image_path.string(), "there is no such folder", "check --image_path");
  }
  std::vector<std::string> names;
  try {
    names = FindImages(image_path);
  } catch (const std::filesystem::filesystem_error& failure) {
    throw Error(failure.path1().empty() ? image_path.string() : failure.path1().string(),
                "cannot be read (" + failure.code().message() + ")",
                "check the folder's permissions");
  }
  if (names.empty()) {
    throw Error(image_path.string(), "holds no picture (jpg png tif bmp webp ppm pgm jp2)",
                "check --image_path");
  }
  std::sort(names.begin(), names.end());
  return names;
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
  ExifInfo exif = ReadExif(path, size);
  ImageInfo info;
  info.width = size.width;
  info.height = size.height;
  info.focal_length_px = exif.focal_length_px;
  info.exif_orientation = exif.orientation;
  info.gps = exif.gps;
  info.camera_key = std::move(exif.camera_key);
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

void WriteImage(const std::filesystem::path& path, const Image<uint8_t>& image) {
  SEAPOINT_CHECK(!image.Empty() && (image.channels == 1 || image.channels == 3));
  std::vector<uint8_t> bytes;
  bool is_encoded = false;
  try {
    const Image<uint8_t> swapped =
        image.channels == 3 ? Convert(image, 3, cv::COLOR_RGB2BGR) : image;
    is_encoded = cv::imencode(LowerExtension(path), AsMat(swapped), bytes);
  } catch (const cv::Exception&) {
    is_encoded = false;
  }
  if (!is_encoded) {
    throw Error(path.string(), "a picture cannot be written in the format of this extension",
                "use png, jpg or tif");
  }
  AtomicFile file(path);
  file.Write(bytes.data(), bytes.size());
  file.Commit();
}

}  // namespace colmap_seapoint
