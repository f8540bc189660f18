#include "densify/completeness/sight/survey_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "colmap_seapoint/base/camera_projection.h"
#include "colmap_seapoint/base/median.h"
#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

constexpr double kRangeShare = 0.98, kRangeMargin = 1.25;
constexpr double kHalfPi = 1.57079632679489662;
// A disc about a cell reaches its corners.
constexpr double kDiscRadius = 0.75;
constexpr double kMaxCode = 65535;

double MaxAngle(const Camera& camera) {
  double max_angle = 0;
  for (int k = 0; k < 8; ++k) {
    constexpr double kAt[8][2] = {{0, 0},   {1, 0},   {0, 1},   {1, 1},
                                  {0.5, 0}, {0.5, 1}, {0, 0.5}, {1, 0.5}};
    const auto at = camera.CamFromImg({kAt[k][0] * camera.width, kAt[k][1] * camera.height});
    max_angle = std::max(max_angle, at ? std::atan(at->norm()) : kHalfPi);
  }
  return max_angle;
}

// Of every cell with points in a tile: its place.
void DrawTile(const Ground& ground, const GroundLayer& layer, const TileKey& key,
              const SurveyView& view, DepthCells* depths) {
  constexpr int kSide = TiledGrid<GroundCell>::kSide;
  const TiledGrid<GroundCell>::Tile& tile = layer.cells.ExistingTile(key);
  const Eigen::Vector3d toward = layer.layer_from_world.row(2).transpose();
  for (int i = 0; i < kSide * kSide; ++i) {
    const GroundCell& cell = tile[static_cast<size_t>(i)];
    if (!cell.is_coherent) continue;
    const Eigen::Vector3d place =
        ground.PlaceOf(layer, key.x * kSide + i % kSide, key.y * kSide + i / kSide, cell.height);
    // Seen from behind it is no surface.
    if (toward.dot(view.center - place) <= 0) continue;
    const auto pixel = view.Project(place);
    if (!pixel) continue;
    const uint16_t code = depths->CodeOf((view.rotation * place + view.translation).z());
    const double radius = kDiscRadius * ground.cell_side / view.GsdAt(place) / kDepthCell;
    const double x = pixel->x() / kDepthCell, y = pixel->y() / kDepthCell;
    const int x0 = std::max(0, static_cast<int>(x - radius));
    const int x1 = std::min(depths->codes.width - 1, static_cast<int>(x + radius));
    const int y0 = std::max(0, static_cast<int>(y - radius));
    const int y1 = std::min(depths->codes.height - 1, static_cast<int>(y + radius));
    for (int b = y0; b <= y1; ++b) {
      for (int a = x0; a <= x1; ++a) depths->Draw(a, b, code);
    }
  }
}

// A tile that holds a piece of the surface, in a sphere.
struct CoherentTile {
  const GroundLayer* layer;
  TileKey key;
  Eigen::Vector3d middle;
  double radius;
};

std::vector<CoherentTile> CoherentTiles(const Ground& ground) {
  constexpr int kSide = TiledGrid<GroundCell>::kSide;
  std::vector<CoherentTile> tiles;
  for (const auto& [layer_key, layer] : ground.layers) {
    for (const TileKey& key : layer.cells.Keys()) {
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (const GroundCell& cell : layer.cells.ExistingTile(key)) {
        if (!cell.is_coherent) continue;
        low = std::min(low, cell.height);
        high = std::max(high, cell.height);
      }
      if (low > high) continue;
      const Eigen::Vector3d middle = ground.PlaceOf(layer, key.x * kSide + kSide / 2,
                                                    key.y * kSide + kSide / 2, 0.5 * (low + high));
      tiles.push_back(
          {&layer, key, middle, std::hypot(0.75 * kSide * ground.cell_side, 0.5 * (high - low))});
    }
  }
  return tiles;
}

DepthCells DrawView(const Ground& ground, const std::vector<CoherentTile>& tiles,
                    const SurveyView& view) {
  std::vector<const CoherentTile*> in_view;
  double farthest = 0;
  for (const CoherentTile& tile : tiles) {
    if (!view.MaySee(tile.middle, tile.radius)) continue;
    in_view.push_back(&tile);
    farthest = std::max(farthest,
                        view.rotation.row(2).dot(tile.middle) + view.translation.z() + tile.radius);
  }
  DepthCells depths((view.camera->width + kDepthCell - 1) / kDepthCell,
                    (view.camera->height + kDepthCell - 1) / kDepthCell, farthest);
  for (const CoherentTile* tile : in_view) {
    DrawTile(ground, *tile->layer, tile->key, view, &depths);
  }
  return depths;
}

}  // namespace

