#include "densify/sequence/open_surface.h"

#include <queue>

namespace colmap_seapoint {

std::vector<double> PredictRanges(const SparseModel& model, const PosedImage& image,
                                  const View& view, const ViewCoverage& coverage) {
  const CellGrid& grid = coverage.grid;
  std::vector<double> range(coverage.range.begin(), coverage.range.end());
  for (const uint64_t id : image.point3D_ids) {
    if (id == kNoPoint3D) continue;
    const Eigen::Vector3d in_cam = view.cam_from_world * model.points3D.at(id).xyz;
    const auto pixel = view.camera.ImgFromCam(in_cam);
    if (!pixel || !view.camera.InImage(*pixel)) continue;
    double& at = range[grid.IndexOf(pixel->x(), pixel->y())];
    if (at == 0) at = in_cam.norm();
  }
  std::queue<size_t> queue;
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    if (range[cell] > 0) queue.push(cell);
  }
  while (!queue.empty()) {
    const size_t cell = queue.front();
    queue.pop();
    ForEachNeighbor(grid, cell, [&](size_t to) {
      if (range[to] > 0) return;
      range[to] = range[cell];
      queue.push(to);
    });
  }
  return range;
}

std::optional<Eigen::Vector3d> PointAt(const View& view, const Rigid3d& world_from_cam,
                                       const CellGrid& grid, size_t cell, double range) {
  const auto ray = view.camera.CamFromImg(grid.Center(cell));
  if (!ray) return std::nullopt;
  return world_from_cam * (range * ray->homogeneous().normalized());
}

bool SeesWell(const View& view, const Eigen::Vector3d& point) {
  const auto pixel = view.camera.ImgFromCam(view.cam_from_world * point);
  if (!pixel) return false;
  constexpr double kRimMargin = 0.01;
  const double x_margin = kRimMargin * view.camera.width;
  const double y_margin = kRimMargin * view.camera.height;
  return pixel->x() >= x_margin && pixel->y() >= y_margin &&
         pixel->x() <= view.camera.width - x_margin && pixel->y() <= view.camera.height - y_margin;
}

}  // namespace colmap_seapoint
