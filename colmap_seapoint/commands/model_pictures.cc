#include "colmap_seapoint/commands/model_pictures.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/image_file.h"

namespace colmap_seapoint {

ModelPictures::ModelPictures(const SparseModel& model, const std::filesystem::path& image_path,
                             const std::string& database_path,
                             const SeaPointExtractionOptions& extraction,
                             const SeaPointMatchingOptions& matching)
    : model_(model), image_path_(image_path), extraction_(extraction), matching_(matching) {
  if (database_path.empty()) return;
  database_.emplace(database_path, ColmapDatabase::Mode::kReadOnly);
  store_.emplace(&*database_);
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
  ColorImage picture = ReadColorImage(PathOf(image_idx));
  const std::string problem = CheckSize(image_idx, picture.width, picture.height);
  if (problem.empty()) return picture;
  throw Error(PathOf(image_idx).string(), problem,
              "give the pictures that the model was made from");
}

Features ModelPictures::ReadSeaPoints(int image_idx) {
  const auto id = database_ids_.find(ImageAt(image_idx).name);
  if (id != database_ids_.end()) {
    const auto features = store_->Read(id->second);
    if (features != nullptr) return *features;
  }
  const GrayImage picture = ReadGrayImage(PathOf(image_idx));
  return ExtractFeatures(picture, GrayImage(), extraction_).features;
}

FeatureMatches ModelPictures::Match(const Features& features1, const Features& features2) {
  return MatchSeaPoints(features1, features2, matching_);
}

}  // namespace colmap_seapoint
