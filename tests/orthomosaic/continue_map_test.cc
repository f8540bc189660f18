// A strip grows: what its map had stays byte for byte, and what comes in fits onto it.
#include "colmap_seapoint/orthomosaic/continue_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/io/cloud/ply.h"
#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"
#include "tests/orthomosaic/map_world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDepth = 2, kSpacing = 0.008;
constexpr double kPixel = 0.002;  // for the strip to be several tiles long

// Takes tiles over from a map in memory.
struct GrowingMap : MapInMemory {
  MapTile TakeOver(const MapGrid::Box& box, int x, int y) override {
    const MapTile& whole = before->Whole();
    MapTile tile;
    tile.x = box.x;
    tile.y = box.y;
    tile.relief = FloatImage(box.width, box.height, 1, kNoHeight);
    tile.rgba = Image<uint8_t>(box.width, box.height, 4);
    tile.source = Image<int32_t>(box.width, box.height, 1, kNoSource);
    tile.surface = Image<uint8_t>(box.width, box.height);
    for (int v = 0; v < box.height; ++v) {
      for (int u = 0; u < box.width; ++u) {
        if (!whole.surface.Contains(x + u, y + v)) continue;
        tile.relief.At(u, v) = whole.relief.At(x + u, y + v);
        tile.source.At(u, v) = whole.source.At(x + u, y + v);
        tile.surface.At(u, v) = whole.surface.At(x + u, y + v);
        for (int c = 0; c < 4; ++c) tile.rgba.At(u, v, c) = whole.rgba.At(x + u, y + v, c);
      }
    }
    MapTile counted;
    counted.source = tile.source;
    counted.surface = tile.surface;
    ++num_taken_over;
    Take(std::move(tile));
    return counted;
  }

  const MapInMemory* before = nullptr;
  int num_taken_over = 0;
};

class ContinueMap : public testing::Test {
 protected:
  // The first pictures of a strip along x, half a unit apart, and what they see, picture by
  // picture.
  MapWorld Strip(size_t num_pictures) {
    MapWorld world{World({{{0, 0, kDepth}, {20, 0, 0}, {0, 20, 0}}}, NoiseTexture(7, 0.24, 3)),
                   {},
                   {},
                   dir_.Path() / ("fused" + std::to_string(num_pictures) + ".ply"),
                   0.008};
    Camera& camera = world.model.cameras[1];
    camera = MakeCamera(CameraModel::kPinhole, 250, 200, 150);
    camera.camera_id = 1;
    CloudWriter cloud(world.cloud_path);
    for (size_t i = 0; i < num_pictures; ++i) {
      PosedImage image;
      image.image_id = static_cast<uint32_t>(i + 1);
      image.camera_id = 1;
      image.name = std::to_string(i) + ".png";
      const double x = 0.5 * static_cast<double>(i);
      const Viewpoint viewpoint = StandAt(camera, {x, 0, 0});
      image.cam_from_world = viewpoint.cam_from_world;
      world.model.images.push_back(image);
      ColorImage picture = TakePicture(world.world, viewpoint);
      for (uint8_t& value : picture.data) {
        value =
            ScreenOf(static_cast<float>(i < 6 ? 0.9 : 0.45) * LightOf(static_cast<float>(value)));
      }
      world.pictures.push_back(PictureOf(picture));
      for (double u = i == 0 ? -0.8 : 0.3; u < 0.8; u += kSpacing) {
        for (double v = -0.6; v < 0.6; v += kSpacing) {
          CloudPoint point;
          point.xyz = Eigen::Vector3d(x + u, v, kDepth).cast<float>();
          point.normal = -Eigen::Vector3f::UnitZ();
          cloud.Add(point, nullptr, 0);
        }
      }
    }
    cloud.Finish();
    return world;
  }

  OrthomosaicSummary Make(const MapWorld& world, MapInMemory* map,
                          const MapMemory* before = nullptr, int num_threads = 2) {
    OrthomosaicOptions options;
    options.pixel_size = kPixel;
    options.plane.towards_eye = -Eigen::Vector3d::UnitZ();
    options.plane.up = -Eigen::Vector3d::UnitY();
    options.num_threads = num_threads;
    OrthomosaicInputs inputs = world.Inputs(dir_.Path());
    inputs.before = before;
    return MakeOrthomosaic(options, inputs, map);
  }

  TempDir dir_;
};

bool IsSame(const MapTile& a, const MapTile& b) {
  const auto same_heights = [](float x, float y) {
    return x == y || (std::isnan(x) && std::isnan(y));
  };
  return a.rgba.data == b.rgba.data && a.source.data == b.source.data &&
         a.surface.data == b.surface.data &&
         std::equal(a.relief.data.begin(), a.relief.data.end(), b.relief.data.begin(),
                    b.relief.data.end(), same_heights);
}

