// A slanted plane in four pictures, turned and nearer and farther, and a model of it whose cameras
// are exact and whose observations are not.
#pragma once

#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

class MeasuredWorld {
 public:
  // Observations are up to `error` pixels off in each coordinate.
  explicit MeasuredWorld(double error);

  const SparseModel& Model() const { return model_; }
  // The picture of an image of the model, or of one with its image_id.
  const GrayImage& PictureOf(const PosedImage& image) const {
    return pictures_.at(image.image_id - 1);
  }
  // Where picture `to` shows what picture `from` shows at a pixel; both are positions in the model.
  Eigen::Vector2d Transfer(size_t from, const Eigen::Vector2d& pixel, size_t to) const;

 private:
  World world_;
  std::vector<Viewpoint> viewpoints_;
  std::vector<GrayImage> pictures_;
  SparseModel model_;
};

// Root mean square of how far the observations that were moved from `before` to `after` lie from
// where they should be, given that the only one of their track that was not moved stands for the
// point. Pixels; NaN without such a track.
struct MeasuredErrors {
  double before, after;
};
MeasuredErrors ErrorsOfMoved(const MeasuredWorld& world, const SparseModel& before,
                             const SparseModel& after);

}  // namespace colmap_seapoint
