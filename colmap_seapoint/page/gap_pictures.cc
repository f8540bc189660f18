#include "colmap_seapoint/page/gap_pictures.h"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

struct Window {
  double left = 0, top = 0, width = 0, height = 0;  // pixels of the picture
};

struct Wanted {
  size_t gap = 0, slot = 0;
};

std::optional<Eigen::Vector2d> PixelOf(const SparseModel& model, const PosedImage& image,
                                       const Eigen::Vector3d& place) {
  return model.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * place);
}

// The picture's middle where the gap's own is not in it.
std::optional<Eigen::Vector2d> MiddleIn(const SparseModel& model, int image_idx,
                                        const Eigen::Vector3d& place) {
  const PosedImage& image = model.images[static_cast<size_t>(image_idx)];
  const auto pixel = PixelOf(model, image, place);
  if (!pixel || !model.cameras.at(image.camera_id).InImage(*pixel)) return std::nullopt;
  return pixel;
}

// Those that show the gap's middle first.
std::vector<int> ChoosePictures(const Gap& gap, const SparseModel& model) {
  std::vector<int> chosen = gap.pictures;
  std::stable_partition(chosen.begin(), chosen.end(),
                        [&](int i) { return MiddleIn(model, i, gap.centroid).has_value(); });
  chosen.resize(std::min(chosen.size(), kPicturesOfGap));
  return chosen;
}

using Rings = std::vector<std::vector<Eigen::Vector2d>>;

// In pixels of the picture; empty when a corner is behind the camera.
Rings OutlineIn(const SparseModel& model, const PosedImage& image, const Gap& gap) {
  Rings rings;
  for (const auto& corners : gap.outline) {
    auto& ring = rings.emplace_back();
    for (const Eigen::Vector3d& corner : corners) {
      const auto pixel = PixelOf(model, image, corner);
      if (!pixel) return {};
      ring.push_back(*pixel);
    }
  }
  return rings;
}

// Around what of the outline lies in the picture; all of the picture where nothing does.
Window WindowOf(const Camera& camera, const Rings& outline) {
  Eigen::Vector2d low(camera.width, camera.height), high(0, 0);
  for (const auto& ring : outline) {
    for (const Eigen::Vector2d& corner : ring) {
      if (!camera.InImage(corner)) continue;
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const Eigen::Vector2d size(camera.width, camera.height);
  if ((low.array() > high.array()).any()) return {0, 0, size.x(), size.y()};
  const double share =
      std::clamp(2 * ((high - low).array() / size.array()).maxCoeff(), 1.0 / 3, 1.0);
  const Eigen::Vector2d extent = share * size;
  const Eigen::Vector2d corner =
      (0.5 * (low + high - extent)).cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(size - extent);
  return {corner.x(), corner.y(), extent.x(), extent.y()};
}

ColorImage Cut(const ColorImage& picture, const Window& window, double factor) {
  const cv::Mat from(picture.height, picture.width, CV_8UC3,
                     const_cast<uint8_t*>(picture.data.data()));
  const cv::Rect wanted(static_cast<int>(window.left), static_cast<int>(window.top),
                        std::max(1, static_cast<int>(window.width)),
                        std::max(1, static_cast<int>(window.height)));
  const cv::Rect rect = wanted & cv::Rect(0, 0, picture.width, picture.height);
  ColorImage crop(std::max(1, static_cast<int>(factor * rect.width)),
                  std::max(1, static_cast<int>(factor * rect.height)), 3);
  cv::Mat to(crop.height, crop.width, CV_8UC3, crop.data.data());
  cv::resize(from(rect), to, to.size(), 0, 0, cv::INTER_AREA);
  return crop;
}

GapPicture MakeGapPicture(const SparseModel& model, const PosedImage& image, const Gap& gap,
                          const ColorImage& picture) {
  const Camera& camera = model.cameras.at(image.camera_id);
  GapPicture made;
  made.name = image.name;
  const auto middle = PixelOf(model, image, gap.centroid);
  made.shows_gap = middle && camera.InImage(*middle);
  made.outline = OutlineIn(model, image, gap);
  const Window window = WindowOf(camera, made.outline);
  const double factor = std::min(1.0, kGapPictureSide / std::max(window.width, window.height));
  made.crop = Cut(picture, window, factor);
  for (auto& ring : made.outline) {
    for (Eigen::Vector2d& corner : ring) {
      corner = factor * (corner - Eigen::Vector2d(window.left, window.top));
    }
  }
  return made;
}

}  // namespace

std::vector<std::vector<GapPicture>> CutGapPictures(
    const CompletenessResult& result, const SparseModel& model,
    const std::function<ColorImage(const std::string& name)>& read, int num_threads) {
  std::vector<std::vector<GapPicture>> made(result.gaps.size());
  std::map<int, std::vector<Wanted>> by_picture;
  for (size_t g = 0; g < std::min(result.gaps.size(), kGapsWithPictures); ++g) {
    const std::vector<int> chosen = ChoosePictures(result.gaps[g], model);
    for (size_t slot = 0; slot < chosen.size(); ++slot)
      by_picture[chosen[slot]].push_back({g, slot});
    made[g].resize(chosen.size());
  }
  const std::vector<std::pair<int, std::vector<Wanted>>> work(by_picture.begin(), by_picture.end());
  ParallelFor(num_threads, static_cast<int64_t>(work.size()), [&](int64_t index) {
    const auto& [image_idx, wanted] = work[static_cast<size_t>(index)];
    const PosedImage& image = model.images[static_cast<size_t>(image_idx)];
    const Camera& camera = model.cameras.at(image.camera_id);
    const ColorImage picture = read(image.name);
    if (picture.width != camera.width || picture.height != camera.height) return;
    for (const Wanted& want : wanted) {
      made[want.gap][want.slot] = MakeGapPicture(model, image, result.gaps[want.gap], picture);
    }
  });
  for (auto& pictures : made) {
    pictures.erase(std::remove_if(pictures.begin(), pictures.end(),
                                  [](const GapPicture& picture) { return picture.crop.Empty(); }),
                   pictures.end());
  }
  return made;
}

}  // namespace colmap_seapoint
