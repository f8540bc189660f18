#include "examples/survey/score_markers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include "colmap_seapoint/markers/detect_markers.h"
#include "examples/survey/visibility.h"

namespace colmap_seapoint {
namespace {

// A find farther from the marker's centre than this is a false one, pixels.
constexpr double kSamePlace = 3;

using Key = std::pair<std::string, std::string>;  // marker, picture

// The side of the black square in the picture, pixels; nullopt where it does not show all of it.
std::optional<double> WholeSide(const SurfaceVisibility& visibility, size_t image_idx,
                                const MarkerBoard& board) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector3d& corner : board.Corners()) {
    const auto pixel = visibility.Project(image_idx, corner, Eigen::Vector3d::UnitZ());
    if (!pixel) return std::nullopt;
    pixels.push_back(*pixel);
  }
  double around = 0;
  for (size_t k = 0; k < 4; ++k) around += (pixels[(k + 1) % 4] - pixels[k]).norm();
  return around / 4 * 0.5 * board.size / board.HalfWidth();
}

}  // namespace

MarkerScore ScoreMarkers(const SurveyTruth& truth, const std::vector<MarkerSighting>& sightings) {
  MarkerScore score;
  std::multimap<Key, const MarkerSighting*> found;
  for (const MarkerSighting& sighting : sightings) {
    found.emplace(Key(sighting.marker, sighting.image), &sighting);
  }
  const SurfaceVisibility visibility(truth);
  double square = 0;
  size_t num_true = 0;
  for (const MarkerBoard& board : truth.boards) {
    for (size_t i = 0; i < truth.model.images.size(); ++i) {
      const PosedImage& image = truth.model.images[i];
      const auto side = WholeSide(visibility, i, board);
      if (side) {
        score.min_pixels = score.num_whole == 0 ? *side : std::min(score.min_pixels, *side);
        score.max_pixels = std::max(score.max_pixels, *side);
        ++score.num_whole;
      }
      const Camera& camera = truth.model.cameras.at(image.camera_id);
      const auto centre = camera.ImgFromCam(image.cam_from_world * board.centre);
      bool is_found = false;
      const auto range = found.equal_range({MarkerText(board.name), image.name});
      for (auto it = range.first; it != range.second && centre; ++it) {
        const double error = (CentreOfSquare(it->second->corners) - *centre).norm();
        if (it->second->is_mirrored || error > kSamePlace || is_found) continue;
        is_found = true;
        square += error * error;
        ++num_true;
      }
      if (is_found) ++(side ? score.num_found : score.num_cut_found);
    }
  }
  score.num_false = sightings.size() - num_true;
  if (num_true > 0) score.rms_pixels = std::sqrt(square / static_cast<double>(num_true));
  return score;
}

std::string MarkerScoreText(const MarkerScore& score) {
  char text[300];
  std::snprintf(
      text, sizeof(text),
      "markers shown whole: %zu (sides of %.1f to %.1f pixels), found: %zu (%.1f %%)\n"
      "found where the board is not whole: %zu, false: %zu, rms of centres: %.3f pixels\n",
      score.num_whole, score.min_pixels, score.max_pixels, score.num_found,
      100.0 * static_cast<double>(score.num_found) /
          static_cast<double>(std::max<size_t>(1, score.num_whole)),
      score.num_cut_found, score.num_false, score.rms_pixels);
  return text;
}

}  // namespace colmap_seapoint
