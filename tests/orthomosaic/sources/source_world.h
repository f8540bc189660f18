// A flat map whose blocks are seen by two rows of cameras: what exposure and seams are told.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/orthomosaic/relief/relief.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"
#include "tests/io/test_files.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

class SourceWorld {
 public:
  // A map of so many blocks, its unit a pixel.
  SourceWorld(int num_pictures, int blocks_x, int blocks_y) {
    MapGrid grid;
    grid.width = kBlockSize * blocks_x;
    grid.height = kBlockSize * blocks_y;
    CloudWriter cloud(dir_ / "flat.ply");
    for (int i = 0; i < grid.width * grid.height / 16; ++i) {
      CloudPoint point;
      point.xyz = {static_cast<float>(4 * (i % (grid.width / 4)) + 2),
                   -static_cast<float>(4 * (i / (grid.width / 4)) + 2), 0};
      cloud.Add(point, nullptr, 0);
    }
    cloud.Finish();
    const CloudTiles tiles(dir_ / "flat.ply", {}, grid, 0, dir_.Path());
    relief_ = std::make_unique<Relief>(tiles, grid, false, 1, dir_.Path());
    Camera camera = MakeCamera(CameraModel::kPinhole, 400, 480, 500);
    camera.camera_id = 1;
    for (int i = 0; i < num_pictures; ++i) {
      const double x = (i % (num_pictures / 2) + 0.5) * grid.width / (num_pictures / 2);
      const double y = -(i / (num_pictures / 2) + 0.5) * grid.height / 2;
      views_.emplace_back(camera, StandAt(camera, {x, y, 400}, {180, 0, 0}).cam_from_world);
    }
  }

  const Relief& GetRelief() const { return *relief_; }
  const std::vector<MapView>& Views() const { return views_; }

  // What the pictures show, in light: the ground's own times factor(picture, place in it, channel).
  template <typename Factor>
  SourceBlocks Sources(const Factor& factor) const {
    SourceBlocks sources = FindSources(*relief_, views_, 1);
    for (size_t i = 0; i < sources.slot.size(); ++i) {
      const int x = static_cast<int>(i) % relief_->Blocks().width;
      const int y = static_cast<int>(i) / relief_->Blocks().width;
      for (int k = 0; k < kMaxSources && sources.slot[i] >= 0; ++k) {
        Source& source = sources.Of(sources.slot[i])[k];
        if (source.picture == kNoPicture) continue;
        source.sharpness = 100;
        const Eigen::Vector2d place =
            views_[source.picture].PixelOf(PlaceInBlock(*relief_, x, y))->array() /
            Eigen::Array2d(480, 500);
        for (size_t c = 0; c < 3; ++c) {
          const double ground = 0.3 + 0.15 * std::sin(1.3 * x + 0.7 * y + static_cast<double>(c));
          source.rgb[c] = ScreenOf(static_cast<float>(ground * factor(source.picture, place, c)));
        }
      }
    }
    return sources;
  }

 private:
  TempDir dir_;
  std::unique_ptr<Relief> relief_;
  std::vector<MapView> views_;
};

}  // namespace colmap_seapoint
