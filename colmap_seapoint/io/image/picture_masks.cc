#include "colmap_seapoint/io/image/picture_masks.h"

#include <algorithm>
#include <system_error>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/content_hash.h"

namespace colmap_seapoint {
namespace {

std::string SizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string OtherSize(int mask_width, int mask_height, int width, int height) {
  return "its mask is of another size than the picture: " + SizeText(mask_width, mask_height) +
         ", of other proportions than " + SizeText(width, height);
}

[[noreturn]] void ThrowBadMask(const std::filesystem::path& path, const Error& failure) {
  throw Error(path.string(), "its mask " + failure.Finding(), "repair or remove the mask");
}

// The nearest pixel of the mask for each of the picture.
GrayImage Resized(const GrayImage& mask, int width, int height) {
  GrayImage resized(width, height);
  for (int y = 0; y < height; ++y) {
    const int64_t from_y = (2 * int64_t{y} + 1) * mask.height / (2 * int64_t{height});
    for (int x = 0; x < width; ++x) {
      const int64_t from_x = (2 * int64_t{x} + 1) * mask.width / (2 * int64_t{width});
      resized.At(x, y) = mask.At(static_cast<int>(from_x), static_cast<int>(from_y));
    }
  }
  return resized;
}

// The least value among a pixel and its neighbours of the row (or, turned, of the column).
GrayImage LeastAcrossAndTurned(const GrayImage& mask) {
  GrayImage turned(mask.height, mask.width);
  for (int y = 0; y < mask.height; ++y) {
    const uint8_t* row = mask.Row(y);
    for (int x = 0; x < mask.width; ++x) {
      turned.At(y, x) =
          std::min({row[std::max(0, x - 1)], row[x], row[std::min(mask.width - 1, x + 1)]});
    }
  }
  return turned;
}

}  // namespace

std::filesystem::path PictureMasks::PathOf(const std::string& name) const {
  return std::filesystem::path(mask_path_) / (name + ".png");
}

void PictureMasks::Check(const std::vector<std::string>& names, const std::string& option) const {
  if (mask_path_.empty()) return;
  if (!std::filesystem::is_directory(mask_path_)) {
    throw Error(mask_path_, "there is no such folder", "check " + option);
  }
  std::error_code ignored;
  const auto num_masks = std::count_if(names.begin(), names.end(), [&](const std::string& name) {
    return std::filesystem::exists(PathOf(name), ignored);
  });
  if (num_masks == 0 && !names.empty() && !std::filesystem::is_empty(mask_path_)) {
    throw Error(mask_path_, "holds a mask of no picture",
                "name each mask as its picture with .png behind, e.g. " + names.front() + ".png");
  }
  LogInfo("Masks: of " + std::to_string(num_masks) + " of " + std::to_string(names.size()) +
          " pictures, in " + mask_path_);
}

std::string PictureMasks::Problem(const std::string& name, int width, int height) const {
  std::error_code error;
  if (mask_path_.empty() || !std::filesystem::exists(PathOf(name), error)) return "";
  try {
    const ImageInfo mask = ReadImageInfo(PathOf(name));
    if (AreScaledSizes(mask.width, mask.height, width, height)) return "";
    return OtherSize(mask.width, mask.height, width, height);
  } catch (const Error& failure) {
    return "its mask " + failure.Finding();
  }
}

std::optional<PictureFile> PictureMasks::Open(const std::string& name) const {
  if (mask_path_.empty()) return std::nullopt;
  std::error_code error;
  if (!std::filesystem::exists(PathOf(name), error)) return std::nullopt;
  try {
    return PictureFile(PathOf(name));
  } catch (const Error& failure) {
    ThrowBadMask(PathOf(name), failure);
  }
}

GrayImage PictureMasks::Decode(const std::string& name, const std::optional<PictureFile>& file,
                               int width, int height) const {
  if (!file) return {};
  GrayImage mask;
  try {
    mask = file->DecodeMask();
  } catch (const Error& failure) {
    ThrowBadMask(PathOf(name), failure);
  }
  if (mask.width == width && mask.height == height) return mask;
  if (AreScaledSizes(mask.width, mask.height, width, height)) return Resized(mask, width, height);
  throw Error(PathOf(name).string(), OtherSize(mask.width, mask.height, width, height),
              "make the mask as large as its picture");
}

GrayImage PictureMasks::ReadForResampling(const std::string& name, int width, int height) const {
  const GrayImage mask = Decode(name, Open(name), width, height);
  if (mask.Empty()) return mask;
  return LeastAcrossAndTurned(LeastAcrossAndTurned(mask));
}

std::string PictureMasks::Fingerprint(const std::vector<std::string>& names) const {
  if (mask_path_.empty()) return "";
  std::string text;
  for (const std::string& name : names) {
    std::error_code ignored;
    if (!std::filesystem::exists(PathOf(name), ignored)) continue;
    try {
      text += name + " " + HashFile(PathOf(name)) + "\n";
    } catch (const Error& failure) {
      text += name + " " + failure.Finding() + "\n";  // its picture is left out, and named
    }
  }
  return HashText(text);
}

}  // namespace colmap_seapoint
