// Where pictures, SeaPoints and matches come from: files and databases belong to whoever implements
// this; densification knows none of them.
#pragma once

#include <optional>
#include <string>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/picture.h"

namespace colmap_seapoint {

// image_idx is the position in SparseModel::images. What is stored is read; only what is not is
// worked out anew.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  // Throws Error for a picture that is missing, unreadable or of another size than its camera.
  // Called from several threads at once; the others are not.
  virtual Picture ReadPicture(int image_idx) = 0;
  // nullopt: none are stored. Throws Error for damaged ones.
  virtual std::optional<Features> ReadSeaPoints(int image_idx) = 0;
  // None where the picture's mask is 0.
  virtual Features FindSeaPoints(const Picture& picture) = 0;
  // Indices into the points of ReadSeaPoints. nullopt: none are stored, or either picture's
  // SeaPoints are not.
  virtual std::optional<FeatureMatches> ReadMatches(int image_idx1, int image_idx2) = 0;
  virtual FeatureMatches Match(const Features& features1, const Features& features2) = 0;
};

// A picture that could not be read, and why.
struct LeftOutPicture {
  int image_idx = -1;
  std::string reason;
};

}  // namespace colmap_seapoint
