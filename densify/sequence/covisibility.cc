#include "densify/sequence/covisibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace colmap_seapoint {

namespace {

constexpr size_t kMaxCovisible = 12;

// Of the triangulated points that a picture sees, ascending.
std::vector<uint64_t> SortedPointIds(const PosedImage& image) {
  std::vector<uint64_t> ids;
  for (const uint64_t id : image.point3D_ids) {
    if (id != kNoPoint3D) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace

double ParallaxDeg(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2) {
  const double cosine = (point - center1).normalized().dot((point - center2).normalized());
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
}

std::vector<std::vector<int>> CovisiblePictures(const SparseModel& model,
                                                const std::vector<int>& order) {
  std::map<uint32_t, int> position_of;
  for (size_t position = 0; position < order.size(); ++position) {
    position_of[model.images[static_cast<size_t>(order[position])].image_id] =
        static_cast<int>(position);
  }
  std::vector<std::map<int, int>> shared(order.size());
  for (const auto& [id, point] : model.points3D) {
    for (const auto& a : point.track) {
      for (const auto& b : point.track) {
        const auto first = position_of.find(a.image_id), second = position_of.find(b.image_id);
        if (first == position_of.end() || second == position_of.end() || first == second) continue;
        ++shared[static_cast<size_t>(first->second)][second->second];
      }
    }
  }
  std::vector<std::vector<int>> covisible(order.size());
  for (size_t position = 0; position < order.size(); ++position) {
    std::vector<std::pair<int, int>> ranked;  // (-shared points, position)
    for (const auto& [other, count] : shared[position]) ranked.emplace_back(-count, other);
    std::sort(ranked.begin(), ranked.end());
    if (ranked.size() > kMaxCovisible) ranked.resize(kMaxCovisible);
    for (const auto& entry : ranked) covisible[position].push_back(entry.second);
  }
  return covisible;
}

double MedianParallaxDeg(const SparseModel& model, const PosedImage& image1,
                         const PosedImage& image2) {
  const Eigen::Vector3d center1 = image1.cam_from_world.OriginInSource();
  const Eigen::Vector3d center2 = image2.cam_from_world.OriginInSource();
  const std::vector<uint64_t> ids1 = SortedPointIds(image1), ids2 = SortedPointIds(image2);
  std::vector<uint64_t> shared;
  std::set_intersection(ids1.begin(), ids1.end(), ids2.begin(), ids2.end(),
                        std::back_inserter(shared));
  if (shared.empty()) return 0;
  std::vector<double> angles;
  for (const uint64_t id : shared) {
    angles.push_back(ParallaxDeg(model.points3D.at(id).xyz, center1, center2));
  }
  std::nth_element(angles.begin(), angles.begin() + static_cast<long>(angles.size() / 2),
                   angles.end());
  return angles[angles.size() / 2];
}

double SharedShare(const SparseModel& model, const PosedImage& image, const View& other) {
  int64_t all = 0, shared = 0;
  for (const uint64_t id : image.point3D_ids) {
    if (id == kNoPoint3D) continue;
    ++all;
    const auto pixel = other.camera.ImgFromCam(other.cam_from_world * model.points3D.at(id).xyz);
    shared += pixel && other.camera.InImage(*pixel);
  }
  return all == 0 ? 0 : static_cast<double>(shared) / static_cast<double>(all);
}

}  // namespace colmap_seapoint
