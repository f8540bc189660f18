// COLMAP's masks: <mask_path>/<image name>.png, 0 where a picture shows what is not to be used (a
// diver, the frame of the vehicle, open water).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {

// A picture without a mask is used as a whole. A mask may be of any depth, and larger or smaller
// than its picture in the same proportions. Safe for several threads.
class PictureMasks {
 public:
  // `mask_path`: "" = there are none.
  explicit PictureMasks(std::string mask_path) : mask_path_(std::move(mask_path)) {}

  // To be called before hours of work. Throws Error when the folder is not there, or holds
  // files, but a mask of none of the pictures; says how many have one. `option` is the one that
  // named the folder.
  void Check(const std::vector<std::string>& names, const std::string& option) const;

  // Why the mask of a picture of that size cannot be used, by its header; "" when it can, or there
  // is none.
  std::string Problem(const std::string& name, int width, int height) const;
  // nullopt when the picture has none. Throws Error for one that cannot be read.
  std::optional<PictureFile> Open(const std::string& name) const;
  // Of width x height, 0 where hidden; empty when `file` is nullopt. Throws Error for a mask that
  // cannot be decoded, and for one of other proportions: what it hides cannot be known.
  GrayImage Decode(const std::string& name, const std::optional<PictureFile>& file, int width,
                   int height) const;
  // Open and Decode at once, for a picture that is resampled: what is hidden is a pixel larger all
  // round, so that no neighbour of a hidden pixel mixes with it.
  GrayImage ReadForResampling(const std::string& name, int width, int height) const;

  // Changes whenever a mask of these pictures does; "" without masks. Reads all of them.
  std::string Fingerprint(const std::vector<std::string>& names) const;

 private:
  std::filesystem::path PathOf(const std::string& name) const;

  std::string mask_path_;
};

}  // namespace colmap_seapoint
