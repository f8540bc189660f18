#include "colmap_seapoint/io/colmap/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <system_error>
#include <unordered_map>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/colmap/colmap_model_internal.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

constexpr uint64_t kMaxImageSide = 1u << 20;
constexpr const char* kRemedy =
    "write the model again with COLMAP (e.g. colmap model_converter) or restore a copy";
constexpr const char* kFileStems[] = {"cameras", "images", "points3D"};

bool IsFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

bool HasAllFiles(const std::filesystem::path& dir, const std::string& extension) {
  for (const char* stem : kFileStems) {
    if (!IsFile(dir / (stem + extension))) return false;
  }
  return true;
}

[[noreturn]] void FailIncomplete(const std::filesystem::path& dir) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(dir, ignored)) {
    throw Error(dir.string(), "there is no such folder",
                "give the folder of a COLMAP model, e.g. sparse/0");
  }
  for (const std::string extension : {".bin", ".txt"}) {
    bool any = false;
    std::string missing;
    for (const char* stem : kFileStems) {
      if (IsFile(dir / (stem + extension))) {
        any = true;
      } else if (missing.empty()) {
        missing = stem + extension;
      }
    }
    if (any) {
      throw Error((dir / missing).string(), "this file of the model is missing", kRemedy);
    }
  }
  throw Error(dir.string(), "holds no COLMAP model (cameras, images, points3D as .bin or .txt)",
              "give the folder of a COLMAP model, e.g. sparse/0");
}

// Ids that point nowhere would be out-of-range reads in every later stage.
void CheckReferences(const std::filesystem::path& dir, const ModelBeingRead& read) {
  const SparseModel& model = read.model;
  std::unordered_map<uint32_t, size_t> num_features;  // by image_id
  std::set<std::string> names;
  auto fail = [&](const std::string& finding) {
    throw Error(dir.string(), "inconsistent model: " + finding, kRemedy);
  };
  for (size_t i = 0; i < model.images.size(); ++i) {
    const PosedImage& image = model.images[i];
    const std::string who = "image " + std::to_string(image.image_id) + " (" + image.name + ")";
    if (!num_features.emplace(image.image_id, read.num_features[i]).second)
      fail(who + " stands there twice");
    if (!names.insert(image.name).second) fail(who + ": another image has the same name");
    if (model.cameras.count(image.camera_id) == 0) {
      fail(who + " has camera " + std::to_string(image.camera_id) + ", which does not exist");
    }
    for (const uint64_t point3D_id : image.point3D_ids) {
      if (point3D_id != kNoPoint3D && model.points3D.count(point3D_id) == 0) {
        fail(who + " sees point " + std::to_string(point3D_id) + ", which does not exist");
      }
    }
  }
  for (const auto& [point3D_id, point] : model.points3D) {
    for (const SparsePoint::TrackElement& element : point.track) {
      const auto image = num_features.find(element.image_id);
      if (image == num_features.end() || element.point2D_idx >= image->second) {
        fail("point " + std::to_string(point3D_id) + " is seen by feature " +
             std::to_string(element.point2D_idx) + " of image " + std::to_string(element.image_id) +
             ", which does not exist");
      }
    }
  }
}

}  // namespace

void RecordPlace::Fail(const std::string& finding) const {
  throw Error(path_.string(), std::string(unit_) + " " + std::to_string(position_) + ": " + finding,
              kRemedy);
}

void AddCamera(const RecordPlace& place, uint32_t camera_id, int model_id, uint64_t width,
               uint64_t height, std::vector<double> params, ModelBeingRead* read) {
  const std::string who = "camera " + std::to_string(camera_id);
  if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide) {
    place.Fail(who + " has an impossible size of " + std::to_string(width) + " x " +
               std::to_string(height) + " pixels");
  }
  for (const double param : params) {
    if (!std::isfinite(param)) place.Fail(who + " has a parameter that is not finite");
  }
  Camera camera;
  camera.camera_id = camera_id;
  camera.model = static_cast<CameraModel>(model_id);
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  camera.params = std::move(params);
  if (camera.FocalX() <= 0 || camera.FocalY() <= 0) {
    place.Fail(who + " has a focal length that is not positive");
  }
  if (!read->model.cameras.emplace(camera_id, std::move(camera)).second) {
    place.Fail(who + " stands there twice");
  }
}