std::optional<Eigen::Vector2d> SurveyView::Project(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d in_cam = rotation * place + translation;
  if (in_cam.z() <= 0 || in_cam.squaredNorm() > max_range * max_range) return std::nullopt;
  // Beyond the corners a distortion may fold back into the picture.
  const double aside = std::hypot(in_cam.x(), in_cam.y());
  if (std::atan2(aside, in_cam.z()) > max_angle * 1.02) return std::nullopt;
  const auto pixel = camera->ImgFromCam(in_cam);
  if (!pixel || !camera->InImage(*pixel)) return std::nullopt;
  return pixel;
}

double SurveyView::GsdAt(const Eigen::Vector3d& place) const {
  const double away =
      is_fisheye ? (place - center).norm() : rotation.row(2).dot(place) + translation.z();
  return away / camera->MeanFocal();
}

bool SurveyView::MaySee(const Eigen::Vector3d& middle, double radius) const {
  const Eigen::Vector3d in_cam = rotation * middle + translation;
  const double distance = in_cam.norm();
  if (distance - radius > max_range) return false;
  if (distance <= radius) return true;
  const double angle = std::acos(std::clamp(in_cam.z() / distance, -1.0, 1.0));
  return angle - std::asin(radius / distance) <= max_angle;
}

SurveyView MakeView(const Camera& camera, const Rigid3d& cam_from_world, double max_range) {
  SurveyView view;
  view.camera = &camera;
  view.rotation = cam_from_world.rotation.toRotationMatrix();
  view.translation = cam_from_world.translation;
  view.center = cam_from_world.OriginInSource();
  view.is_fisheye = IsFisheye(camera.model) || camera.model == CameraModel::kEquirectangular;
  view.max_angle = MaxAngle(camera);
  view.max_range = max_range;
  return view;
}

std::vector<SurveyView> MakeViews(const SparseModel& model, double max_range) {
  std::vector<SurveyView> views;
  for (const PosedImage& image : model.images) {
    views.push_back(MakeView(model.cameras.at(image.camera_id), image.cam_from_world, max_range));
  }
  return views;
}

double VisualRange(const SparseModel& model) {
  std::vector<double> ranges;
  for (const PosedImage& image : model.images) {
    const Eigen::Vector3d center = image.cam_from_world.OriginInSource();
    for (const uint64_t id : image.point3D_ids) {
      const auto point = model.points3D.find(id);
      if (point == model.points3D.end()) continue;
      ranges.push_back((point->second.xyz - center).norm());
    }
  }
  if (ranges.empty()) return std::numeric_limits<double>::infinity();
  return kRangeMargin * Quantile(std::move(ranges), kRangeShare);
}

DepthCells::DepthCells(int width, int height, double farthest)
    : codes(width, height), unit(farthest / kMaxCode) {}

uint16_t DepthCells::CodeOf(double depth) const {
  return static_cast<uint16_t>(std::clamp(std::round(depth / unit), 1.0, kMaxCode));
}

std::vector<DepthCells> DrawDepths(const Ground& ground, const std::vector<SurveyView>& views,
                                   int num_threads) {
  const std::vector<CoherentTile> tiles = CoherentTiles(ground);
  std::vector<DepthCells> depths(views.size());
  ParallelFor(num_threads, static_cast<int64_t>(views.size()), [&](int64_t i) {
    depths[static_cast<size_t>(i)] = DrawView(ground, tiles, views[static_cast<size_t>(i)]);
  });
  return depths;
}

bool ShowsAnother(const DepthCells& depths, const Eigen::Vector2d& pixel, double depth,
                  double slack) {
  const int x = std::clamp(static_cast<int>(pixel.x()) / kDepthCell, 0, depths.codes.width - 1);
  const int y = std::clamp(static_cast<int>(pixel.y()) / kDepthCell, 0, depths.codes.height - 1);
  return depths.Holds(x, y) && std::abs(depths.DepthAt(x, y) - depth) > slack;
}

}  // namespace colmap_seapoint