TEST_F(ContinueMap, WhatNothingNewTouchesStaysAndTheRestFitsOntoIt) {
  MapInMemory first;
  const OrthomosaicSummary before = Make(Strip(6), &first);
  ASSERT_GE(before.num_tiles, 2u);
  EXPECT_EQ(before.num_tiles_drawn, before.num_tiles);
  EXPECT_EQ(before.memory.first_pictures, 6u);
  const MapWorld grown = Strip(8);
  GrowingMap second;
  second.before = &first;
  const OrthomosaicSummary after = Make(grown, &second, &before.memory);
  EXPECT_GE(second.num_taken_over, 1);
  EXPECT_GE(after.num_tiles_drawn, 1u);
  EXPECT_EQ(after.num_tiles_drawn + static_cast<size_t>(second.num_taken_over), after.num_tiles);
  EXPECT_LT(after.num_picture_reads, 8u);  // the first ones are not even read
  EXPECT_EQ(after.pictures_used.size(), 8u);
  EXPECT_EQ(after.memory.first_pictures, 6u);
  EXPECT_GT(after.num_surface_pixels, before.num_surface_pixels * 6 / 5);
  EXPECT_GT(after.num_colored_pixels, after.num_surface_pixels * 98 / 100);
  // On one lattice.
  const Eigen::Vector2d shift = second.Grid().PixelOf(first.Grid().left, first.Grid().top);
  const int dx = static_cast<int>(std::lround(shift.x())),
            dy = static_cast<int>(std::lround(shift.y()));
  EXPECT_LT((shift - Eigen::Vector2d(dx, dy)).norm(), 1e-6);
  // Where no new picture looks nothing changes, be the tile drawn anew: x < 2.1.
  int num_compared = 0, num_darker = 0, num_new = 0;
  for (int y = 0; y < second.Grid().height; ++y) {
    for (int x = 0; x < second.Grid().width; ++x) {
      if (second.Whole().surface.At(x, y) == 0) continue;
      const Eigen::Vector2d place = second.Grid().PlaceOf(x + 0.5, y + 0.5);
      const Eigen::Vector3d in_world =
          second.Frame().map_from_cloud.Inverse() * Eigen::Vector3d(place.x(), place.y(), 0);
      if (in_world.x() < 2.1) {
        ++num_compared;
        for (int c = 0; c < 4; ++c) {
          ASSERT_EQ(second.Whole().rgba.At(x, y, c), first.Whole().rgba.At(x - dx, y - dy, c));
        }
        ASSERT_EQ(second.Whole().source.At(x, y), first.Whole().source.At(x - dx, y - dy));
      } else if (second.Whole().source.At(x, y) >= 6) {
        // As bright as the first ones, though those pictures are half as bright.
        ++num_new;
        const float wanted = 0.9f * LightOf(static_cast<float>(grown.world.ColorAt(
                                        {in_world.x(), in_world.y(), kDepth})[0]));
        const float is = LightOf(static_cast<float>(second.Whole().rgba.At(x, y, 0)));
        num_darker += is < 0.7f * wanted ? 1 : 0;
      }
    }
  }
  EXPECT_GT(num_compared, 100000);
  EXPECT_GT(num_new, 50000);
  EXPECT_LT(num_darker, num_new / 20);
}

TEST_F(ContinueMap, NothingNewIsTheSameMap) {
  MapInMemory first;
  const MapWorld world = Strip(6);
  const OrthomosaicSummary before = Make(world, &first);
  GrowingMap again;
  again.before = &first;
  const OrthomosaicSummary after = Make(world, &again, &before.memory);
  EXPECT_EQ(after.num_tiles_drawn, 0u);
  EXPECT_EQ(after.num_picture_reads, 0u);
  EXPECT_TRUE(IsSame(again.Whole(), first.Whole()));
  EXPECT_EQ(after.num_surface_pixels, before.num_surface_pixels);
  EXPECT_EQ(after.pictures_used, before.pictures_used);
  EXPECT_EQ(after.memory.exposure.Gains(), before.memory.exposure.Gains());
  EXPECT_EQ(after.memory.sources.choice, before.memory.sources.choice);
}

TEST_F(ContinueMap, SameForAnyNumberOfThreads) {
  MapInMemory first;
  const OrthomosaicSummary before = Make(Strip(6), &first);
  const MapWorld grown = Strip(8);
  GrowingMap one, four;
  one.before = four.before = &first;
  Make(grown, &one, &before.memory, 1);
  Make(grown, &four, &before.memory, 4);
  EXPECT_TRUE(IsSame(one.Whole(), four.Whole()));
}

}  // namespace
}  // namespace colmap_seapoint
