#include "densify/overlap/earlier_surface.h"

namespace colmap_seapoint {
namespace {

constexpr double kMinShare = 0.7;  // of a cell's samples

struct CellSum {
  int count = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

}  // namespace

CloudFootprint FootprintOf(const std::vector<Eigen::Vector3f>& points, const View& view,
                           const CellGrid& cells, int step) {
  std::vector<CellSum> sums(cells.Size());
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d place = point.cast<double>();
    const auto pixel = view.camera.ImgFromCam(view.cam_from_world * place);
    if (!pixel) continue;
    CellSum& sum = sums[cells.IndexOf(pixel->x(), pixel->y())];
    ++sum.count;
    sum.place += place;
  }
  const double samples_along = static_cast<double>(cells.cell) / step;
  const double min_count = kMinShare * samples_along * samples_along;
  CloudFootprint footprint;
  for (const CellSum& sum : sums) {
    if (sum.count < min_count) continue;
    const Eigen::Vector3d mean = sum.place / sum.count;
    const double range = (view.cam_from_world * mean).norm();
    footprint.patches.push_back(
        {mean.cast<float>(), static_cast<float>(cells.cell * range / view.camera.MeanFocal())});
  }
  footprint.UpdateSphere();
  return footprint;
}

}  // namespace colmap_seapoint