void AddImage(const RecordPlace& place, const Eigen::Vector4d& qvec, PosedImage* read_image,
              ModelBeingRead* read) {
  PosedImage& image = *read_image;
  const std::string who = "image " + std::to_string(image.image_id);
  if (!IsSafeImageName(image.name)) {
    place.Fail(who + " is named '" + image.name +
               "', which is empty, absolute or leads out of the image folder");
  }
  if (!std::isfinite(qvec.norm()) || !image.cam_from_world.translation.allFinite() ||
      qvec.norm() < 1e-6) {
    place.Fail(who + " has a pose that is not finite or no rotation");
  }
  image.cam_from_world.rotation =
      Eigen::Quaterniond(qvec[0], qvec[1], qvec[2], qvec[3]).normalized();
  for (const Eigen::Vector2d& point : image.points2D) {
    if (!point.allFinite()) place.Fail(who + " has a feature that is not finite");
  }
  read->num_features.push_back(image.points2D.size());
  if (read->content == ModelContent::kAll) {
    read->model.images.push_back(std::move(image));
    return;
  }
  const std::vector<uint64_t>& ids = image.point3D_ids;
  PosedImage kept{image.image_id, image.camera_id, image.name, image.cam_from_world, {}, {}};
  const auto num_none = std::count(ids.begin(), ids.end(), kNoPoint3D);
  kept.point3D_ids.reserve(ids.size() - static_cast<size_t>(num_none));
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(kept.point3D_ids),
               [](uint64_t id) { return id != kNoPoint3D; });
  if (read->content == ModelContent::kTriangulated) {
    kept.points2D.reserve(kept.point3D_ids.size());
    for (size_t i = 0; i < ids.size(); ++i) {
      if (ids[i] != kNoPoint3D) kept.points2D.push_back(image.points2D[i]);
    }
  }
  read->model.images.push_back(std::move(kept));
}

void AddPoint(const RecordPlace& place, uint64_t point3D_id, SparsePoint point,
              ModelBeingRead* read) {
  const std::string who = "point " + std::to_string(point3D_id);
  if (point3D_id == kNoPoint3D) place.Fail("a point has the id that means 'none'");
  point.track.shrink_to_fit();
  if (!point.xyz.allFinite() || !std::isfinite(point.error)) place.Fail(who + " is not finite");
  if (!read->model.points3D.emplace(point3D_id, std::move(point)).second) {
    place.Fail(who + " stands there twice");
  }
}

std::vector<Frame> ReadFrames(const std::filesystem::path& dir, const SparseModel& model) {
  const bool binary = HasAllFiles(dir, ".bin");
  const std::filesystem::path path = dir / (binary ? "frames.bin" : "frames.txt");
  if (!IsFile(path)) return {};
  std::set<uint64_t> known, used;
  for (const PosedImage& image : model.images) known.insert(image.image_id);
  std::vector<Frame> frames;
  for (const std::vector<uint64_t>& ids : binary ? ReadFramesBinary(path) : ReadFramesText(path)) {
    Frame frame;
    for (const uint64_t id : ids) {
      if (known.count(id) == 0) continue;
      if (!used.insert(id).second) {
        throw Error(path.string(), "image " + std::to_string(id) + " stands in two frames",
                    kRemedy);
      }
      frame.push_back(static_cast<uint32_t>(id));
    }
    if (frame.size() > 1) frames.push_back(frame);
  }
  return frames;
}

bool IsSparseModel(const std::filesystem::path& dir) {
  return HasAllFiles(dir, ".bin") || HasAllFiles(dir, ".txt");
}

std::vector<std::string> ModelFileNames() {
  std::vector<std::string> names = {"project.ini"};
  for (const std::string stem : {"cameras", "images", "points3D", "rigs", "frames"}) {
    for (const char* extension : {".bin", ".txt"}) names.push_back(stem + extension);
  }
  return names;
}

bool IsModelFile(const std::string& name) {
  const std::vector<std::string> names = ModelFileNames();
  return std::find(names.begin(), names.end(), name) != names.end();
}

SparseModel ReadSparseModel(const std::filesystem::path& dir, ModelContent content) {
  ModelBeingRead read;
  read.content = content;
  if (HasAllFiles(dir, ".bin")) {
    ReadModelBinary(dir, &read);
  } else if (HasAllFiles(dir, ".txt")) {
    ReadModelText(dir, &read);
  } else {
    FailIncomplete(dir);
  }
  CheckReferences(dir, read);
  return std::move(read.model);
}

void SortImagesById(SparseModel* model) {
  std::sort(model->images.begin(), model->images.end(),
            [](const PosedImage& a, const PosedImage& b) { return a.image_id < b.image_id; });
}

}  // namespace colmap_seapoint
