#include "colmap_seapoint/base/stereo_rig.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "colmap_seapoint/base/natural_order.h"

namespace colmap_seapoint {

namespace {

using Frames = std::vector<std::vector<uint32_t>>;

constexpr double kMinSharedPoints = 15;  // on average

// What is known of two cameras of one rig, over all frames; the smaller camera_id first.
struct CameraPair {
  uint32_t camera_id1, camera_id2;
  int num_frames = 0;
  int64_t num_shared = 0;  // points
  int num_left = 0;        // frames in which camera 1 stands on the left
};

std::vector<uint64_t> SortedPoints(const PosedImage& image) {
  std::vector<uint64_t> ids;
  for (const uint64_t id : image.point3D_ids) {
    if (id != kNoPoint3D) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

int64_t NumShared(const PosedImage& image1, const PosedImage& image2) {
  std::vector<uint64_t> shared;
  const std::vector<uint64_t> ids1 = SortedPoints(image1), ids2 = SortedPoints(image2);
  std::set_intersection(ids1.begin(), ids1.end(), ids2.begin(), ids2.end(),
                        std::back_inserter(shared));
  return static_cast<int64_t>(shared.size());
}

bool StandsLeft(const PosedImage& image, const PosedImage& other) {
  const Eigen::Vector3d at = image.cam_from_world * other.cam_from_world.OriginInSource();
  return std::abs(at.y()) > std::abs(at.x()) ? at.y() > 0 : at.x() > 0;
}

// Calls visit(image_idx1, image_idx2), the smaller camera_id first, for all of a frame.
template <typename Visit>
void ForEachPairOfFrames(const SparseModel& model, const Frames& frames, const Visit& visit) {
  std::map<uint32_t, int> idx_of;
  for (size_t i = 0; i < model.images.size(); ++i) {
    idx_of[model.images[i].image_id] = static_cast<int>(i);
  }
  for (const std::vector<uint32_t>& frame : frames) {
    std::vector<std::pair<uint32_t, int>> images;  // camera_id, image_idx
    for (const uint32_t image_id : frame) {
      const int idx = idx_of.at(image_id);
      images.emplace_back(model.images[static_cast<size_t>(idx)].camera_id, idx);
    }
    std::sort(images.begin(), images.end());
    for (size_t i = 0; i < images.size(); ++i) {
      for (size_t j = i + 1; j < images.size(); ++j) visit(images[i].second, images[j].second);
    }
  }
}

std::vector<CameraPair> CountPairs(const SparseModel& model, const Frames& frames) {
  std::map<std::pair<uint32_t, uint32_t>, CameraPair> pairs;
  ForEachPairOfFrames(model, frames, [&](int image_idx1, int image_idx2) {
    const PosedImage& a = model.images[static_cast<size_t>(image_idx1)];
    const PosedImage& b = model.images[static_cast<size_t>(image_idx2)];
    CameraPair& pair = pairs[{a.camera_id, b.camera_id}];
    pair.camera_id1 = a.camera_id;
    pair.camera_id2 = b.camera_id;
    ++pair.num_frames;
    pair.num_shared += NumShared(a, b);
    pair.num_left += StandsLeft(a, b) ? 1 : 0;
  });
  std::vector<CameraPair> counted;
  for (const auto& entry : pairs) counted.push_back(entry.second);
  return counted;
}

// camera_id of the left camera -> of the right one.
std::map<uint32_t, uint32_t> ChooseStereoCameras(std::vector<CameraPair> pairs) {
  std::stable_sort(pairs.begin(), pairs.end(), [](const CameraPair& a, const CameraPair& b) {
    return a.num_shared > b.num_shared;
  });
  std::map<uint32_t, uint32_t> right_of;
  std::set<uint32_t> taken;
  for (const CameraPair& pair : pairs) {
    if (static_cast<double>(pair.num_shared) < kMinSharedPoints * pair.num_frames) continue;
    if (taken.count(pair.camera_id1) > 0 || taken.count(pair.camera_id2) > 0) continue;
    taken.insert({pair.camera_id1, pair.camera_id2});
    const bool first_is_left = 2 * pair.num_left >= pair.num_frames;
    right_of[first_is_left ? pair.camera_id1 : pair.camera_id2] =
        first_is_left ? pair.camera_id2 : pair.camera_id1;
  }
  return right_of;
}

StereoRig EmptyRig(const SparseModel& model) {
  return {std::vector<int>(model.images.size(), -1), std::vector<uint8_t>(model.images.size(), 0)};
}

// Every run of digits as one '#'.
std::string ShapeOf(const std::string& name) {
  std::string shape;
  for (const char c : name) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!is_digit || shape.empty() || shape.back() != '#') shape += is_digit ? '#' : c;
  }
  return shape;
}

}  // namespace

int StereoRig::NumPairs() const {
  return static_cast<int>(
      std::count_if(right_of.begin(), right_of.end(), [](int right) { return right >= 0; }));
}

StereoRig RigFromFrames(const SparseModel& model, const Frames& frames) {
  const std::map<uint32_t, uint32_t> right_camera_of =
      ChooseStereoCameras(CountPairs(model, frames));
  if (right_camera_of.empty()) return {};
  StereoRig rig = EmptyRig(model);
  for (const auto& [left, right] : right_camera_of) {
    for (size_t i = 0; i < model.images.size(); ++i) {
      if (model.images[i].camera_id == right) rig.is_right[i] = 1;
    }
  }
  ForEachPairOfFrames(model, frames, [&](int image_idx1, int image_idx2) {
    for (const auto& [left, right] :
         {std::pair(image_idx1, image_idx2), std::pair(image_idx2, image_idx1)}) {
      const auto camera = right_camera_of.find(model.images[static_cast<size_t>(left)].camera_id);
      if (camera != right_camera_of.end() &&
          camera->second == model.images[static_cast<size_t>(right)].camera_id) {
        rig.right_of[static_cast<size_t>(left)] = right;
      }
    }
  });
  return rig;
}

std::map<std::string, std::string> SimultaneousNames(std::vector<std::string> left_names,
                                                     std::vector<std::string> right_names) {
  std::map<std::string, std::string> simultaneous;
  const std::set<std::string> in_right(right_names.begin(), right_names.end());
  for (const std::string& name : left_names) {
    if (in_right.count(name) > 0) simultaneous[name] = name;
  }
  if (!simultaneous.empty() || left_names.size() != right_names.size()) return simultaneous;
  std::sort(left_names.begin(), left_names.end(), NaturalLess);
  std::sort(right_names.begin(), right_names.end(), NaturalLess);
  for (size_t i = 0; i < left_names.size(); ++i) {
    if (ShapeOf(left_names[i]) != ShapeOf(right_names[i])) return {};
    simultaneous[left_names[i]] = right_names[i];
  }
  return simultaneous;
}

StereoRig RigFromNames(const SparseModel& model, const std::string& left_folder,
                       const std::string& right_folder,
                       const std::map<std::string, std::string>& simultaneous) {
  StereoRig rig = EmptyRig(model);
  std::map<std::string, int> idx_of;
  for (size_t i = 0; i < model.images.size(); ++i) {
    idx_of[model.images[i].name] = static_cast<int>(i);
    rig.is_right[i] = model.images[i].name.rfind(right_folder + "/", 0) == 0 ? 1 : 0;
  }
  for (const auto& [left_name, right_name] : simultaneous) {
    const auto left = idx_of.find(left_folder + "/" + left_name);
    const auto right = idx_of.find(right_folder + "/" + right_name);
    if (left == idx_of.end() || right == idx_of.end()) continue;
    rig.right_of[static_cast<size_t>(left->second)] = right->second;
  }
  return rig;
}

}  // namespace colmap_seapoint
