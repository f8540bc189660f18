#include "densify/sequence/partners.h"

#include <algorithm>
#include <cmath>

#include "densify/sequence/open_surface.h"

namespace colmap_seapoint {

namespace {

constexpr size_t kMaxPartners = 32;
// Two partners are one when they stand nearer to each other than this share of the better one's
// baseline, and look in directions that differ by less than the angle of this cosine.
constexpr double kBesideEachOther = 0.2, kSameDirection = 0.985;

constexpr int kStride = 3;              // of every so many columns and rows of cells one is asked
constexpr double kMinOpenShare = 0.01;  // of the picture, that a pair must measure

struct Stand {
  Eigen::Vector3d center, axis;
};

Stand StandOf(const PosedImage& image) {
  return {image.cam_from_world.OriginInSource(),
          image.cam_from_world.rotation.inverse() * Eigen::Vector3d::UnitZ()};
}

bool IsBeside(const Stand& stand, const Stand& better, const Stand& first) {
  return (stand.center - better.center).norm() <
             kBesideEachOther * (better.center - first.center).norm() &&
         stand.axis.dot(better.axis) > kSameDirection;
}

// The places that open cells show, at their predicted ranges.
std::vector<Eigen::Vector3d> OpenPlaces(const View& view, const ViewCoverage& coverage,
                                        const std::vector<double>& predicted_range) {
  const CellGrid& grid = coverage.grid;
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  std::vector<Eigen::Vector3d> places;
  for (int b = kStride / 2; b < grid.height; b += kStride) {
    for (int a = kStride / 2; a < grid.width; a += kStride) {
      const size_t cell =
          static_cast<size_t>(b) * static_cast<size_t>(grid.width) + static_cast<size_t>(a);
      if (coverage.range[cell] > 0 || predicted_range[cell] <= 0) continue;
      const auto place = PointAt(view, world_from_cam, grid, cell, predicted_range[cell]);
      if (place) places.push_back(*place);
    }
  }
  return places;
}

// A pair by the open places that it measures.
struct Rated {
  int position;
  double quality = 0;  // sum of their ViewQuality
  double score = 0;    // the same, each times the root of its parallax
};

Rated Rate(int position, const View& partner, const View& view,
           const std::vector<Eigen::Vector3d>& places) {
  const Eigen::Vector3d center1 = view.cam_from_world.OriginInSource();
  const Eigen::Vector3d center2 = partner.cam_from_world.OriginInSource();
  Rated rated{position};
  for (const Eigen::Vector3d& place : places) {
    if (!SeesWell(partner, place)) continue;
    const double quality = ViewQuality(place, center1, center2);
    rated.quality += quality;
    rated.score += quality * std::sqrt(ParallaxDeg(place, center1, center2));
  }
  return rated;
}

}  // namespace

std::vector<int> BestPartners(const Track& track, const Covisibility& covisibility, int position) {
  struct Ranked {
    double quality;
    int position;
  };
  std::vector<Ranked> ranked;
  for (const SharedPoints& shared : covisibility[static_cast<size_t>(track.ImageIdx(position))]) {
    if (shared.quality > 0) {
      ranked.push_back({shared.quality, track.PositionOf(shared.image_idx)});
    }
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return a.quality != b.quality ? a.quality > b.quality : a.position < b.position;
  });
  const Stand first = StandOf(track.Image(position));
  std::vector<int> partners;
  std::vector<Stand> stands;
  for (const Ranked& candidate : ranked) {
    const Stand stand = StandOf(track.Image(candidate.position));
    if (std::any_of(stands.begin(), stands.end(),
                    [&](const Stand& better) { return IsBeside(stand, better, first); })) {
      continue;
    }
    partners.push_back(candidate.position);
    stands.push_back(stand);
    if (partners.size() == kMaxPartners) break;
  }
  return partners;
}

void MarkSeenByBoth(const View& view, const std::vector<double>& predicted_range,
                    const View& pair_view1, const View& pair_view2, ViewCoverage* coverage) {
  const Rigid3d world_from_cam = view.cam_from_world.Inverse();
  for (size_t cell = 0; cell < coverage->grid.Size(); ++cell) {
    if (coverage->range[cell] > 0 || predicted_range[cell] <= 0) continue;
    const auto place = PointAt(view, world_from_cam, coverage->grid, cell, predicted_range[cell]);
    if (place && SeesWell(pair_view1, *place) && SeesWell(pair_view2, *place)) {
      coverage->range[cell] = static_cast<float>(predicted_range[cell]);
    }
  }
}

std::vector<int> RankForOpenSurface(const Track& track, const View& view,
                                    const ViewCoverage& coverage,
                                    const std::vector<double>& predicted_range,
                                    const std::vector<int>& partners) {
  const std::vector<Eigen::Vector3d> places = OpenPlaces(view, coverage, predicted_range);
  const double min_quality =
      kMinOpenShare * static_cast<double>(coverage.grid.Size()) / (kStride * kStride);
  std::vector<Rated> ranked;
  for (const int partner : partners) {
    const Rated rated = Rate(partner, track.ViewOf(partner), view, places);
    if (rated.quality >= min_quality) ranked.push_back(rated);
  }
  std::sort(ranked.begin(), ranked.end(), [](const Rated& a, const Rated& b) {
    return a.score != b.score ? a.score > b.score : a.position < b.position;
  });
  std::vector<int> positions;
  for (const Rated& rated : ranked) positions.push_back(rated.position);
  return positions;
}

}  // namespace colmap_seapoint
