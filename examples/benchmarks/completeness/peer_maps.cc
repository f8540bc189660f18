#include "examples/benchmarks/completeness/peer_maps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr int kDiagramPixels = 1400;

size_t IndexOf(const GapTruth& truth, int i, int j) {
  return static_cast<size_t>(j) * static_cast<size_t>(truth.nx) + static_cast<size_t>(i);
}

double MeanHeight(const SurveyTruth& survey) {
  const Field& heights = survey.surface.Ground().Heights();
  double sum = 0;
  for (const float height : heights) sum += height;
  return sum / static_cast<double>(heights.size());
}

// Pixels of ODM's diagram, over the cloud's box on the plan.
struct Diagram {
  Eigen::AlignedBox2d box;
  double pixel = 1;  // metres
  int width = 0, height = 0;
  std::vector<bool> has_point;

  void Draw(const Eigen::Vector2d& place) {
    const double radius = std::sqrt(2) * pixel;
    const Eigen::Vector2d at = (place - box.min()) / pixel;
    const int reach = 2;
    for (int y = static_cast<int>(at.y()) - reach; y <= static_cast<int>(at.y()) + reach; ++y) {
      for (int x = static_cast<int>(at.x()) - reach; x <= static_cast<int>(at.x()) + reach; ++x) {
        if (x < 0 || y < 0 || x >= width || y >= height) continue;
        const Eigen::Vector2d middle = box.min() + pixel * Eigen::Vector2d(x + 0.5, y + 0.5);
        if ((middle - place).norm() <= radius) {
          has_point[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
              true;
        }
      }
    }
  }
  bool Holds(const Eigen::Vector2d& place) const {
    if (!box.contains(place)) return false;
    const Eigen::Vector2d at = (place - box.min()) / pixel;
    const int x = std::min(static_cast<int>(at.x()), width - 1);
    const int y = std::min(static_cast<int>(at.y()), height - 1);
    return has_point[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

}  // namespace

CoverMap FootprintMap(const SurveyTruth& survey, const PlantedGaps& gaps, const GapTruth& truth) {
  CoverMap map(truth.cells.size(), false);
  const double height = MeanHeight(survey);
  for (const PosedImage& image : survey.model.images) {
    if (gaps.lost.count(image.name) > 0 || gaps.removed.count(image.name) > 0) continue;
    const Camera& camera = survey.model.cameras.at(image.camera_id);
    for (int j = 0; j < truth.ny; ++j) {
      for (int i = 0; i < truth.nx; ++i) {
        const Eigen::Vector2d place = truth.Place(i, j);
        const Eigen::Vector3d in_cam =
            image.cam_from_world *
            (survey.surface.WorldFromGround() * Eigen::Vector3d(place.x(), place.y(), height));
        if (in_cam.z() <= 0 || in_cam.norm() > survey.max_range) continue;
        const auto pixel = camera.ImgFromCam(in_cam);
        if (pixel && camera.InImage(*pixel)) map[IndexOf(truth, i, j)] = true;
      }
    }
  }
  return map;
}

CoverMap ViewsMap(const SurveyTruth& survey, const std::vector<Eigen::Vector3f>& points,
                  const GapTruth& truth) {
  Diagram diagram;
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector3f& p : points) {
    places.emplace_back(survey.surface.InGround(p.cast<double>()).head<2>());
    diagram.box.extend(places.back());
  }
  CoverMap map(truth.cells.size(), false);
  if (places.empty()) return map;
  diagram.pixel = diagram.box.sizes().maxCoeff() / kDiagramPixels;
  diagram.width = static_cast<int>(diagram.box.sizes().x() / diagram.pixel) + 1;
  diagram.height = static_cast<int>(diagram.box.sizes().y() / diagram.pixel) + 1;
  diagram.has_point.assign(static_cast<size_t>(diagram.width) * static_cast<size_t>(diagram.height),
                           false);
  for (const Eigen::Vector2d& place : places) diagram.Draw(place);
  for (int j = 0; j < truth.ny; ++j) {
    for (int i = 0; i < truth.nx; ++i) {
      map[IndexOf(truth, i, j)] = diagram.Holds(truth.Place(i, j));
    }
  }
  return map;
}

double FalselyCovered(const GapTruth& truth, const CoverMap& map) {
  double area = 0;
  for (size_t k = 0; k < truth.cells.size(); ++k) {
    if (truth.cells[k].is_gap && map[k]) area += truth.side * truth.side;
  }
  return area;
}

}  // namespace colmap_seapoint
