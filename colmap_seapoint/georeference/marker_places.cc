#include "colmap_seapoint/georeference/marker_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "colmap_seapoint/georeference/triangulate_target.h"
#include "colmap_seapoint/markers/detect_markers.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNumCorners = 4;
// Marks of corners by the detector scatter by this, at best, pixels.
constexpr double kMinSigma = 0.1;
// What is left of blur and of the pictures' own gradation moves opposite edges of a square apart,
// or together, by this, and so in all pictures, pixels.
constexpr double kEdgeBias = 0.05;
// Sides and diagonals that differ by more than this share, beyond what their uncertainty explains,
// are no square's.
constexpr double kMaxSkew = 0.2;
constexpr double kMaxSkewSigmas = 4;

struct View {
  const PosedImage* image = nullptr;
  const Camera* camera = nullptr;
  std::array<Eigen::Vector2d, kNumCorners> corners;  // pixels of the model's camera
  Eigen::Vector2d centre;
};

struct Seen {
  std::vector<View> views;  // in pictures of the model
  size_t num_elsewhere = 0, num_mirrored = 0;
};

View ViewOf(const PosedImage& image, const Camera& camera, const MarkerSighting& sighting) {
  View view{&image, &camera, sighting.corners, {}};
  const Eigen::Array2d factor(static_cast<double>(camera.width) / sighting.width,
                              static_cast<double>(camera.height) / sighting.height);
  for (Eigen::Vector2d& corner : view.corners) corner = corner.array() * factor;
  view.centre = CentreOfSquare(view.corners);
  return view;
}

std::map<MarkerName, Seen> Sort(const SparseModel& model,
                                const std::vector<MarkerSighting>& sightings) {
  std::map<std::string, const PosedImage*> images;
  for (const PosedImage& image : model.images) images[image.name] = &image;
  std::map<MarkerName, Seen> sorted;
  for (const MarkerSighting& sighting : sightings) {
    const auto name = ParseMarkerName(sighting.marker).name;
    if (!name) continue;
    Seen& seen = sorted[*name];
    const auto image = images.find(sighting.image);
    if (sighting.is_mirrored) {
      ++seen.num_mirrored;
    } else if (image == images.end()) {
      ++seen.num_elsewhere;
    } else {
      const View view =
          ViewOf(*image->second, model.cameras.at(image->second->camera_id), sighting);
      if (view.centre.allFinite()) seen.views.push_back(view);
    }
  }
  return sorted;
}

// `corner`: 0 to 3, or kNumCorners for the centre.
TriangulatedTarget Triangulate(const std::vector<View>& views, size_t corner, double max_error) {
  std::vector<TargetView> targets;
  for (const View& view : views) {
    targets.push_back({view.camera, view.image->cam_from_world,
                       corner < kNumCorners ? view.corners[corner] : view.centre});
  }
  return TriangulateTarget(targets, max_error);
}

std::vector<View> Chosen(const std::vector<View>& views, const std::vector<bool>& is_used,
                         bool used) {
  std::vector<View> chosen;
  for (size_t i = 0; i < views.size(); ++i) {
    if (is_used[i] == used) chosen.push_back(views[i]);
  }
  return chosen;
}

struct Length {
  double value = 0, sigma = 0;  // sigma for marks with a standard deviation of a pixel
};

Length Between(const TriangulatedTarget& a, const TriangulatedTarget& b) {
  const Eigen::Vector3d between = b.xyz - a.xyz, along = between.normalized();
  return {between.norm(), std::sqrt(along.dot((a.covariance + b.covariance) * along))};
}

