#include "colmap_seapoint/tracks/choose_tracks.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace colmap_seapoint {
namespace {

constexpr int kCells = 8;  // across and down

// How full a picture is.
struct Occupancy {
  std::array<int, kCells* kCells> cells = {};
  int total = 0;
};

int CellOf(const TrackedPicture& picture, uint32_t keypoint_idx) {
  const Eigen::Vector2f& place = picture.keypoints[keypoint_idx];
  const auto part = [](float value, int size) {
    return std::clamp(static_cast<int>(value * kCells / static_cast<float>(size)), 0, kCells - 1);
  };
  return part(place.y(), picture.height) * kCells + part(place.x(), picture.width);
}

class Chooser {
 public:
  Chooser(const Tracks& tracks, const std::vector<TrackedPicture>& pictures,
          int observations_per_picture)
      : tracks_(tracks),
        pictures_(pictures),
        per_picture_(observations_per_picture),
        per_cell_(std::max(1, observations_per_picture / (kCells * kCells))),
        occupancy_(pictures.size()) {}

  // Whether the track was chosen.
  bool Offer(uint32_t track) {
    const uint64_t begin = tracks_.begins[track], end = tracks_.begins[track + 1];
    cells_.clear();
    size_t num_wanted = 0;
    bool is_needed = false;
    for (uint64_t i = begin; i < end; ++i) {
      const TrackObservation& observation = tracks_.observations[i];
      const Occupancy& picture = occupancy_[observation.picture_idx];
      cells_.push_back(CellOf(pictures_[observation.picture_idx], observation.keypoint_idx));
      if (picture.cells[static_cast<size_t>(cells_.back())] >= per_cell_) continue;
      ++num_wanted;
      is_needed = is_needed || 2 * picture.total < per_picture_;
    }
    if (!is_needed && 2 * num_wanted < end - begin) return false;
    for (uint64_t i = begin; i < end; ++i) {
      Occupancy& picture = occupancy_[tracks_.observations[i].picture_idx];
      ++picture.cells[static_cast<size_t>(cells_[i - begin])];
      ++picture.total;
    }
    return true;
  }

 private:
  const Tracks& tracks_;
  const std::vector<TrackedPicture>& pictures_;
  int per_picture_;
  int per_cell_;
  std::vector<Occupancy> occupancy_;
  std::vector<int> cells_;  // of the track that is offered
};

}  // namespace

std::vector<uint32_t> ChooseTracks(const Tracks& tracks,
                                   const std::vector<TrackedPicture>& pictures,
                                   int observations_per_picture) {
  std::vector<uint32_t> order(tracks.Count());
  std::iota(order.begin(), order.end(), 0);
  const auto length = [&](uint32_t t) { return tracks.begins[t + 1] - tracks.begins[t]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return length(a) > length(b); });
  Chooser chooser(tracks, pictures, observations_per_picture);
  std::vector<uint32_t> chosen;
  for (const uint32_t track : order) {
    if (chooser.Offer(track)) chosen.push_back(track);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace colmap_seapoint
