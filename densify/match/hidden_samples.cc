#include "densify/match/hidden_samples.h"

#include <cmath>
#include <optional>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

bool HasMask(const GrayImage* mask) { return mask != nullptr && !mask->Empty(); }

}  // namespace

bool IsHidden(const GrayImage* mask, double x, double y) {
  if (!HasMask(mask)) return false;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  return mask->Contains(column, row) && mask->At(column, row) == 0;
}

void HideInRect(const GrayImage* mask, const RectMap& map, int num_threads, RectPicture* picture) {
  if (!HasMask(mask)) return;
  ParallelFor(num_threads, picture->window.height, [&](int64_t row) {
    const int j = static_cast<int>(row);
    uint8_t* gray = picture->gray.Row(j);
    for (int i = 0; i < picture->window.width; ++i) {
      if (gray[i] == 0) continue;
      const auto source = map.Source(i, j);
      if (source &&
          IsHidden(mask, static_cast<double>(source->x()), static_cast<double>(source->y()))) {
        gray[i] = 0;
      }
    }
  });
}

void RemoveHidden(const GrayImage* mask1, const GrayImage* mask2, const View& view2,
                  const PairGeometry& geometry, const RectMap& map1, int num_threads,
                  PartialSurface* surface) {
  if (!HasMask(mask1) && !HasMask(mask2)) return;
  const SampleGrid& grid = surface->grid;
  const auto is_hidden = [&](int a, int b, double disparity) {
    const auto source = map1.Source(grid.PixelX(a), grid.PixelY(b));
    if (source &&
        IsHidden(mask1, static_cast<double>(source->x()), static_cast<double>(source->y()))) {
      return true;
    }
    if (!HasMask(mask2)) return false;
    const Eigen::Vector3d point = geometry.PointInWorld(grid.RectX(a), grid.RectY(b), disparity);
    const auto pixel2 = view2.camera.ImgFromCam(view2.cam_from_world * point);
    return pixel2 && IsHidden(mask2, pixel2->x(), pixel2->y());
  };
  ParallelFor(num_threads, grid.height, [&](int64_t row) {
    const int b = static_cast<int>(row);
    float* disparity =
        surface->disparity.data() + static_cast<size_t>(b) * static_cast<size_t>(grid.width);
    for (int a = 0; a < grid.width; ++a) {
      if (disparity[a] > 0 && is_hidden(a, b, static_cast<double>(disparity[a]))) disparity[a] = 0;
    }
  });
}

}  // namespace colmap_seapoint