// The side of the square that the views show; nullopt where they show none.
std::optional<Length> SideOf(const std::vector<View>& views, double max_error, double sigma) {
  std::vector<TriangulatedTarget> corners;
  for (size_t k = 0; k < kNumCorners; ++k) {
    corners.push_back(Triangulate(views, k, max_error));
    if (!corners.back().problem.empty()) return std::nullopt;
  }
  std::vector<Length> lengths;  // the four sides, then the diagonals as sides
  for (size_t k = 0; k < kNumCorners; ++k) {
    lengths.push_back(Between(corners[k], corners[(k + 1) % kNumCorners]));
  }
  Length mean;
  for (const Length& side : lengths) {
    mean.value += side.value / kNumCorners;
    mean.sigma += side.sigma / kNumCorners / 2;  // of a mean of four
  }
  for (size_t k = 0; k < 2; ++k) {
    const Length diagonal = Between(corners[k], corners[k + 2]);
    lengths.push_back({diagonal.value / std::sqrt(2.0), diagonal.sigma / std::sqrt(2.0)});
  }
  for (const Length& length : lengths) {
    const double allowed = kMaxSkew * mean.value + kMaxSkewSigmas * sigma * length.sigma;
    if (!(std::abs(length.value - mean.value) <= allowed)) return std::nullopt;
  }
  return mean;
}

// Of the views' mean side, in pixels.
double SideInPixels(const std::vector<View>& views) {
  double sum = 0;
  for (const View& view : views) {
    for (size_t k = 0; k < kNumCorners; ++k) {
      sum += (view.corners[(k + 1) % kNumCorners] - view.corners[k]).norm() / kNumCorners;
    }
  }
  return sum / static_cast<double>(views.size());
}

double RmsOf(const TriangulatedTarget& target) {
  double square = 0, count = 0;
  for (size_t i = 0; i < target.errors.size(); ++i) {
    if (!target.is_used[i]) continue;
    square += target.errors[i] * target.errors[i];
    ++count;
  }
  return count > 0 ? std::sqrt(square / count) : 0;
}

std::string Pictures(size_t count) {
  return std::to_string(count) + (count == 1 ? " picture" : " pictures");
}

// Why a marker without two sightings in the model has no place.
std::string WhyUnseen(const Seen& seen) {
  if (seen.views.size() == 1) {
    return "is found in one picture of this model only; two are needed at least";
  }
  if (seen.num_elsewhere > 0) {
    return "is found in " + Pictures(seen.num_elsewhere) + ", none of them in this model";
  }
  return "is found in " + Pictures(seen.num_mirrored) +
         ", always as its mirror image: print it again, not mirrored";
}

// Whether the sightings that the place does not explain show the marker at a second one.
bool IsTwin(const std::vector<View>& others, double max_error) {
  if (others.size() < 2) return false;
  const TriangulatedTarget second = Triangulate(others, kNumCorners, max_error);
  const std::vector<View> used = Chosen(others, second.is_used, true);
  return used.size() >= 2 && SideOf(used, max_error, std::max(kMinSigma, RmsOf(second)));
}

MarkerPlace PlaceOf(const Seen& seen, double max_error) {
  MarkerPlace place;
  place.num_seen = seen.views.size();
  if (seen.views.size() < 2) {
    place.problem = WhyUnseen(seen);
    return place;
  }
  const TriangulatedTarget centre = Triangulate(seen.views, kNumCorners, max_error);
  const std::vector<View> used = Chosen(seen.views, centre.is_used, true);
  place.num_used = used.size();
  place.rms_pixels = RmsOf(centre);
  if (IsTwin(Chosen(seen.views, centre.is_used, false), max_error)) {
    place.problem =
        "is in the scene more than once, at different places: nobody can tell which is meant; take "
        "one of the prints away, or name another marker";
    return place;
  }
  if (!centre.problem.empty()) {
    place.problem = centre.problem;
    return place;
  }
  const double sigma = std::max(kMinSigma, place.rms_pixels);
  const auto side = SideOf(used, max_error, sigma);
  if (!side) {
    place.problem = "is found, but its corners form no square: a false find, or a print that bends";
    return place;
  }
  place.xyz = centre.xyz;
  place.covariance = sigma * sigma * centre.covariance;
  place.side = side->value;
  place.side_sigma = std::hypot(sigma * side->sigma, kEdgeBias / SideInPixels(used) * side->value);
  return place;
}

}  // namespace

std::map<MarkerName, MarkerPlace> PlaceMarkers(const SparseModel& model,
                                               const std::vector<MarkerSighting>& sightings,
                                               double max_error) {
  std::map<MarkerName, MarkerPlace> places;
  for (const auto& [name, seen] : Sort(model, sightings)) places[name] = PlaceOf(seen, max_error);
  return places;
}

}  // namespace colmap_seapoint
