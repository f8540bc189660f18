#include "colmap_seapoint/page/track.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPoints = 10;
constexpr size_t kMaxHints = 20;
// A point of the middle of three pictures is in two of them from here on.
constexpr double kLowOverlap = 0.5;
constexpr double kTooHigh = 1.5, kTooClose = 0.6;  // times the median distance
constexpr double kTooDark = 0.5;                   // times the median brightness

std::string FolderOf(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

std::vector<const SparsePoint*> PointsOf(const SparseModel& model, const PosedImage& image) {
  std::vector<const SparsePoint*> points;
  for (const uint64_t id : image.point3D_ids) {
    const auto place = model.points3D.find(id);
    if (place != model.points3D.end()) points.push_back(&place->second);
  }
  return points;
}

double ShareIn(const SparseModel& model, const std::vector<const SparsePoint*>& points,
               const PosedImage& image) {
  const Camera& camera = model.cameras.at(image.camera_id);
  size_t num_in = 0;
  for (const SparsePoint* point : points) {
    const auto pixel = camera.ImgFromCam(image.cam_from_world * point->xyz);
    if (pixel && camera.InImage(*pixel)) ++num_in;
  }
  return static_cast<double>(num_in) / static_cast<double>(points.size());
}

TrackPicture PictureAt(const TrackInput& input, int image_idx, const PosedImage* next) {
  const PosedImage& image = input.model->images[static_cast<size_t>(image_idx)];
  TrackPicture picture;
  picture.image_idx = image_idx;
  picture.center = image.cam_from_world.OriginInSource();
  picture.axis = image.cam_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  picture.covered = (*input.records)[static_cast<size_t>(image_idx)].Share(CellState::kCovered);
  const std::vector<const SparsePoint*> points = PointsOf(*input.model, image);
  if (points.size() < kMinPoints) return picture;
  std::vector<double> depths;
  for (const SparsePoint* point : points) {
    depths.push_back((image.cam_from_world * point->xyz).z());
  }
  picture.distance = UpperMedian(std::move(depths));
  if (next != nullptr) picture.overlap = ShareIn(*input.model, points, *next);
  return picture;
}

// Stretches of neighbours of which something holds.
std::vector<TrackHint> Stretches(size_t count, const std::function<bool(size_t)>& holds,
                                 const std::function<std::string(size_t, size_t)>& text) {
  std::vector<TrackHint> hints;
  for (size_t i = 0; i < count; ++i) {
    if (!holds(i)) continue;
    size_t last = i;
    while (last + 1 < count && holds(last + 1)) ++last;
    hints.push_back({text(i, last), static_cast<int>(i), static_cast<int>(last)});
    i = last;
  }
  return hints;
}

double MedianOver(const std::vector<TrackPicture>& track,
                  const std::function<double(const TrackPicture&)>& value_of) {
  std::vector<double> values;
  for (const TrackPicture& picture : track) {
    if (value_of(picture) > 0) values.push_back(value_of(picture));
  }
  return values.empty() ? 0 : UpperMedian(std::move(values));
}

}  // namespace

std::vector<TrackPicture> FollowTrack(const TrackInput& input) {
  const std::vector<PosedImage>& images = input.model->images;
  std::map<std::string, std::vector<int>> folders;
  for (size_t i = 0; i < images.size(); ++i) {
    folders[FolderOf(images[i].name)].push_back(static_cast<int>(i));
  }
  const auto image_at = [&](int i) -> const PosedImage& { return images[static_cast<size_t>(i)]; };
  std::vector<TrackPicture> track;
  for (auto& entry : folders) {
    std::vector<int>& order = entry.second;
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return NaturalLess(image_at(a).name, image_at(b).name); });
    for (size_t k = 0; k < order.size(); ++k) {
      const PosedImage* next = k + 1 < order.size() ? &image_at(order[k + 1]) : nullptr;
      track.push_back(PictureAt(input, order[k], next));
    }
  }
  return track;
}

std::vector<TrackHint> HintsOf(const TrackInput& input, const std::vector<TrackPicture>& track) {
  const double distance =
      MedianOver(track, [](const TrackPicture& picture) { return picture.distance; });
  const auto brightness_of = [&](const TrackPicture& picture) {
    return (*input.brightness)[static_cast<size_t>(picture.image_idx)];
  };
  const double brightness = MedianOver(track, brightness_of);
  std::vector<TrackHint> hints;
  const auto add = [&](const std::function<bool(const TrackPicture&)>& holds,
                       const std::function<std::string(size_t, size_t)>& text) {
    for (TrackHint& hint : Stretches(
             track.size(), [&](size_t i) { return holds(track[i]); }, text)) {
      hints.push_back(std::move(hint));
    }
  };
  add([](const TrackPicture& p) { return p.overlap >= 0 && p.overlap < kLowOverlap; },
      [&](size_t first, size_t last) {
        double least = 1;
        for (size_t i = first; i <= last; ++i) least = std::min(least, track[i].overlap);
        return Format("too fast, or turned: the next picture shows only %.0f %% of this one",
                      100 * least);
      });
  add([&](const TrackPicture& p) { return p.distance > kTooHigh * distance && distance > 0; },
      [&](size_t first, size_t) {
        return Format("too high: %.1f times as far from the ground as usual",
                      track[first].distance / distance);
      });
  add([&](const TrackPicture& p) { return p.distance > 0 && p.distance < kTooClose * distance; },
      [&](size_t first, size_t) {
        return Format("too close: %.2f of the usual distance, so that less is seen twice",
                      track[first].distance / distance);
      });
  add(
      [&](const TrackPicture& p) {
        return brightness_of(p) >= 0 && brightness_of(p) < kTooDark * brightness;
      },
      [&](size_t first, size_t) {
        return Format("too dark: %.2f of the usual brightness",
                      brightness_of(track[first]) / brightness);
      });
  std::stable_sort(hints.begin(), hints.end(), [](const TrackHint& a, const TrackHint& b) {
    return a.last - a.first > b.last - b.first;
  });
  hints.resize(std::min(hints.size(), kMaxHints));
  std::stable_sort(hints.begin(), hints.end(),
                   [](const TrackHint& a, const TrackHint& b) { return a.first < b.first; });
  return hints;
}

}  // namespace colmap_seapoint
