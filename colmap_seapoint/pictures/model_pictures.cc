#include "colmap_seapoint/pictures/model_pictures.h"

#include <algorithm>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

// Why a picture of this size does not belong to its camera, or "".
std::string SizeProblem(const Camera& camera, int width, int height) {
  if (width == camera.width && height == camera.height) return "";
  return "is " + std::to_string(width) + "x" + std::to_string(height) +
         " but its camera in the model is " + std::to_string(camera.width) + "x" +
         std::to_string(camera.height) + ", of other proportions";
}

}  // namespace

ModelPictures::ModelPictures(const SparseModel& model, const std::filesystem::path& image_path,
                             const PictureMasks& masks, ColmapDatabase* database,
                             const SeaPointExtractionOptions& extraction,
                             const SeaPointMatchingOptions& matching)
    : model_(model),
      image_path_(image_path),
      masks_(masks),
      database_(database),
      extraction_(extraction),
      matching_(matching),
      has_stored_(model.images.size()),
      described_(model.images.size()) {
  if (database_ == nullptr) return;
  const std::map<uint32_t, Camera> cameras = ReadCameras(*database_);
  std::unordered_map<std::string, const Camera*> camera_of;  // the model's
  for (const PosedImage& image : model_.images) {
    camera_of[image.name] = &model_.cameras.at(image.camera_id);
  }
  for (const DatabaseImage& image : ReadImages(*database_)) {
    const auto posed = camera_of.find(image.name);
    if (posed == camera_of.end() || !FeaturesFingerprint(*database_, image.image_id)) continue;
    const auto found_in = cameras.find(image.camera_id);
    const Camera& to = *posed->second;
    const Camera& from = found_in == cameras.end() ? to : found_in->second;
    if (!AreScaledSizes(from.width, from.height, to.width, to.height)) continue;
    in_database_[image.name] = {image.image_id,
                                static_cast<float>(to.width) / static_cast<float>(from.width),
                                static_cast<float>(to.height) / static_cast<float>(from.height)};
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

std::string ModelPictures::Check(int image_idx) const {
  try {
    const ImageInfo info = ReadImageInfo(PathOf(image_idx));
    const std::string problem =
        SizeProblem(model_.cameras.at(ImageAt(image_idx).camera_id), info.width, info.height);
    if (!problem.empty()) return problem;
    return masks_.Problem(ImageAt(image_idx).name, info.width, info.height);
  } catch (const Error& error) {
    return error.Finding();
  }
}

RunReport::Input ModelPictures::Describe(int image_idx) const {
  {
    const std::lock_guard<std::mutex> lock(described_mutex_);
    const auto& described = described_.at(static_cast<size_t>(image_idx));
    if (described) return *described;
  }
  return DescribeInput(ImageAt(image_idx).name, PathOf(image_idx));
}

Picture ModelPictures::ReadPicture(int image_idx) {
  const PictureFile file(PathOf(image_idx));
  {
    const std::lock_guard<std::mutex> lock(described_mutex_);
    auto& described = described_.at(static_cast<size_t>(image_idx));
    if (!described) described = {ImageAt(image_idx).name, file.Size(), file.Hash()};
  }
  Picture picture = file.Decode();
  const std::string problem = SizeProblem(model_.cameras.at(ImageAt(image_idx).camera_id),
                                          picture.luma.width, picture.luma.height);
  if (!problem.empty()) {
    throw Error(PathOf(image_idx).string(), problem,
                "give the pictures that the model was made from, reduced or in full");
  }
  picture.mask =
      masks_.ReadForResampling(ImageAt(image_idx).name, picture.luma.width, picture.luma.height);
  return picture;
}

std::optional<Features> ModelPictures::ReadSeaPoints(int image_idx) {
  const auto stored = in_database_.find(ImageAt(image_idx).name);
  if (stored == in_database_.end()) return std::nullopt;
  const auto [id, x_scale, y_scale] = stored->second;
  auto features = ReadFeatures(*database_, id);
  has_stored_.at(static_cast<size_t>(image_idx)) = features.has_value();
  if (!features || (x_scale == 1 && y_scale == 1)) return features;
  for (SeaPoint& point : features->points) {
    point.x *= x_scale;
    point.y *= y_scale;
    point.scale *= x_scale;
  }
  return features;
}

Features ModelPictures::FindSeaPoints(const Picture& picture) {
  return ExtractFeatures(picture.luma, picture.mask, extraction_).features;
}

bool ModelPictures::HasStoredSeaPoints(int image_idx) {
  std::optional<bool>& known = has_stored_.at(static_cast<size_t>(image_idx));
  if (!known) known = ReadSeaPoints(image_idx).has_value();
  return *known;
}

std::optional<FeatureMatches> ModelPictures::ReadMatches(int image_idx1, int image_idx2) {
  try {
    if (!HasStoredSeaPoints(image_idx1) || !HasStoredSeaPoints(image_idx2)) return std::nullopt;
    const uint32_t id1 = in_database_.at(ImageAt(image_idx1).name).image_id;
    const uint32_t id2 = in_database_.at(ImageAt(image_idx2).name).image_id;
    const ImagePair pair = std::minmax(id1, id2);
    const bool verified = HasMatches(*database_, pair);
    FeatureMatches matches = verified ? ReadTwoViewGeometry(*database_, pair).inliers
                                      : colmap_seapoint::ReadMatches(*database_, pair);
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
