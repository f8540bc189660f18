#include "densify/sequence/covisibility.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <unordered_map>

namespace colmap_seapoint {

namespace {

constexpr size_t kMaxTrack = 24;  // pictures of a point that are looked at

// Parallax, degrees: worth nothing below the first, everything between the next two, nothing beyond
// the last.
constexpr double kNoParallaxDeg = 1.5, kFullParallaxDeg = 6, kLargeParallaxDeg = 25,
                 kMaxParallaxDeg = 60;
constexpr double kLikeScale = 1.3, kMaxScale = 3.5;  // ratio of the two distances

// Of the triangulated points that a picture sees, ascending.
std::vector<uint64_t> SortedPointIds(const PosedImage& image) {
  std::vector<uint64_t> ids;
  for (const uint64_t id : image.point3D_ids) {
    if (id != kNoPoint3D) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::vector<uint64_t> SharedPointIds(const PosedImage& image1, const PosedImage& image2) {
  const std::vector<uint64_t> ids1 = SortedPointIds(image1), ids2 = SortedPointIds(image2);
  std::vector<uint64_t> shared;
  std::set_intersection(ids1.begin(), ids1.end(), ids2.begin(), ids2.end(),
                        std::back_inserter(shared));
  return shared;
}

// The finalizer of splitmix64: the same for the same arguments everywhere.
uint64_t HashOf(uint64_t value) {
  value += 0x9e3779b97f4a7c15u;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

// At most kMaxTrack pictures of a track, any two of them as likely as any other two.
std::vector<int> Thinned(const std::vector<int>& track, uint64_t point_id) {
  if (track.size() <= kMaxTrack) return track;
  std::vector<std::pair<uint64_t, int>> drawn;
  for (const int image_idx : track) {
    drawn.emplace_back(HashOf(HashOf(point_id) + static_cast<uint64_t>(image_idx)), image_idx);
  }
  std::nth_element(drawn.begin(), drawn.begin() + kMaxTrack, drawn.end());
  std::vector<int> thinned;
  for (size_t k = 0; k < kMaxTrack; ++k) thinned.push_back(drawn[k].second);
  std::sort(thinned.begin(), thinned.end());
  return thinned;
}

// How many pairs of a track each pair of its thinned one stands for.
double PairsPerPair(size_t full, size_t thinned) {
  return static_cast<double>(full * (full - 1)) /
         static_cast<double>(std::max<size_t>(1, thinned * (thinned - 1)));
}

// Sums over points, of pairs of pictures; the smaller image_idx comes first.
class PairSums {
 public:
  explicit PairSums(const SparseModel& model) : shared_(model.images.size()) {
    for (const PosedImage& image : model.images) {
      idx_of_[image.image_id] = static_cast<int>(centers_.size());
      centers_.push_back(image.cam_from_world.OriginInSource());
    }
  }

  void Add(uint64_t id, const SparsePoint& point) {
    const std::vector<int> track = ViewersOf(point);
    const std::vector<int> thinned = Thinned(track, id);
    const double weight = PairsPerPair(track.size(), thinned.size());
    for (size_t i = 0; i < thinned.size(); ++i) {
      for (size_t k = i + 1; k < thinned.size(); ++k) {
        const auto a = static_cast<size_t>(thinned[i]), b = static_cast<size_t>(thinned[k]);
        SharedPoints& sum = shared_[a][thinned[k]];
        sum.count += weight;
        sum.quality += weight * ViewQuality(point.xyz, centers_[a], centers_[b]);
      }
    }
  }

  Covisibility BothWays() const {
    Covisibility covisibility(shared_.size());
    for (size_t a = 0; a < shared_.size(); ++a) {  // so that every list ascends
      for (const auto& [b, points] : shared_[a]) {
        covisibility[static_cast<size_t>(b)].push_back(
            {static_cast<int>(a), points.count, points.quality});
      }
    }
    for (size_t a = 0; a < shared_.size(); ++a) {
      for (const auto& [b, points] : shared_[a]) {
        covisibility[a].push_back({b, points.count, points.quality});
      }
    }
    return covisibility;
  }

 private:
  // Ascending, each once.
  std::vector<int> ViewersOf(const SparsePoint& point) const {
    std::vector<int> viewers;
    for (const auto& element : point.track) {
      const auto found = idx_of_.find(element.image_id);
      if (found != idx_of_.end()) viewers.push_back(found->second);
    }
    std::sort(viewers.begin(), viewers.end());
    viewers.erase(std::unique(viewers.begin(), viewers.end()), viewers.end());
    return viewers;
  }

  std::unordered_map<uint32_t, int> idx_of_;
  std::vector<Eigen::Vector3d> centers_;
  std::vector<std::map<int, SharedPoints>> shared_;
};

// 1 up to `full`, falling to 0 at `none` on a straight line.
double Falling(double value, double full, double none) {
  return std::clamp((none - value) / (none - full), 0.0, 1.0);
}

}  // namespace

double ParallaxDeg(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2) {
  const double cosine = (point - center1).normalized().dot((point - center2).normalized());
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
}

double ViewQuality(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2) {
  const double parallax = ParallaxDeg(point, center1, center2);
  const double range1 = (point - center1).norm(), range2 = (point - center2).norm();
  const double nearer = std::min(range1, range2);
  if (nearer == 0) return 0;
  const double scale = std::max(range1, range2) / nearer;
  return Falling(-parallax, -kFullParallaxDeg, -kNoParallaxDeg) *
         Falling(parallax, kLargeParallaxDeg, kMaxParallaxDeg) *
         Falling(scale, kLikeScale, kMaxScale);
}

Covisibility MeasureCovisibility(const SparseModel& model) {
  PairSums sums(model);
  for (const auto& [id, point] : model.points3D) sums.Add(id, point);
  return sums.BothWays();
}

std::optional<double> MedianParallaxDeg(const SparseModel& model, const PosedImage& image1,
                                        const PosedImage& image2) {
  const Eigen::Vector3d center1 = image1.cam_from_world.OriginInSource();
  const Eigen::Vector3d center2 = image2.cam_from_world.OriginInSource();
  std::vector<double> angles;
  for (const uint64_t id : SharedPointIds(image1, image2)) {
    angles.push_back(ParallaxDeg(model.points3D.at(id).xyz, center1, center2));
  }
  if (angles.empty()) return std::nullopt;
  std::nth_element(angles.begin(), angles.begin() + static_cast<long>(angles.size() / 2),
                   angles.end());
  return angles[angles.size() / 2];
}

int NumSharedPoints(const PosedImage& image1, const PosedImage& image2) {
  return static_cast<int>(SharedPointIds(image1, image2).size());
}

}  // namespace colmap_seapoint
