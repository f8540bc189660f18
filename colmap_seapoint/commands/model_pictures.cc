#include "colmap_seapoint/commands/model_pictures.h"

#include <algorithm>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/image_file.h"

namespace colmap_seapoint {

ModelPictures::ModelPictures(const SparseModel& model, const std::filesystem::path& image_path,
                             const std::string& database_path,
                             const SeaPointExtractionOptions& extraction,
                             const SeaPointMatchingOptions& matching)
    : model_(model),
      image_path_(image_path),
      extraction_(extraction),
      matching_(matching),
      has_stored_(model.images.size()) {
  if (database_path.empty()) return;
  database_.emplace(database_path, ColmapDatabase::Mode::kReadOnly);
  for (const DatabaseImage& image : database_->ReadImages()) {
    if (database_->FeaturesFingerprint(image.image_id)) database_ids_[image.name] = image.image_id;
  }
  for (const PosedImage& image : model_.images) {
    num_in_database_ += static_cast<int>(database_ids_.count(image.name));
  }
}

const PosedImage& ModelPictures::ImageAt(int image_idx) const {
  return model_.images.at(static_cast<size_t>(image_idx));
}

std::filesystem::path ModelPictures::PathOf(int image_idx) const {
  const std::string& name = ImageAt(image_idx).name;
  SEAPOINT_CHECK(IsSafeImageName(name));  // ReadSparseModel refuses others
  return image_path_ / name;
}

std::string ModelPictures::CheckSize(int image_idx, int width, int height) const {
  const Camera& camera = model_.cameras.at(ImageAt(image_idx).camera_id);
  if (width == camera.width && height == camera.height) return "";
  return "is " + std::to_string(width) + "x" + std::to_string(height) +
         " but its camera in the model is " + std::to_string(camera.width) + "x" +
         std::to_string(camera.height);
}

std::string ModelPictures::Check(int image_idx) const {
  try {
    const ImageInfo info = ReadImageInfo(PathOf(image_idx));
    return CheckSize(image_idx, info.width, info.height);
  } catch (const Error& error) {
    return error.Finding();
  }
}

ColorImage ModelPictures::ReadColor(int image_idx) {
  return WithCheckedSize(image_idx, ReadColorImage(PathOf(image_idx)));
}

GrayImage ModelPictures::ReadGray(int image_idx) {
  return WithCheckedSize(image_idx, ReadGrayImage(PathOf(image_idx)));
}

Image<uint8_t> ModelPictures::WithCheckedSize(int image_idx, Image<uint8_t> picture) const {
  const std::string problem = CheckSize(image_idx, picture.width, picture.height);
  if (problem.empty()) return picture;
  throw Error(PathOf(image_idx).string(), problem,
              "give the pictures that the model was made from");
}

std::optional<Features> ModelPictures::ReadSeaPoints(int image_idx) {
  const auto id = database_ids_.find(ImageAt(image_idx).name);
  if (id == database_ids_.end()) return std::nullopt;
  auto features = database_->ReadFeatures(id->second);
  has_stored_.at(static_cast<size_t>(image_idx)) = features.has_value();
  return features;
}

Features ModelPictures::FindSeaPoints(const GrayImage& picture) {
  return ExtractFeatures(picture, GrayImage(), extraction_).features;
}

bool ModelPictures::HasStoredSeaPoints(int image_idx) {
  std::optional<bool>& known = has_stored_.at(static_cast<size_t>(image_idx));
  if (!known) known = ReadSeaPoints(image_idx).has_value();
  return *known;
}

std::optional<FeatureMatches> ModelPictures::ReadMatches(int image_idx1, int image_idx2) {
  try {
    if (!HasStoredSeaPoints(image_idx1) || !HasStoredSeaPoints(image_idx2)) return std::nullopt;
    const uint32_t id1 = database_ids_.at(ImageAt(image_idx1).name);
    const uint32_t id2 = database_ids_.at(ImageAt(image_idx2).name);
    const ImagePair pair = std::minmax(id1, id2);
    const bool verified = database_->HasMatches(pair);
    FeatureMatches matches =
        verified ? database_->ReadTwoViewGeometry(pair).inliers : database_->ReadMatches(pair);
    if (!verified && matches.empty()) return std::nullopt;
    if (id1 > id2) {
      for (FeatureMatch& match : matches) std::swap(match.idx1, match.idx2);
    }
    return matches;
  } catch (const Error& error) {
    LogWarning(std::string(error.what()) + "; the pair is matched again");
    return std::nullopt;
  }
}

FeatureMatches ModelPictures::Match(const Features& features1, const Features& features2) {
  return MatchSeaPoints(features1, features2, matching_);
}

}  // namespace colmap_seapoint
